"""urdf.shapes: the form, the place and the color of what a file draws."""

import re
import sys

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose
from robots import mesh_files as files
from robots.mesh_files import box, collada, mesh, one_link, only, solid, visual
from urdf_text import joint, link, robot_text

import graphdyn
import urdf
from urdf.geometry import reading
from urdf.geometry.meshes import mesh_files as readers
from urdf.geometry.meshes import triangles as decimation


def bounds(shape):
    """Corners of the box around a shape, in the link frame of its body (2, 3)."""
    points = shape.vertices @ shape.placement.rotation.T + shape.placement.translation
    return np.array([points.min(axis=0), points.max(axis=0)])


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
        """The same box, in millimeters where the file can say so."""
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
        own = one_link(visual('<box size="1 1 1"/>', self.RED.replace("1 0 0 0.5", "0 0 1 1")))
        assert only(own.replace("<link", self.RED + "<link", 1)).color == (0, 0, 1, 1)  # before that of the robot
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


class TestFewerFaces:
    @pytest.mark.parametrize("how", ["closed", "torn", "not installed"])
    def test_decimated(self, drawn, monkeypatch, how):
        """About as many faces as asked for, in the same box."""
        form = files.torn(files.torus()) if how == "torn" else files.torus()
        if how == "not installed":
            monkeypatch.setitem(sys.modules, "fast_simplification", None)
        robot = drawn(mesh("../meshes/a.stl"), form.export(file_type="stl"))
        (shape,) = urdf.shapes(robot, faces=200).meshes
        assert 60 <= len(shape.faces) <= decimation.MAX_FACE_EXCESS * 200
        assert np.abs(bounds(shape) - form.bounds).max() < 0.05

    def test_shared_out(self):
        assert decimation.shared_out([1000, 3000, 12], 400) == [99, 299, 12]
        assert decimation.shared_out([1000, 3000], 4000) == [1000, 3000]
        assert decimation.shared_out([1000, 3000], None) == [1000, 3000]
        assert decimation.shared_out([100_000, 200], 1000) == [998, decimation.MIN_PART_FACES]

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


def test_the_catalog():
    """Collada of an industrial arm: the box around a link reaches from joint to joint."""
    found, model = urdf.shapes("ur5"), urdf.load("ur5")
    assert found.missing == ()
    assert {shape.body for shape in found.meshes} == {model.base_name, *model.body_names}
    corners = np.array([bounds(shape)[:, 2] for shape in found.meshes if shape.link == "upper_arm_link"])
    assert corners.min() < 0
    assert 0 < corners.max() - model.joints[2].placement.translation[2] < 0.1
