"""urdf.shapes: the form, the place and the color of what a file draws, and why something is missing."""

import os
import re
import sys
from pathlib import Path

import mesh_files as files
import numpy as np
import pytest
import trimesh
from mesh_files import box, collada, mesh, one_link, visual
from numpy.testing import assert_allclose
from urdf_text import joint, link, robot_text

import graphdyn
import urdf
from urdf.geometry import collada as collada_reader
from urdf.geometry import decimation, reading
from urdf.geometry import mesh_files as readers


def bounds(shape):
    """Corners of the box around a shape, in the link frame of its body (2, 3)."""
    points = shape.vertices @ shape.placement.rotation.T + shape.placement.translation
    return np.array([points.min(axis=0), points.max(axis=0)])


def solid(shape):
    return trimesh.Trimesh(shape.vertices, shape.faces, process=False)


def only(text):
    """The one shape of a robot; nothing is missing."""
    found = urdf.shapes(text)
    assert found.missing == ()
    (shape,) = found.meshes
    return shape


@pytest.fixture
def drawn(tmp_path):
    """drawn(geometry, content): the one link of a robot in folder/pkg/urdf, beside the file folder/pkg/meshes/a.stl."""

    def write(geometry, content=None, name="a.stl"):
        path = tmp_path / "pkg" / "meshes" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content or box().export(file_type="stl"))
        robot = tmp_path / "pkg" / "urdf" / "r.urdf"
        robot.parent.mkdir(exist_ok=True)
        robot.write_text(one_link(visual(geometry)), encoding="utf-8")
        return robot

    return write


class TestPlaces:
    """Shapes lie where urdf.load puts their links."""

    def test_links_that_are_fused(self):
        drawing = visual('<box size="1 2 3"/>', '<origin xyz="0 0 5" rpy="0 0 1.5707963267948966"/>')
        names = {"base": "base", "foot": "base", "arm": "arm", "tool": "arm"}
        text = robot_text(
            "r",
            *(f'<link name="{name}">{drawing}</link>' for name in names),
            joint("a", "base", "foot", "fixed", '<origin xyz="1 0 0"/>'),
            joint("b", "foot", "arm", more='<axis xyz="0 0 1"/>'),
            joint("c", "arm", "tool", "fixed", '<origin xyz="0 0 0.5" rpy="0 1.5707963267948966 0"/>'),
        )
        with pytest.warns(urdf.MissingInertialWarning):
            model = urdf.load(text)
        found = urdf.shapes(text)
        assert {shape.link: shape.body for shape in found.meshes} == names
        at = dict(zip(names, map(bounds, found.meshes), strict=True))
        own = np.array([[-1, -0.5, 3.5], [1, 0.5, 6.5]])
        assert_allclose(at["base"], own, atol=1e-15)
        assert_allclose(at["foot"], own + np.array([1, 0, 0]), atol=1e-15)
        assert_allclose(at["arm"], own, atol=1e-15)
        assert_allclose(at["tool"], [[3.5, -0.5, -0.5], [6.5, 0.5, 1.5]], atol=1e-14)
        tool = model.frame("tool").placement
        assert_allclose(found.meshes[3].placement.rotation[:, 2], tool.rotation[:, 2], atol=1e-15)

    def test_a_chain_and_a_locked_joint(self):
        links = [
            f'<link name="{name}">{visual("<sphere radius=" + chr(34) + "1" + chr(34) + "/>")}</link>'
            for name in "abcd"
        ]
        joints = [joint(f"j{k}", "abc"[k], "bcd"[k], more='<axis xyz="0 0 1"/><origin xyz="1 0 0"/>') for k in range(3)]
        found = urdf.shapes(robot_text("r", *links, *joints), chain=("b", "d"), lock={"j1": np.pi / 2})
        assert [(shape.link, shape.body) for shape in found.meshes] == [("b", "b"), ("c", "b"), ("d", "d")]
        assert_allclose(found.meshes[1].placement.rotation[:, 0], [0, 1, 0], atol=1e-15)

    def test_errors_are_those_of_load(self):
        with pytest.raises(urdf.MissingEntry, match="<parent> is missing"):
            urdf.shapes(
                robot_text("r", link("a"), link("b"), '<joint name="j" type="revolute"><child link="b"/></joint>')
            )

    @pytest.mark.parametrize(
        ("argument", "message"),
        [
            ({"geometry": "visuals"}, "geometry is 'visuals'; give 'visual' or 'collision'"),
            ({"faces": 0}, "faces is 0; give a whole number from 1 on, or None"),
            ({"faces": 1.5}, "faces is 1.5; give a whole number"),
            ({"faces": True}, "faces is True; give a whole number"),
        ],
    )
    def test_arguments(self, argument, message):
        with pytest.raises(graphdyn.InvalidInput, match=re.escape(message)):
            urdf.shapes("kr500", **argument)


class TestForms:
    @pytest.mark.parametrize(
        ("geometry", "half", "volume", "short"),
        [
            ('<box size="0.2 0.4 0.6"/>', (0.1, 0.2, 0.3), 0.048, 1e-12),
            ('<cylinder radius="0.5" length="3"/>', (0.5, 0.5, 1.5), np.pi * 0.25 * 3, 0.01),
            ('<sphere radius="2"/>', (2, 2, 2), 4 / 3 * np.pi * 8, 0.04),
            ('<capsule radius="0.5" length="3"/>', (0.5, 0.5, 2), np.pi * (0.75 + 1 / 6), 0.02),
        ],
    )
    def test_simple_solids(self, geometry, half, volume, short):
        """About the center, along z, normals outwards, and inside the round solid by little."""
        shape = only(one_link(visual(geometry)))
        assert shape.file is None
        assert_allclose(bounds(shape), [np.negative(half), half], rtol=1e-12)
        assert -1e-12 <= 1 - solid(shape).volume / volume < short

    def test_visual_or_collision(self):
        both = visual('<box size="1 1 1"/>') + visual('<box size="2 2 2"/>', tag="collision")
        for geometry, half in (("visual", 0.5), ("collision", 1.0)):
            (shape,) = urdf.shapes(one_link(both), geometry=geometry).meshes
            assert bounds(shape)[1, 0] == half

    def test_comments(self):
        shape = only(one_link(visual('<!-- was: <sphere radius="1"/> --><box size="1 1 1"/><!-- end -->')))
        assert len(shape.faces) == 12

    @pytest.mark.parametrize("written", ["stl", "ascii", "obj", "dae"])
    def test_mesh_files(self, drawn, written):
        """The same box, in millimetres where the file can say so."""
        there = box(center=(0.1, 0.2, 0.3))
        suffix = {"ascii": "stl"}.get(written, written)
        content = {
            "stl": there.export(file_type="stl"),
            "ascii": there.export(file_type="stl_ascii"),
            "obj": "g b\nmtllib /etc/passwd\n" + there.export(file_type="obj"),
            "dae": collada(box(200, 100, 400, (100, 200, 300))),
        }[written]
        shape = only(drawn(mesh(f"../meshes/a.{suffix}"), content, f"a.{suffix}"))
        assert (len(shape.vertices), len(shape.faces), shape.file) == (8, 12, f"../meshes/a.{suffix}")
        assert_allclose(bounds(shape), [[0, 0.15, 0.1], [0.2, 0.25, 0.5]], atol=1e-7)
        assert_allclose(solid(shape).volume, 0.008, rtol=1e-6)
        assert not shape.vertices.flags.writeable
        assert not shape.faces.flags.writeable

    @pytest.mark.parametrize(("scale", "volume"), [("2 1 1", 0.016), ("-1 1 1", 0.008), ("-1 -2 0.5", 0.008)])
    def test_scale(self, drawn, scale, volume):
        """Mirrored too, normals stay outwards: the volume is positive."""
        there = box(center=(0.1, 0, 0))
        shape = only(drawn(mesh("../meshes/a.stl", scale), there.export(file_type="stl")))
        assert_allclose(solid(shape).volume, volume, rtol=1e-6)
        factors = np.array([float(x) for x in scale.split()])
        assert_allclose(bounds(shape), np.sort(there.bounds * factors, axis=0), atol=1e-7)

    def test_faces_of_more_than_three_corners(self, drawn):
        """A square and a pentagon: as <polylist>, as <polygons>, and as faces of an OBJ file."""
        points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 2, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1]], dtype=float)
        flat = trimesh.Trimesh(points, [[0, 1, 2]], process=False)
        squares = '<input semantic="VERTEX" source="#v" offset="0"/>'
        listed = f'<polylist count="2">{squares}<vcount>4 5</vcount><p>0 1 6 5 0 1 2 3 4</p></polylist>'
        apart = f'<polygons count="2">{squares}<p>0 1 6 5</p><p>0 1 2 3 4</p></polygons>'
        obj = "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "f 1 2 7 6\nf 1 2 3 4 5\n"
        for content, name in (
            (collada(flat, "", polygons=listed), "a.dae"),
            (collada(flat, "", polygons=apart), "a.dae"),
            (obj, "a.obj"),
        ):
            shape = only(drawn(mesh(f"../meshes/{name}"), content, name))
            assert len(shape.faces) == 5
            assert_allclose(solid(shape).area, 1 + 1.5, rtol=1e-12)

    def test_nodes_of_collada(self, drawn):
        """Placed by all transforms in their order, shown twice, once mirrored."""
        nodes = (
            '<node id="a"><translate>0 0 1</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>'
            '<instance_geometry url="#g"/></node><node><matrix>-1 0 0 0 0 1 0 5 0 0 1 0 0 0 0 1</matrix>'
            '<instance_node url="#a"/></node>'
        )
        shape = only(drawn(mesh("../meshes/a.dae"), collada(box(1, 1, 1, (0.5, 0, 0)), "", nodes), "a.dae"))
        parts = [piece.bounds for piece in solid(shape).split()]
        assert_allclose(sorted(map(np.ravel, parts), key=lambda p: p[1])[0], [-0.5, 0, 0.5, 0.5, 2, 1.5], atol=1e-12)
        assert_allclose(bounds(shape), [[-0.5, 0, 0.5], [0.5, 7, 1.5]], atol=1e-12)
        assert_allclose(solid(shape).volume, 4, rtol=1e-12)


class TestColors:
    RED = '<material name="red"><color rgba="1 0 0 0.5"/></material>'

    def test_of_the_robot(self):
        named = one_link(visual('<box size="1 1 1"/>', '<material name="red"/>'))
        assert only(named.replace("<link", self.RED + "<link", 1)).color == (1, 0, 0, 0.5)
        assert only(one_link(visual('<box size="1 1 1"/>', self.RED))).color == (1, 0, 0, 0.5)
        assert only(named).color == only(one_link(visual('<box size="1 1 1"/>'))).color == (0.72, 0.74, 0.78, 1.0)

    def test_of_the_mesh_file(self, drawn, tmp_path):
        """They come before those of the robot. A texture is none; an opacity of 0 means opaque."""
        robot = drawn(mesh("../meshes/a.dae") + "", collada(box(), color="<color>0 0.5 1 0</color>"), "a.dae")
        robot.write_text(robot.read_text().replace("<geometry>", self.RED + "<geometry>"), encoding="utf-8")
        assert only(robot).color == (0, 0.5, 1, 1)
        drawn(mesh("../meshes/a.dae"), collada(box(), color='<texture texture="none"/>'), "a.dae")
        robot.write_text(robot.read_text().replace("<geometry>", self.RED + "<geometry>"), encoding="utf-8")
        assert only(robot).color == (1, 0, 0, 0.5)
        content = "mtllib c.mtl\nusemtl blue\n" + box().export(file_type="obj", include_normals=False)
        robot = drawn(mesh("../meshes/a.obj"), content, "a.obj")
        (tmp_path / "pkg" / "meshes" / "c.mtl").write_text(
            "newmtl blue\nKd 0 0 1\nmap_Kd /dev/zero\n", encoding="utf-8"
        )
        assert only(robot).color == (0, 0, 1, 1)


class TestFiles:
    """Where mesh files are looked for."""

    @pytest.mark.parametrize(
        "name",
        [
            "../meshes/a.stl",
            "package://pkg/meshes/a.stl",
            "package://another_name/meshes/a.stl",
            "model://pkg/meshes/a.stl",
            "file://{folder}/pkg/meshes/a.stl",
            "{folder}/pkg/meshes/a.stl",
        ],
    )
    def test_found(self, drawn, tmp_path, name):
        assert len(only(drawn(mesh(name.format(folder=tmp_path)))).faces) == 12

    def test_packages_of_ros(self, tmp_path, monkeypatch):
        files.stl(tmp_path / "ws" / "share" / "pkg" / "a.stl", box())
        text = one_link(visual(mesh("package://pkg/a.stl")))
        assert urdf.shapes(text).missing[0].reason == "line 3: no such file"
        for variable, folder in (("ROS_PACKAGE_PATH", "ws/share"), ("AMENT_PREFIX_PATH", "ws")):
            with monkeypatch.context() as patched:
                patched.setenv(variable, f"{tmp_path}/none{os.pathsep}{tmp_path / folder}")
                assert only(text).file == "package://pkg/a.stl"

    @pytest.mark.parametrize(
        ("name", "reason"),
        [
            ("", "<mesh> has no file name"),
            ("gone.stl", "no such file"),
            ("package://pkg", "'' files are not read, only .stl, .obj, .dae"),
            ("a\\0.stl", "no such file"),
            ("$(find pkg)/a.stl", "the name is not expanded; expand the file with xacro"),
            ("https://example.org/a.stl", "https:// is not fetched; save the file beside the URDF"),
            ("../urdf/r.urdf", "'.urdf' files are not read, only .stl, .obj, .dae"),
            ("../meshes", "'' files are not read, only .stl, .obj, .dae"),
            ("../meshes/folder.stl", "not a regular file"),
            ("../meshes/pipe.stl", "not a regular file"),
            ("../meshes/zero.stl", "not a regular file"),
            ("../meshes/secret.stl", "the file cannot be read: Permission denied"),
        ],
    )
    def test_missing(self, drawn, tmp_path, monkeypatch, name, reason):
        robot = drawn(mesh(name))
        meshes = tmp_path / "pkg" / "meshes"
        (meshes / "folder.stl").mkdir()
        os.mkfifo(meshes / "pipe.stl")
        (meshes / "zero.stl").symlink_to("/dev/zero")
        files.stl(meshes / "secret.stl", box())
        really = Path.open

        def denied(path, *arguments, **options):
            if path.name == "secret.stl":
                raise PermissionError(13, "Permission denied")
            return really(path, *arguments, **options)

        monkeypatch.setattr(Path, "open", denied)
        found = urdf.shapes(robot)
        assert found.meshes == ()
        assert found.missing == (urdf.MissingShape("arm", name, f"line 3: {reason}"),)

    def test_a_relative_path_without_a_file(self):
        (missing,) = urdf.shapes(one_link(visual(mesh("a.stl")))).missing
        assert missing.reason.endswith("the path is relative, and the URDF comes from no file; load it from its file")


PRIMITIVES = [
    ("<box/>", "<box>: attribute 'size' is missing"),
    ('<box size="1 2"/>', '<box>: size="1 2" has 2 entries, expected 3; separate numbers by spaces'),
    ('<sphere radius="nan"/>', '<sphere>: radius="nan" is not finite'),
    ('<sphere radius="0"/>', "<sphere>: a size that is not positive"),
    ('<cylinder radius="1" length="-1"/>', "<cylinder>: a size that is not positive"),
    ('<sphere radius="1e30"/>', '<sphere>: radius="1e30" is larger than 1e+06; give metres'),
    ('<cone radius="1"/>', "<cone> is none of <box>, <cylinder>, <sphere>, <capsule>, <mesh>"),
    ("", "<geometry> has 0 elements, expected one"),
    ('<box size="1 1 1"/><sphere radius="1"/>', "<geometry> has 2 elements, expected one"),
    ('<mesh filename="a.stl" scale="1 0 1"/>', 'scale="1 0 1": a scale of zero'),
    ('<mesh filename="a.stl" scale="0.001"/>', '<mesh>: scale="0.001" has 1 entries, expected 3'),
]


@pytest.mark.parametrize(("geometry", "reason"), PRIMITIVES)
def test_a_drawing_that_is_wrong(geometry, reason):
    """It is listed, and hides no other."""
    found = urdf.shapes(one_link(visual(geometry) + visual('<box size="1 1 1"/>')))
    assert len(found.meshes) == 1
    (missing,) = found.missing
    assert missing.reason.startswith(f"line 3: {reason}")


def test_a_drawing_without_geometry():
    (missing,) = urdf.shapes(one_link("<visual/>")).missing
    assert missing == urdf.MissingShape("arm", None, "line 3: <visual> has no <geometry>")


def damaged():
    """Per name: content of a file, its suffix, and the reason why it is not read."""
    binary = box().export(file_type="stl")
    nan = bytearray(binary)
    nan[96:100] = np.float32(np.nan).tobytes()
    far = bytearray(binary)
    far[96:100] = np.float32(1e30).tobytes()
    laughs = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
    doubled = "".join(
        f'<node id="n{k}">{f"<instance_node url={chr(34)}#n{k - 1}{chr(34)}/>" * 2}</node>' for k in range(1, 40)
    )
    leaf = '<node id="n0"><instance_geometry url="#g"/></node>'
    ring = '<node id="x"><instance_node url="#x"/></node>'
    good = collada(box())
    corner = '<input semantic="VERTEX" source="#v" offset="0"/>'
    return {
        "truncated STL": (binary[:-60], ".stl", "the file is truncated: 10 of 12 triangles"),
        "endless STL": (b"\0" * 80 + b"\xff" * 4 + binary[84:], ".stl", "truncated: 12 of 4294967295 triangles"),
        "short STL": (b"\0" * 80, ".stl", "the file is truncated: shorter than the header of an STL file"),
        "truncated ASCII": (box().export(file_type="stl_ascii")[:700], ".stl", "the file has no triangles"),
        "no ASCII": ("solid\nfacet\nvertex 1 2 x\nendsolid", ".stl", "string or file could not be read to its end"),
        "NaN": (bytes(nan), ".stl", "a vertex has a coordinate that is NaN or infinite"),
        "far": (bytes(far), ".stl", "a vertex lies farther than 1e+06 m from the origin; check the unit of length"),
        "empty": (b"", ".obj", "the file has no triangles"),
        "bytes": (bytes(range(256)) * 40, ".obj", "the file has no triangles"),
        "vertex that is not there": (
            "v 0 0 0\nv 1 0 0\nf 1 2 9\n",
            ".obj",
            "the file is damaged: IndexError: index 8",
        ),
        "two coordinates": ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", ".obj", "vertices without three coordinates"),
        "NaN in OBJ": ("v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", ".obj", "a coordinate that is NaN or infinite"),
        "no Collada": ("<robot/>", ".dae", "the root element is <robot>, not <COLLADA>"),
        "a zip file": (b"PK\x03\x04" + bytes(100), ".dae", "the file is damaged: not XML in UTF-8"),
        "no XML": (good[:-30], ".dae", "the file is damaged: "),
        "entities": (
            f"<!DOCTYPE x [<!ENTITY a0 'ha'>{laughs}]>{good[38:]}",
            ".dae",
            "a document type declaration",
        ),
        "hidden entities": (
            '<?xml version="1.0" encoding="utf-7"?><x/>',
            ".dae",
            "the file is not in UTF-8; save it so",
        ),
        "doubling nodes": (collada(box(), nodes=leaf + doubled), ".dae", "more than 20000 nodes, or more than 100 in"),
        "a cycle": (
            collada(box(), nodes=ring),
            ".dae",
            "more than 20000 nodes, or more than 100 in",
        ),
        "a unit of zero": (collada(box(), '<unit meter="0"/>'), ".dae", '<unit meter="0"> is not a length'),
        "a unit in words": (collada(box(), '<unit meter="inch"/>'), ".dae", '<unit meter="inch"> is not a length'),
        "a broken reference": (good.replace('url="#g"', 'url="#x"'), ".dae", 'url="#x" refers to nothing in it'),
        "numbers that are none": (good.replace("</float_array>", " 1,5</float_array>"), ".dae", "that is no number"),
        "positions cut off": (good.replace("</float_array>", " 1</float_array>"), ".dae", "is not three numbers each"),
        "a corner cut off": (good.replace("</p>", " 1</p>"), ".dae", "<p> of <triangles> ends within a corner"),
        "a corner too many": (good.replace("</p>", " 1 0</p>"), ".dae", "<triangles> with a corner too many"),
        "a vertex too many": (good.replace("</p>", " 1 0 1 0 99 0</p>"), ".dae", "a vertex that is not there"),
        "no scene": (re.sub("<scene>.*</scene>", "", good), ".dae", "the file has no <scene>; export it with one"),
        "a skin": (
            good.replace("instance_geometry", "instance_controller"),
            ".dae",
            "<instance_controller> is not",
        ),
        "strips": (good.replace("triangles", "tristrips"), ".dae", "<tristrips> are not read; export the mesh as tri"),
        "a spline": (good.replace("mesh>", "spline>"), ".dae", "a <geometry> without <mesh> is not read; export it"),
        "no positions": (good.replace("POSITION", "NORMAL"), ".dae", "<vertices> has no input POSITION"),
        "offset": (good.replace('offset="0"', 'offset="-1"'), ".dae", "offset of <input> is no number"),
        "matrix": (
            good.replace("<instance_geo", "<matrix>1 0</matrix><instance_geo"),
            ".dae",
            "<matrix> does not hold 16",
        ),
        "counts": (
            collada(
                box(),
                polygons='<polylist><input semantic="VERTEX" source="#v" offset="0"/><vcount>3</vcount></polylist>',
            ),
            ".dae",
            "<polylist> whose <vcount> does not fit its <p>",
        ),
        "holes": (
            collada(box(), polygons=f"<polygons>{corner}<ph/></polygons>"),
            ".dae",
            "polygons with holes are not",
        ),
        "two corners": (
            collada(box(), polygons=f"<polygons>{corner}<p>0 1</p></polygons>"),
            ".dae",
            "a polygon with fewer than three corners",
        ),
    }


@pytest.mark.parametrize("name", damaged())
def test_a_damaged_file(drawn, name):
    content, suffix, reason = damaged()[name]
    found = urdf.shapes(drawn(mesh(f"../meshes/a{suffix}"), content, f"a{suffix}"))
    assert found.meshes == ()
    (missing,) = found.missing
    assert reason in missing.reason
    assert len(missing.reason) < 250


def test_limits(drawn, monkeypatch):
    robot = drawn(mesh("../meshes/a.stl"))
    with monkeypatch.context() as patched:
        patched.setattr(readers, "LARGEST_MESH", 600)
        assert "the file is larger than 0 MB; reduce the mesh" in urdf.shapes(robot).missing[0].reason
    with monkeypatch.context() as patched:
        patched.setattr(reading, "MOST_TRIANGLES", 20)
        robot.write_text(one_link(visual(mesh("../meshes/a.stl")) * 2), encoding="utf-8")
        found = urdf.shapes(robot)
        assert len(found.meshes) == 1
        assert "with it, the robot has more than 20 triangles; reduce the meshes" in found.missing[0].reason
    with monkeypatch.context() as patched:
        patched.setattr(reading, "MOST_BYTES", 600)
        assert "with it, the meshes have more than 0 MB; reduce them" in urdf.shapes(robot).missing[0].reason
    monkeypatch.setattr(collada_reader, "MOST_TRIANGLES", 20)
    nodes = '<node><instance_geometry url="#g"/></node>' * 2
    robot = drawn(mesh("../meshes/a.dae"), collada(box(), nodes=nodes), "a.dae")
    assert "the scene has more than 20 triangles; reduce the mesh" in urdf.shapes(robot).missing[0].reason


class TestFewerFaces:
    @pytest.mark.parametrize("how", ["closed", "torn", "not installed"])
    def test_decimated(self, drawn, monkeypatch, how):
        """About as many faces as asked for, in the same box."""
        form = files.torn(files.torus()) if how == "torn" else files.torus()
        if how == "not installed":
            monkeypatch.setitem(sys.modules, "fast_simplification", None)
        robot = drawn(mesh("../meshes/a.stl"), form.export(file_type="stl"))
        (shape,) = urdf.shapes(robot, faces=200).meshes
        assert 60 <= len(shape.faces) <= decimation.ABOVE * 200
        assert np.abs(bounds(shape) - form.bounds).max() < 0.05

    def test_shared_out(self):
        assert decimation.shared_out([1000, 3000, 12], 400) == [99, 299, 12]
        assert decimation.shared_out([1000, 3000], 4000) == [1000, 3000]
        assert decimation.shared_out([1000, 3000], None) == [1000, 3000]
        assert decimation.shared_out([100_000, 200], 1000) == [998, decimation.FEWEST]

    def test_a_file_shown_twice_is_read_once(self, drawn, monkeypatch):
        robot = drawn(mesh("../meshes/a.stl"), files.torus().export(file_type="stl"))
        robot.write_text(one_link(visual(mesh("../meshes/a.stl")) * 2), encoding="utf-8")
        calls = []
        monkeypatch.setattr(reading, "read_mesh", lambda path: calls.append(path) or readers.read_mesh(path))
        first, second = urdf.shapes(robot, faces=400).meshes
        assert (len(calls), first.vertices is second.vertices) == (1, True)


def test_robots_of_makers(vendor_arms):
    """Without their meshes: every shape is listed as missing, and nothing else happens."""
    for path in sorted(vendor_arms.glob("*.urdf")):
        found = urdf.shapes(path)
        drawings = len(re.findall("<visual[ >]", re.sub("<!--.*?-->", "", path.read_text("utf-8"), flags=re.DOTALL)))
        assert len(found.meshes) + len(found.missing) == drawings
        assert {missing.reason.partition(": ")[2] for missing in found.missing} <= {"no such file"}


def test_the_catalogue():
    """Collada of an industrial arm: the box around a link reaches from joint to joint."""
    found, model = urdf.shapes("ur5"), urdf.load("ur5")
    assert found.missing == ()
    assert {shape.body for shape in found.meshes} == {model.base_name, *model.body_names}
    corners = np.array([bounds(shape)[:, 2] for shape in found.meshes if shape.link == "upper_arm_link"])
    assert corners.min() < 0
    assert 0 < corners.max() - model.joints[2].placement.translation[2] < 0.1
