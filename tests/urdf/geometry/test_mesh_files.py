"""Files of meshes: where they are looked for, and what is said of those that are missing, damaged or too large."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from robots import mesh_files as files
from robots.mesh_files import box, collada, mesh, one_link, only, visual

import urdf
from urdf.geometry import reading
from urdf.geometry.meshes import collada as collada_reader
from urdf.geometry.meshes import mesh_files as readers


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

    @pytest.mark.parametrize("name", ["package:///a.stl", "package://pkg/gone/a.stl", "package://a.stl"])
    def test_beside_the_document(self, tmp_path, name):
        """Where no package has it, as in a folder into which all files were copied."""
        files.stl(tmp_path / "a.stl", box())
        (tmp_path / "r.urdf").write_text(one_link(visual(mesh(name))), encoding="utf-8")
        assert len(only(tmp_path / "r.urdf").faces) == 12

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
            ("package://pkg", "it is a folder"),
            ("package:///", "it is a folder"),
            ("package:///gone.stl", "no such file"),
            ("a\\0.stl", "no such file"),
            ("$(find pkg)/a.stl", "the name is not expanded; expand the file with xacro"),
            ("https://example.org/a.stl", "https:// is not fetched; save the file beside the URDF"),
            ("../urdf/r.urdf", "'.urdf' files are not read, only .stl, .obj, .dae"),
            ("../meshes", "it is a folder"),
            ("../meshes/folder.stl", "it is a folder"),
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
    ('<sphere radius="1e30"/>', '<sphere>: radius="1e30" is larger than 1e+06; give meters'),
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
    uncounted = re.sub(' count="[0-9]+"', "", good)
    text_stl = (
        "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n"
        " endfacet\nendsolid a\n"
    )
    return {
        "truncated STL": (binary[:-60], ".stl", "the file is truncated: 10 of 12 triangles"),
        "endless STL": (b"\0" * 80 + b"\xff" * 4 + binary[84:], ".stl", "truncated: 12 of 4294967295 triangles"),
        "short STL": (b"\0" * 80, ".stl", "the file is truncated: shorter than the header of an STL file"),
        "truncated ASCII": (box().export(file_type="stl_ascii")[:700], ".stl", "line 37 does not go on with a facet"),
        "no ASCII": ("solid\nfacet\nvertex 1 2 x\nendsolid", ".stl", "line 2 does not go on with a facet"),
        "NaN": (bytes(nan), ".stl", "a vertex has a coordinate that is NaN or infinite"),
        "far": (bytes(far), ".stl", "a vertex lies farther than 1e+06 m from the origin; check the unit of length"),
        "empty": (b" ", ".obj", "the file has no triangles"),
        "bytes": (bytes(range(256)) * 40, ".obj", "the file is damaged: line 1: "),
        "vertex that is not there": (
            "v 0 0 0\nv 1 0 0\nf 1 2 9\n",
            ".obj",
            "the file is damaged: IndexError: index 8",
        ),
        "two coordinates": ("v 0 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", ".obj", "the file is damaged: line 2: 'v 1 0'"),
        "text of four bytes each": (
            box().export(file_type="stl_ascii").encode("utf-32-le"),
            ".stl",
            "bytes behind its ",
        ),
        "vertex 0 in OBJ": ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 0\n", ".obj", "line 5: 'f 1 2 0'"),
        "a word in OBJ": ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvv 0 1 0\nf 1 2 3\n", ".obj", "line 4: 'vv 0 1 0'"),
        "half a number in OBJ": ("v 0 0 0\rv 1 0 0\rv 0 1 0e\rf 1 2 3\r", ".obj", "line 3: 'v 0 1 0e'"),
        "a number in the next vertex": (
            text_stl.replace("vertex 0 0 0", "vertex 0 0").replace("vertex 1 0 0", "vertex 0 1 0 0"),
            ".stl",
            "line 2 does not go on with a facet, or the end of the solid",
        ),
        "a lost facet": (text_stl.replace("endfacet", "endfacets"), ".stl", "does not go on with a facet"),
        "no end": (text_stl.replace("endsolid", ""), ".stl", "line 9 does not go on with a facet"),
        "other words behind": (text_stl + "facet", ".stl", "line 10 does not go on with a facet"),
        "lost positions": (
            good.replace('count="24">', 'count="27">'),
            ".dae",
            '<float_array count="27"> has 24 numbers',
        ),
        "lost triangles": (good.replace('count="12"', 'count="13"'), ".dae", '<triangles count="13"> has 12 triangles'),
        "lost polygons": (
            collada(box(), polygons=f'<polygons count="2">{corner}<p>0 1 2</p></polygons>'),
            ".dae",
            '<polygons count="2"> has 1 polygons',
        ),
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
        "numbers that are none": (
            uncounted.replace("</float_array>", " 1,5</float_array>"),
            ".dae",
            "that is no number",
        ),
        "positions cut off": (
            uncounted.replace("</float_array>", " 1</float_array>"),
            ".dae",
            "is not three numbers each",
        ),
        "a corner cut off": (uncounted.replace("</p>", " 1</p>"), ".dae", "<p> of <triangles> ends within a corner"),
        "a corner too many": (uncounted.replace("</p>", " 1 0</p>"), ".dae", "<triangles> with a corner too many"),
        "the first vertex too many": (
            uncounted.replace("</p>", " 1 0 1 0 8 0</p>"),
            ".dae",
            "a vertex that is not there",
        ),
        "a vertex too many": (uncounted.replace("</p>", " 1 0 1 0 99 0</p>"), ".dae", "a vertex that is not there"),
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


def test_indented_lines_of_an_obj_file(drawn):
    """trimesh passes over them."""
    text = "v 0 0 0\n\tv 1 0 0\n v 0 1 0\nv 0 0 1\n  f 1 2 3\nf 1 2 4\n"
    found = urdf.shapes(drawn(mesh("../meshes/a.obj"), text, "a.obj"))
    assert found.missing == ()
    (shape,) = found.meshes
    corners = {frozenset(map(tuple, shape.vertices[face].tolist())) for face in shape.faces}
    assert corners == {frozenset([(0, 0, 0), (1, 0, 0), end]) for end in ((0, 1, 0), (0, 0, 1))}


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
        patched.setattr(readers, "MAX_MESH_BYTES", 600)
        assert "the file is larger than 0 MB; reduce the mesh" in urdf.shapes(robot).missing[0].reason
    with monkeypatch.context() as patched:
        patched.setattr(reading, "MAX_TRIANGLES", 20)
        robot.write_text(one_link(visual(mesh("../meshes/a.stl")) * 2), encoding="utf-8")
        found = urdf.shapes(robot)
        assert len(found.meshes) == 1
        assert "with it, the robot has more than 20 triangles; reduce the meshes" in found.missing[0].reason
    with monkeypatch.context() as patched:
        patched.setattr(reading, "MAX_MESH_FILES_BYTES", 600)
        assert "with it, the meshes have more than 0 MB; reduce them" in urdf.shapes(robot).missing[0].reason
    monkeypatch.setattr(collada_reader, "MAX_TRIANGLES", 20)
    nodes = '<node><instance_geometry url="#g"/></node>' * 2
    robot = drawn(mesh("../meshes/a.dae"), collada(box(), nodes=nodes), "a.dae")
    assert "the scene has more than 20 triangles; reduce the mesh" in urdf.shapes(robot).missing[0].reason
