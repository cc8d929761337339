"""Every refusal of urdf.load: its class, the file, the line, the element and the remedy."""

import re

import numpy as np
import pytest

import graphdyn
import urdf

MASS = '<mass value="2.5"/>'
INERTIA = '<inertia ixx="0.11" ixy="0.01" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"/>'
UPPER_ORIGIN = 'xyz="0.1 0.2 0.3"'
SHOULDER = '<joint name="shoulder" type="revolute">'

CHANGES = {
    "no robot name": (
        ('<robot name="arm">', "<robot>"),
        urdf.MissingEntry,
        r":1: <robot>: attribute 'name' is missing or empty; give it a name",
    ),
    "no link name": (('<link name="upper">', "<link>"), urdf.MissingEntry, r":3: <link>: attribute 'name' is missing"),
    "empty joint name": (
        (SHOULDER, '<joint name="" type="revolute">'),
        urdf.MissingEntry,
        r":18: <joint>: attribute 'name' is missing or empty",
    ),
    "duplicate link": (
        ('<link name="tool"/>', '<link name="upper"/>'),
        urdf.DuplicateEntry,
        r":17: link 'upper': the name is already used in line 3; rename one of the two",
    ),
    "duplicate joint": (
        ('name="slide"', 'name="shoulder"'),
        urdf.DuplicateEntry,
        r"joint 'shoulder': the name is already used in line 18",
    ),
    "no mass": (
        (MASS, ""),
        urdf.MissingEntry,
        r":4: <inertial> of link 'upper': <mass> is missing; write it; nothing is assumed",
    ),
    "no mass value": (
        (MASS, "<mass/>"),
        urdf.MissingEntry,
        r":6: <mass> of link 'upper': attribute 'value' is missing",
    ),
    "negative mass": (
        ("2.5", "-2.5"),
        urdf.InvalidNumber,
        r":6: <mass> of link 'upper': mass -2.5 kg is negative; give a mass of at least 0",
    ),
    "no inertia": ((INERTIA, ""), urdf.MissingEntry, r"<inertial> of link 'upper': <inertia> is missing"),
    "two inertials": (
        ("</inertial>", f"</inertial><inertial>{MASS}{INERTIA}</inertial>"),
        urdf.DuplicateEntry,
        r"link 'upper': 2 elements <inertial>; keep the one that is meant",
    ),
    "no joint type": (
        (SHOULDER, '<joint name="shoulder">'),
        urdf.MissingEntry,
        r":18: joint 'shoulder': attribute 'type' is missing; use one of revolute, continuous, prismatic, fixed",
    ),
    "no parent": (('<parent link="base"/>', ""), urdf.MissingEntry, r"joint 'shoulder': <parent> is missing"),
    "no child": (('<child link="upper"/>', ""), urdf.MissingEntry, r"joint 'shoulder': <child> is missing"),
    "no parent link": (
        ('<parent link="base"/>', "<parent/>"),
        urdf.MissingEntry,
        r"<parent> of joint 'shoulder': attribute 'link' is missing",
    ),
    "axis without xyz": (
        ('<axis xyz="0 0 1"/>', "<axis/>"),
        urdf.MissingEntry,
        r"<axis> of joint 'shoulder': attribute 'xyz' is missing",
    ),
    "zero axis": (
        ('<axis xyz="0 0 1"/>', '<axis xyz="0 -0 0.0"/>'),
        urdf.InvalidNumber,
        r":22: <axis> of joint 'shoulder': the axis is zero; give a direction",
    ),
    "not a number": (
        ('lower="-1"', 'lower="-1.57."'),
        urdf.InvalidNumber,
        r"""<limit> of joint 'shoulder': lower="-1.57.": '-1.57.' is not a number; correct the number""",
    ),
    "comma": ((UPPER_ORIGIN, 'xyz="0.07, 0 0"'), urdf.InvalidNumber, r"'0.07,' is not a number"),
    "python only": (('damping="0.5"', 'damping="1_0"'), urdf.InvalidNumber, r"'1_0' is not a number"),
    "two numbers": (
        (UPPER_ORIGIN, 'xyz="0.1 0.2"'),
        urdf.InvalidNumber,
        r':5: <origin> of link \'upper\': xyz="0.1 0.2" has 2 entries, expected 3; separate numbers by spaces',
    ),
    "four numbers": (('rpy="0 0 1.5708"', 'rpy="0 0 0 1"'), urdf.InvalidNumber, r"has 4 entries, expected 3"),
    "empty number": (('value="2.5"', 'value=""'), urdf.InvalidNumber, r'value="" has 0 entries, expected 1'),
    "nan": (("2.5", "nan"), urdf.InvalidNumber, r'value="nan" is not finite; give a finite number'),
    "infinity": (('effort="30"', 'effort="-inf"'), urdf.InvalidNumber, r'effort="-inf" is not finite'),
    "overflow": (("2.5", "1e400"), urdf.InvalidNumber, r"'1e400' overflows"),
    "larger than any robot": (
        ("2.5", "1e308"),
        urdf.InvalidNumber,
        r""":6: <mass> of link 'upper': value="1e308" is too large for a robot: results would overflow; give kg, m""",
    ),
    "xacro expression": (
        ('upper="2"', 'upper="${pi / 2}"'),
        urdf.InvalidNumber,
        r'upper="\$\{pi / 2\}" is not expanded; expand the file with xacro',
    ),
    "mimic multiplier": (
        ("<dynamics", '<mimic joint="slide" multiplier="x"/><dynamics'),
        urdf.InvalidNumber,
        r"<mimic> of joint 'shoulder': multiplier=\"x\": 'x' is not a number",
    ),
    "unknown link": (
        ('<child link="tool"/>', '<child link="tol"/>'),
        urdf.NotATree,
        r":35: <child> of joint 'flange': child link 'tol' does not exist; correct the name or add it",
    ),
    "two parents": (
        ('<child link="tool"/>', '<child link="upper"/>'),
        urdf.NotATree,
        r"joint 'flange': link 'upper' is the child of joint 'shoulder' too; a link has one parent",
    ),
    "two roots": (
        ('<link name="base"/>', '<link name="base"/><link name="shelf"/>'),
        urdf.NotATree,
        r"robot 'arm': several root links: 'base', 'shelf'; connect them with fixed joints",
    ),
    "no root": (
        ('<parent link="base"/>', '<parent link="tool"/>', '<link name="base"/>', ""),
        urdf.NotATree,
        r"robot 'arm': no root: every link is the child of a joint; remove the cycle",
    ),
    "cycle beside the root": (
        ('<parent link="upper"/>', '<parent link="tool"/>'),
        urdf.NotATree,
        r"joint 'slide': a cycle that the root does not reach, joints 'slide', 'flange'; connect them to the root",
    ),
    "limits crossed": (
        ('lower="-1"', 'lower="3"'),
        urdf.InvalidRobot,
        r"arm.urdf:23: <limit> of joint 'shoulder': lower limit 3 is above upper limit 2; swap them, or load the file "
        r"with repair=\['limits'\] \(--repair limits\)",
    ),
}


@pytest.mark.parametrize("case", CHANGES)
def test_refusal(arm, case):
    changes, kind, message = CHANGES[case]
    with pytest.raises(kind, match=message) as caught:
        urdf.load(arm(*changes))
    assert "arm.urdf" in str(caught.value)
    assert isinstance(caught.value, urdf.URDFError)
    assert isinstance(caught.value, graphdyn.GraphDynError)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("attribute", ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"])
def test_each_entry_of_the_tensor_is_required(arm, attribute):
    with pytest.raises(urdf.MissingEntry, match=rf":7: <inertia> of link 'upper': attribute '{attribute}' is missing"):
        urdf.load(arm(INERTIA, re.sub(rf'{attribute}="\S+?"', "", INERTIA)))


@pytest.mark.parametrize("kind", ["floating", "planar", "spherical", "Revolute", ""])
def test_unsupported_joint_type(arm, kind):
    with pytest.raises(
        urdf.UnsupportedJoint, match=rf":18: joint 'shoulder': type '{kind}' is not supported; use one of revolute"
    ):
        urdf.load(arm(SHOULDER, f'<joint name="shoulder" type="{kind}">'))


DOCUMENTS = {
    "empty": (b"", r"robot.urdf: the file is empty; give a URDF or MJCF file$"),
    "no XML": (b"hello", r"robot.urdf: the file has no XML element; give a URDF or MJCF file$"),
    "text before": (b'Expanded.\n<robot name="r"/>', r"not well-formed XML"),
    "version 0.0": (b'<?xml version="0.0"?><robot name="r"/>', r"not well-formed XML: Unsupported version '0.0'"),
    "undeclared prefix": (b'<robot name="r"><xacro:foo/></robot>', r"not well-formed XML: Namespace prefix xacro"),
    "not closed": (b'<robot name="r">\n<link name="a">\n</robot>', r"robot.urdf:3: not well-formed XML"),
    "latin-1 undeclared": (b'<robot name="\xe9"/>', r"not well-formed XML"),
    "other root": (b"\n<sdf/>", r"robot.urdf:2: the root element is <sdf>, not <robot>; give a URDF or MJCF file"),
    "entities": (
        b'<!DOCTYPE r [<!ENTITY a "b">]><robot name="&a;"/>',
        r"the document declares XML entities; write their text instead",
    ),
}


@pytest.mark.parametrize("case", DOCUMENTS)
def test_malformed_document(tmp_path, case):
    content, message = DOCUMENTS[case]
    path = tmp_path / "robot.urdf"
    path.write_bytes(content)
    with pytest.raises(urdf.MalformedXML, match=message):
        urdf.load(path)


def test_no_link(robot):
    with pytest.raises(urdf.MissingEntry, match=r"robot 'robot': there is no <link>; expand the file with xacro"):
        urdf.load(robot(""))


def test_no_moving_body(robot):
    with pytest.raises(urdf.InvalidRobot, match=r"robot.urdf: no moving body: every joint is fixed or locked"):
        urdf.load(robot('<link name="a"/>'))


def test_bad_gravity(arm):
    with pytest.raises(graphdyn.InvalidModel, match=r"robot 'arm': gravity has shape \(2,\), expected \(3,\)"):
        urdf.load(arm(), gravity=np.zeros(2))


def test_facts_of_a_refusal(arm):
    path = arm(MASS, "<mass/>")
    with pytest.raises(urdf.MissingEntry) as caught:
        urdf.load(path)
    error = caught.value
    assert (error.path, error.line, error.element) == (path, 6, "<mass> of link 'upper'")
    assert (error.problem, error.remedy) == (
        "attribute 'value' is missing",
        "write it; nothing is assumed for it",
    )
