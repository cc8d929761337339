"""What urdf.inspect says of inertials beside the meshes of their links."""

import re

import numpy as np
import pytest
from inspected.sample import MESH_CODES
from robots.mesh_files import box, mesh, one_link, stl, torn, torus, visual
from urdf_text import joint, link

import graphdyn
import urdf
from urdf.inspection.rules.mesh_rules import MAX_QUOTED_NAMES

SIDES = (0.2, 0.1, 0.4)
MASS = 8.0
TENSOR = np.diag([0.1**2 + 0.4**2, 0.2**2 + 0.4**2, 0.2**2 + 0.1**2]) * MASS / 12
"""Of the box, filled with 1000 kg/m³."""

DRAWN = visual(mesh("box.stl"))


def entries(tensor):
    return " ".join(repr(float(x)) for x in tensor[np.triu_indices(3)])


@pytest.fixture
def inspected(tmp_path):
    """The findings about meshes of a link with this inertial, drawn as a box in the file box.stl."""

    def run(mass=MASS, xyz="0 0 0", tensor=TENSOR, drawings=DRAWN, meshes="summary", form=None, text=""):
        stl(tmp_path / "box.stl", form or box(*SIDES))
        robot = tmp_path / "arm.urdf"
        robot.write_text(text or one_link(drawings, mass, xyz=xyz, tensor=entries(tensor)), encoding="utf-8")
        return [
            each for each in urdf.inspect(robot, meshes=meshes).findings if each.code in (*MESH_CODES, "mesh-files")
        ]

    return run


def test_an_inertial_that_fits(inspected):
    (finding,) = inspected()
    assert (finding.code, finding.severity, finding.element, finding.line) == ("mesh-files", "note", None, 3)
    assert finding.message == "mesh files: 1; links whose inertials are compared with them: 1"
    assert finding.remedy == "no action needed"


def test_which_drawings_are_meshes(inspected):
    """Two in lines 5 and 6, beside one that is empty, one without geometry, and a box."""
    others = visual("") + "\n<visual/>" + visual('<box size="1 1 1"/>', tag="collision")
    *_, finding = inspected(drawings=f"{others}\n{DRAWN}\n{visual('<!-- a -->' + mesh('box.stl'), tag='collision')}")
    assert finding.message.startswith("mesh files: 2; ")
    assert finding.line == 5


def test_a_center_outside_the_mesh(inspected):
    _, finding = inspected(xyz="0.15 0 0.23")
    assert (finding.code, finding.severity) == ("center-outside-mesh", "note")
    assert (finding.element, finding.line) == ("<inertial> of link 'arm'", 3)
    assert finding.message == (
        "the center of mass lies 0.0583 m outside the box around the visual mesh, whose longest side is 0.4 m"
    )
    assert finding.remedy == "no action needed, if parts of the link are not drawn"
    assert len(inspected(xyz="0.119 0 0")) == 1  # less than 5 % of the longest side
    assert len(inspected(xyz="0.121 0 0")) == 2
    assert {each.severity for each in inspected(xyz="0.199 0 0")} == {"note"}
    far, _ = inspected(xyz="0.201 0 0")  # more than a quarter
    assert far.severity == "warning"
    assert far.remedy == "give it in the link frame, in meters; or correct the placement or the scale of the mesh"


@pytest.mark.parametrize(("mass", "told"), [(0.39, "48.75"), (0.41, ""), (159.0, ""), (160.8, "2.01e+04")])
def test_density(inspected, mass, told):
    found = [each for each in inspected(mass, tensor=TENSOR * mass / MASS) if each.code == "mesh-density"]
    assert [each.message for each in found] == (
        [f"{mass:.3g} kg in 0.008 m³ (visual mesh) are {told} kg/m³"] if told else []
    )
    assert {each.severity for each in found} <= {"warning"}
    assert {each.remedy for each in found} <= {
        "give the mass in kg and the mesh in meters, with its scale; a part of the link may not be drawn"
    }


@pytest.mark.parametrize(("factor", "told"), [(9.9, False), (10.1, True), (1 / 10.1, True)])
def test_a_tensor_far_from_that_of_the_mesh(inspected, factor, told):
    """One line for the file, whatever the number of links."""
    found = [each for each in inspected(tensor=TENSOR * factor) if each.code == "inertia-unlike-mesh"]
    assert len(found) == told
    if told:
        assert (found[0].severity, found[0].element) == ("warning", None)
        assert found[0].message == (
            "the tensors of 1 of 1 links are far from those of their meshes, filled uniformly with the same mass: "
            "by a factor of 10.1 for link 'arm'"
        )
        assert re.fullmatch(
            r"compare them link by link: graphdyn inspect \S+ --meshes detail, urdf\.inspect\(…, meshes='detail'\)",
            found[0].remedy,
        )


def test_detail(inspected):
    finding = next(each for each in inspected(tensor=2 * TENSOR, meshes="detail") if each.code == "inertia-of-mesh")
    assert (finding.severity, finding.element) == ("note", "<inertial> of link 'arm'")
    assert finding.message == (
        "principal moments 0.0667, 0.227, 0.267 kg m²; filled uniformly with 8 kg (1000 kg/m³), the visual mesh has "
        "0.0333, 0.113, 0.133, a factor of 2, and its center of mass 0 m away"
    )
    assert finding.remedy == (
        "correct the inertial where the factor is large, or load with "
        "repair=[urdf.InertialsFromMeshes(density=1000)] (--repair inertials-from-meshes=1000)"
    )


def test_a_surface_that_is_not_closed(inspected):
    """Its convex hull is filled: of a torn ring the disc."""
    form = torn(torus())
    finding = next(each for each in inspected(form=form, meshes="detail") if each.code == "inertia-of-mesh")
    density = MASS / form.convex_hull.volume
    assert f"({density:.4g} kg/m³), the convex hull of its visual mesh has" in finding.message


def test_collision_shapes_where_visual_ones_are_missing(inspected):
    """The mesh of the collision shape is compared, and the link counts as read."""
    both = visual(mesh("gone.stl")) + visual(mesh("box.stl"), tag="collision")
    finding, files = inspected(mass=0.25, tensor=TENSOR / 32, drawings=both)
    assert "(collision mesh)" in finding.message
    assert files.message == "mesh files: 2; links whose inertials are compared with them: 1"


def test_links_that_cannot_be_compared(inspected):
    """Some of its meshes missing, or flat: the link is left out, which is told where others are compared."""
    partly = visual(mesh("box.stl")) + visual(mesh("gone.stl"))
    (finding,) = inspected(xyz="9 0 0", drawings=partly)
    assert finding.message == ("mesh files, not opened because dynamics need none: 2, of which 0 at package:// paths")
    flat = box(*SIDES)
    flat.apply_scale((1, 1, 0))
    (finding,) = inspected(form=flat)
    assert finding.message.startswith("mesh files, not opened")
    tool = link("tool").replace("</link>", f"{visual(mesh('gone.obj'))}</link>") + joint("k", "arm", "tool")
    arm = one_link(DRAWN, MASS, tensor=entries(TENSOR))
    (finding,) = inspected(text=arm.replace("</robot>", f"{tool}</robot>"))
    assert finding.message == (
        "mesh files: 2; links whose inertials are compared with them: 1; links that are not: "
        "'tool' (line 5: no such file)"
    )


def test_many_links_that_cannot_be_compared(inspected):
    """The first are named, the others counted."""
    lost = "".join(
        link(f"tool{k}").replace("</link>", f"{visual(mesh('gone.obj'))}</link>") + joint(f"k{k}", "arm", f"tool{k}")
        for k in range(MAX_QUOTED_NAMES + 2)
    )
    arm = one_link(DRAWN, MASS, tensor=entries(TENSOR))
    *_, finding = inspected(text=arm.replace("</robot>", f"{lost}</robot>"))
    assert finding.message.count("'tool") == MAX_QUOTED_NAMES
    assert finding.message.endswith(" and 2 more")


def test_without_meshes_nothing_changes(inspected):
    drawings = visual('<box size="9 9 9"/>') + visual(mesh("package://gone/a.stl"), tag="collision")
    with_, without = (inspected(xyz="99 0 0", drawings=drawings, meshes=how) for how in ("summary", "off"))
    assert with_ == without
    assert [each.code for each in with_] == ["mesh-files"]
    (finding,) = inspected(xyz="9 0 0", meshes="off")
    assert finding.message == "mesh files, not opened because dynamics need none: 1, of which 0 at package:// paths"


def test_a_robot_of_the_catalog():
    """Wrists of the UR5: tensors of bodies far larger than their meshes, which shows at a glance in a picture."""
    found = {each.code: each for each in reversed(urdf.inspect("ur5").findings)}
    assert "the tensors of 3 of 6 links are far from" in found["inertia-unlike-mesh"].message
    assert "a factor of 262 for link 'wrist_3_link'" in found["inertia-unlike-mesh"].message
    assert found["center-outside-mesh"].element == "<inertial> of link 'wrist_1_link'"


def test_an_unknown_word():
    with pytest.raises(graphdyn.InvalidInput, match="meshes is 'all'; give one of 'summary', 'detail', 'off'"):
        urdf.inspect("ur5", meshes="all")
