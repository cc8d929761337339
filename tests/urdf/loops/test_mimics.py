"""Mimic joints: coupled, independent or locked; with locks and chains; written back."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import graphdyn
import urdf
from graphdyn import Coupling
from urdf import InvalidLock, InvalidMimic

LINK = '<link name="l{0}"><inertial><mass value="{0}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
JOINT = '<joint name="j{0}" type="{1}"><parent link="l{2}"/><child link="l{0}"/><axis xyz="0 1 0"/>{3}</joint>'


def chain_of(*mimics, kinds="rrrr"):
    """Four joints in a row; mimics: per joint what to write into it."""
    links = ['<link name="l0"/>', *(LINK.format(k) + "</inertial></link>" for k in (1, 2, 3, 4))]
    types = {"r": "continuous", "p": "prismatic", "f": "fixed"}
    joints = [
        JOINT.format(
            k, types[kinds[k - 1]], k - 1, mimics[k - 1] + ('<limit effort="1" velocity="1"/>' * (kinds[k - 1] == "p"))
        )
        for k in (1, 2, 3, 4)
    ]
    return f'<robot name="arm">{"".join(links + joints)}</robot>'


def mimic(joint, multiplier=None, offset=None):
    numbers = {"multiplier": multiplier, "offset": offset}
    written = "".join(f' {name}="{x}"' for name, x in numbers.items() if x is not None)
    return f'<mimic joint="{joint}"{written}/>'


DRIVEN = chain_of("", mimic("j4", -2.0), "", mimic("j1", 0.5, 0.1))
"""The second joint mimics the fourth, which mimics the first."""


def test_coupled():
    model = urdf.load(DRIVEN)
    assert model.independent_joints == ("j1", "j3")
    assert model.couplings == (Coupling("j2", {"j4": -2.0}), Coupling("j4", {"j1": 0.5}, 0.1))
    assert_allclose(model.joint_positions([1.0, 2.0]), [1.0, -1.2, 2.0, 0.6], rtol=1e-15)


def test_independent_with_a_warning():
    with pytest.warns(
        urdf.MimicJointWarning, match=r"loaded as independent joints: 'j2', 'j4'; lock= \(--lock\) locks them"
    ):
        model = urdf.load(DRIVEN, mimic="independent")
    assert (model.nv, model.couplings) == (4, ())


def test_locked():
    assert urdf.load(DRIVEN, mimic="locked").joint_names == ("j1", "j3")
    free = urdf.load(DRIVEN, mimic="locked", lock={"j2": 0.25})
    assert_allclose(free.frame("j2").placement.rotation[0, 2], np.sin(0.25))


def test_a_locked_joint_holds_those_that_mimic_it():
    model = urdf.load(DRIVEN, lock={"j1": 0.4})
    assert model.joint_names == model.independent_joints == ("j3",)
    expected = urdf.load(DRIVEN, mimic="independent", lock={"j1": 0.4, "j4": 0.3, "j2": -0.6})
    assert_allclose(graphdyn.mass_matrix(model, [0.7]), graphdyn.mass_matrix(expected, [0.7]), rtol=1e-14)
    assert urdf.load(DRIVEN, lock={"j1": 0.4, "j4": 0.5 * 0.4 + 0.1}).n_bodies == 1


def test_what_mimics_a_fixed_joint_or_nothing_of_it_stands_still():
    fixed = chain_of("", mimic("j1", 3.0, 0.2), "", "", kinds="frrr")
    assert urdf.load(fixed).joint_names == ("j3", "j4")
    still = chain_of("", mimic("j1", 0, 0.2), "", "")
    model = urdf.load(still)
    assert model.joint_names == ("j1", "j3", "j4")
    assert_allclose(model.frame("j2").placement.rotation[0, 2], np.sin(0.2))


@pytest.mark.parametrize("element", ["<mimic/>", '<mimic multiplier="2"/>', '<mimic joint=""/>'])
def test_a_mimic_that_names_no_joint(element):
    robot = chain_of("", element, "", "")
    with pytest.raises(urdf.InvalidMimic, match=r"joint 'j2': its <mimic> names no joint; state joint=, lock it, or"):
        urdf.load(robot)
    report = urdf.inspect(robot)
    assert report.verdict == "refused"
    assert not any("dynamics do not need it" in finding.text for finding in report.findings)
    assert urdf.load(robot, lock=["j2"]).joint_names == ("j1", "j3", "j4")
    assert urdf.load(robot, mimic="locked").joint_names == ("j1", "j3", "j4")
    with pytest.warns(urdf.MimicJointWarning):
        assert urdf.load(robot, mimic="independent").n_bodies == 4
    assert urdf.load(chain_of("", element, "", "", kinds="rfrr")).joint_names == ("j1", "j3", "j4")


def test_beside_a_chain():
    """A follower beside the chain moves with the joint that it mimics, or is held with it."""
    links = ['<link name="l0"/>', *(LINK.format(k) + "</inertial></link>" for k in (1, 2, 3, 4))]
    joints = [
        JOINT.format(k, "continuous", 0 if k == 1 else 1, text)
        for k, text in enumerate(("", "", mimic("j2"), mimic("j4")), start=1)
    ]
    joints[3] = JOINT.format(4, "continuous", 1, "")
    robot = f'<robot name="arm">{"".join(links + joints)}</robot>'
    with pytest.warns(urdf.ChainWarning, match="movable joints beside the chain are locked at 0: 'j4';"):
        model = urdf.load(robot, chain=("l0", "l2"))
    assert model.independent_joints == ("j1", "j2")
    assert model.couplings == (Coupling("j3", {"j2": 1.0}),)


REFUSED = {
    "a choice": (
        DRIVEN,
        {"mimic": "free"},
        InvalidMimic,
        "mimic is 'free'; give one of 'coupled', 'independent', 'locked'",
    ),
    "a joint that is missing": (
        chain_of("", mimic("elbow"), "", ""),
        {},
        InvalidMimic,
        ":1: joint 'j2': it mimics joint 'elbow', which the robot lacks or the chain leaves out; correct the name,",
    ),
    "a joint before the chain": (
        chain_of("", "", mimic("j1"), ""),
        {"chain": ("l1", "l4")},
        InvalidMimic,
        "joint 'j3': it mimics joint 'j1', which the robot lacks or the chain leaves out",
    ),
    "a circle": (
        chain_of(mimic("j2"), mimic("j1"), "", ""),
        {},
        InvalidMimic,
        "joint 'j1': joints drive each other in a circle: j1 → j2 → j1; remove a <mimic> or <coupling>",
    ),
    "a follower locked alone": (
        DRIVEN,
        {"lock": ["j4"]},
        InvalidLock,
        r"cannot lock 'j4': it mimics joint 'j1', and 'j1' is free; lock 'j1' instead, or load with "
        r"mimic='independent' \(--mimic independent\)",
    ),
    "a follower locked elsewhere": (
        DRIVEN,
        {"lock": {"j1": 0.4, "j4": 0.0}},
        InvalidLock,
        r"cannot lock 'j4' at 0: it mimics joint 'j1', and stands at 0\.3; leave it out of lock=",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    robot, keywords, kind, said = REFUSED[name]
    with pytest.raises(kind, match=said):
        urdf.load(robot, **keywords)


def test_inspected():
    (found,) = [f for f in urdf.inspect(chain_of("", mimic("elbow"), "", "")).findings if f.code == "invalid-mimic"]
    assert (found.severity, found.element) == ("error", "joint 'j2'")


def test_written_and_read_again(tmp_path):
    model, path = urdf.load(DRIVEN), tmp_path / "arm.urdf"
    urdf.save(model, path)
    assert urdf.load(path).couplings == model.couplings


def test_updated(tmp_path):
    source, out = tmp_path / "arm.urdf", tmp_path / "new.urdf"
    source.write_text(DRIVEN)
    model = urdf.load(source)
    urdf.update(source, out, 2 * model.inertial_parameters)
    again = urdf.load(out)
    assert again.couplings == model.couplings
    assert_allclose(again.inertial_parameters, 2 * model.inertial_parameters)
