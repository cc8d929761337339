"""A robot without a flaw, and what urdf.inspect says of it after one change: a case for every code."""

import re
from dataclasses import dataclass

CLEAN = """\
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>
      <mass value="2.5"/>
      <inertia ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0 0 0.4" rpy="0 0 0"/>
      <mass value="1.5"/>
      <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0 0"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.3 0 0" rpy="0 0 0"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
  </joint>
  <joint name="flange" type="fixed">
    <origin xyz="0 0 0.2" rpy="0 0 0"/>
    <parent link="fore"/>
    <child link="tool"/>
  </joint>
</robot>
"""

MASS = '<mass value="2.5"/>'
INERTIA = '<inertia ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"/>'
FORE = '<inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>'
ORIGIN = '<origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>'
SHOULDER = '<joint name="shoulder" type="revolute">'
ELBOW = '<joint name="elbow" type="revolute">'
AXIS = '<axis xyz="0 0 1"/>'
LIMIT = '<limit lower="-1" upper="2" effort="30" velocity="3"/>'
TOOL = '<link name="tool"/>'
UNREADABLE = "Pinocchio gives a link with such a number mass 0 or a tensor of zero and refuses such a joint"
FORE_INERTIAL = re.findall(r"<inertial>.*?</inertial>", CLEAN, re.DOTALL)[1]

LOOP = '<loop name="l" type="{}"><predecessor link="base"/>'
FAR = '<successor link="fore"><origin xyz="9 0 0"/></successor>'
PARALLEL = (
    '<loop name="l" type="spherical"><predecessor link="base"><origin xyz="0.3 0 0.5"/></predecessor>'
    '<successor link="fore"/></loop>'
)
MOTOR = '<transmission><joint name="shoulder"/><actuator/></transmission>'


@dataclass(frozen=True)
class Case:
    """Replacements in CLEAN (old, new, old, new, …), each old text once, and the first finding of the code."""

    changes: tuple[str, ...]
    severity: str
    element: str | None
    line: int | None
    message: str
    remedy: str


def changed(*changes: str) -> str:
    """CLEAN with these replacements."""
    text = CLEAN
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in text
        text = text.replace(old, new, 1)
    return text


CASES = {
    "missing-name": Case(
        ('<robot name="arm">', "<robot>"),
        "error", "<robot>", 1,
        "attribute 'name' is missing or empty. Pinocchio and yourdfpy refuse a missing name, and load an empty one of "
        "a joint or robot",
        "give it a name",
    ),
    "duplicate-name": Case(
        (TOOL, '<link name="upper"/>'),
        "error", "link 'upper'", 17,
        "the name is already used in line 3. Pinocchio refuses the file, yourdfpy loads it",
        "rename one of the two",
    ),
    "missing-type": Case(
        (SHOULDER, '<joint name="shoulder">'),
        "error", "joint 'shoulder'", 18,
        "attribute 'type' is missing. Pinocchio refuses the file, yourdfpy loads it",
        "use one of revolute, continuous, prismatic, fixed",
    ),
    "unsupported-joint": Case(
        (SHOULDER, '<joint name="shoulder" type="floating">'),
        "error", "joint 'shoulder'", 18,
        "type 'floating' is not supported. Pinocchio knows floating and planar joints, yourdfpy loads any type",
        "use one of revolute, continuous, prismatic, fixed, or replace it by several of them",
    ),
    "unsupported-constraint": Case(
        ("</robot>", '<loop name="l" type="planar"><predecessor link="base"/><successor link="fore"/></loop></robot>'),
        "error", "<loop> of robot 'arm'", 37,
        "'l': type 'planar' is not modelled. Pinocchio and yourdfpy load the tree without it",
        "use one of revolute, continuous, prismatic, fixed, spherical, distance, or replace it by several links and "
        "joints",
    ),
    "invalid-loop": Case(
        ("</robot>", f"{LOOP.format('revolute')}<successor link=\"hand\"/></loop></robot>"),
        "error", "<loop> of robot 'arm'", 37,
        "'l': link 'hand' of <successor> does not exist. Pinocchio and yourdfpy load the tree without it",
        "correct the name or add the link",
    ),
    "loop-cannot-close": Case(
        ("</robot>", f"{LOOP.format('spherical')}{FAR}</loop></robot>"),
        "warning", None, None,
        "robot 'arm': the loop of chord 'l' is open by 7.2 m or rad; closed is 1e-08. None of 100 poses "
        "leads to a closed one: check where the chord stands on its bodies",
        "correct the loop, or the links on its way",
    ),
    "loop-rows": Case(
        ("</robot>", f"{PARALLEL}</robot>"),
        "note", None, None,
        "3 rows close loops: they hold 1 of 2 joint freedoms and leave 1; redundant rows: 2, so that not all reactions "
        "are determined",
        "nothing need be done; graphdyn.assemble closes states",
    ),
    "idle-freedoms": Case(
        ("</robot>", f"{PARALLEL}{MOTOR}</robot>"),
        "warning", None, None,
        "freedoms that no motor drives: 1; with all motors held, joints 'elbow' can move",
        "lock one joint of each (lock=), or state more motors",
    ),
    "independent-contradiction": Case(
        (ELBOW, ELBOW.replace(">", ' independent="false">'), "</robot>", f"{PARALLEL}</robot>"),
        "warning", None, None,
        "the loops leave 1 freedoms, and 1 joints are not marked independent=\"false\", whose motions determine 0 of "
        "them: 'shoulder'",
        "mark as independent as many joints as there are freedoms, so that they determine all others",
    ),
    "massless-closing-link": Case(
        (FORE_INERTIAL, "", "</robot>", f"{PARALLEL}</robot>"),
        "note", None, None,
        "loops close at bodies without mass: 'fore'. Pinocchio's constrained dynamics are NaN there",
        "nothing need be done, if other bodies of the loop have mass",
    ),
    "loops-not-examined": Case(
        ("</robot>", "".join(PARALLEL.replace('"l"', f'"l{k}"') for k in range(34)) + "</robot>"),
        "note", None, None,
        "the loops have 102 rows: more than 100 are not examined",
        "nothing need be done",
    ),
    "quaternion-origin": Case(
        ('xyz="0.3 0 0" rpy="0 0 0"', 'xyz="0.3 0 0" quat_xyzw="0 0 0 1"'),
        "error", "<origin> of joint 'elbow'", 26,
        "attribute 'quat_xyzw' is not read. Pinocchio reads it in files of version 1.1 and later, yourdfpy does not",
        "give the rotation as rpy",
    ),
    "unread-dynamics": Case(
        ("</robot>", '<gazebo reference="fore"><turnGravityOff>true</turnGravityOff></gazebo></robot>'),
        "warning", "<turnGravityOff> of robot 'arm'", 37,
        "<turnGravityOff> in <gazebo> turns gravity off for a link: not read. Pinocchio and yourdfpy do not read it "
        "either",
        "change the model after loading it, if that matters",
    ),
    "unknown-element": Case(
        (TOOL, f'<link name="tool"><innertial>{MASS}</innertial></link>'),
        "warning", "<innertial> of link 'tool'", 17,
        "URDF knows no <innertial> in <link>: not read. Pinocchio and yourdfpy do not read it either",
        "correct its name, or remove it",
    ),
    "unknown-attribute": Case(
        ('xyz="0.3 0 0" rpy', 'xzy="0.3 0 0" rpy'),
        "warning", "<origin> of joint 'elbow'", 26,
        "URDF knows no attribute 'xzy' of <origin>: not read. Pinocchio and yourdfpy do not read it either",
        "correct its name, or remove it",
    ),
    "missing-mass": Case(
        (MASS, "<mass/>"),
        "error", "<mass> of link 'upper'", 6,
        "attribute 'value' is missing. Pinocchio gives the link mass 0, yourdfpy mass 0 or none",
        "write it; nothing is assumed for it",
    ),
    "missing-inertia": Case(
        ('ixx="0.11" ', ""),
        "error", "<inertia> of link 'upper'", 7,
        "attribute 'ixx' is missing. Pinocchio gives the link a tensor of zero, yourdfpy takes 1 for ixx, iyy, izz "
        "and 0 for the others",
        "write it; nothing is assumed for it",
    ),
    "missing-parent": Case(
        ('<parent link="base"/>', ""),
        "error", "joint 'shoulder'", 18,
        "<parent> is missing. Pinocchio and yourdfpy refuse the file",
        "write it; nothing is assumed for it",
    ),
    "missing-child": Case(
        ('<child link="upper"/>', "<child/>"),
        "error", "<child> of joint 'shoulder'", 21,
        "attribute 'link' is missing",
        "write it; nothing is assumed for it",
    ),
    "missing-axis": Case(
        (AXIS, "<axis/>"),
        "error", "<axis> of joint 'shoulder'", 22,
        "attribute 'xyz' is missing",
        "write it; nothing is assumed for it",
    ),
    "duplicate-element": Case(
        (MASS, '<mass value="2.5"/><mass value="2.5"/>'),
        "error", "<inertial> of link 'upper'", 4,
        "2 elements <mass>. Pinocchio and yourdfpy take the first",
        "keep the one that is meant",
    ),
    "negative-mass": Case(
        ('"2.5"', '"-2.5"'),
        "error", "<mass> of link 'upper'", 6,
        "mass -2.5 kg is negative. Pinocchio loads it and loses the center of mass, yourdfpy loads it as it stands",
        "give a mass of at least 0",
    ),
    "zero-axis": Case(
        (AXIS, '<axis xyz="0 0 0"/>'),
        "error", "<axis> of joint 'shoulder'", 22,
        "the axis is zero. Pinocchio and yourdfpy load it as it stands",
        "give a direction",
    ),
    "unexpanded-number": Case(
        ('"2.5"', '"${m}"'),
        "error", "<mass> of link 'upper'", 6,
        f'value="${{m}}" is not expanded. {UNREADABLE}, yourdfpy refuses the file',
        "expand the file with xacro",
    ),
    "wrong-number-of-entries": Case(
        ('xyz="0.3 0 0"', 'xyz="0.3 0"'),
        "error", "<origin> of joint 'elbow'", 26,
        f'xyz="0.3 0" has 2 entries, expected 3. {UNREADABLE}, yourdfpy refuses all but such an axis',
        "separate numbers by spaces",
    ),
    "number-too-large": Case(
        ('ixx="0.11"', 'ixx="1e308"'),
        "error", "<inertia> of link 'upper'", 7,
        'ixx="1e308" is too large for a robot: results would overflow. Pinocchio and yourdfpy load it as it stands',
        "give kg, m and rad",
    ),
    "not-finite": Case(
        ('"2.5"', '"nan"'),
        "error", "<mass> of link 'upper'", 6,
        f'value="nan" is not finite. {UNREADABLE}, yourdfpy keeps the value',
        "give a finite number, or leave it out where optional",
    ),
    "malformed-number": Case(
        ('upper="2"', 'upper="-1.57."'),
        "error", "<limit> of joint 'shoulder'", 23,
        f"upper=\"-1.57.\": '-1.57.' is not a number. {UNREADABLE}, yourdfpy refuses the file",
        "correct the number",
    ),
    "missing-link": Case(
        ('<child link="tool"/>', '<child link="tol"/>'),
        "error", "joint 'flange'", 32,
        "child link 'tol' does not exist. Pinocchio refuses the file, yourdfpy loads it",
        "correct the name or add it",
    ),
    "two-parents": Case(
        ('<child link="tool"/>', '<child link="upper"/>'),
        "error", "joint 'flange'", 32,
        "link 'upper' is the child of joint 'shoulder' too. Pinocchio and yourdfpy load it as it stands",
        "a link has one parent; close the loop by <loop> instead of a second <joint>",
    ),
    "several-roots": Case(
        ('<link name="base"/>', '<link name="base"/><link name="shelf"/>'),
        "error", "robot 'arm'", 1,
        "several root links: 'base', 'shelf'. Pinocchio refuses the file, yourdfpy loads it",
        "connect them with fixed joints",
    ),
    "no-root": Case(
        ('<parent link="base"/>', '<parent link="tool"/>', '<link name="base"/>', ""),
        "error", "robot 'arm'", 1,
        "no root: every link is the child of a joint",
        "remove the cycle",
    ),
    "cycle": Case(
        ('<parent link="upper"/>', '<parent link="tool"/>'),
        "error", "joint 'elbow'", 25,
        "a cycle that the root does not reach, joints 'elbow', 'flange'. Pinocchio leaves these links out, "
        "yourdfpy loads them",
        "connect them to the root",
    ),
    "limits-crossed": Case(
        ('lower="-1"', 'lower="3"'),
        "error", "<limit> of joint 'shoulder'", 23,
        "lower limit 3 is above upper limit 2. Pinocchio and yourdfpy load it as it stands",
        "swap them, or load the file with repair=('limits',)",
    ),
    "no-moving-joint": Case(
        ('type="revolute"', 'type="fixed"', 'type="revolute"', 'type="fixed"'),
        "error", None, None,
        "no moving body: every joint is fixed or locked",
        "leave a joint free",
    ),
    "default-namespace": Case(
        ("<robot ", '<robot xmlns="http://www.ros.org" '),
        "note", None, 1,
        "the root element has the default namespace http://www.ros.org. Pinocchio ignores it, yourdfpy finds no "
        "link at all",
        "remove xmlns=… from <robot>",
    ),
    "extra-namespaces": Case(
        ("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:controller="x" '),
        "note", None, None,
        "declared namespaces that URDF does not need: 'xacro', 'controller'",
        "remove them",
    ),
    "xacro-tags": Case(
        ("</robot>", '<xacro:arm_macro xmlns:xacro="http://www.ros.org/wiki/xacro"/></robot>'),
        "warning", None, 37,
        "xacro elements that are left in and ignored: 1 ('xacro:arm_macro')",
        "expand the file with xacro: what they stand for is missing",
    ),
    "mesh-files": Case(
        (
            TOOL,
            '<link name="tool"><visual><geometry><mesh '
            'filename="package://a/b.stl"/></geometry></visual><collision><geometry><mesh '
            'filename="c.stl"/></geometry></collision></link>',
        ),
        "note", None, 17,
        "mesh files, not opened because dynamics need none: 2, of which 1 at package:// paths",
        "nothing need be done",
    ),
    "unexpanded-text": Case(
        ('name="flange"', 'name="${prefix}flange"'),
        "warning", None, 32,
        "attributes with ${…} or $(…) that are not expanded: 1",
        "expand the file with xacro",
    ),
    "duplicate-material": Case(
        ("</robot>", '<material name="grey"/>\n<material name="grey"/></robot>'),
        "warning", None, 38,
        "material 'grey' is defined 2 times, first in line 37. Pinocchio refuses the file, yourdfpy loads it",
        "keep one of them",
    ),
    "non-ascii": Case(
        ('"tool"', '"Werkzeug ä"', '"tool"', '"Werkzeug ä"'),
        "note", None, 17,
        "the text is not all ASCII",
        "make sure that other tools read it",
    ),
    "shared-name": Case(
        ('name="flange"', 'name="tool"'),
        "note", "joint 'tool'", 32,
        "the link in line 17 has this name too: the frame of this name is the link's",
        "give one of them another name",
    ),
    "slash-in-name": Case(
        ('name="flange"', 'name="a/flange"'),
        "note", "joint 'a/flange'", 32,
        "a slash in the name",
        "some tools take it for a namespace or a folder",
    ),
    "root-inertia": Case(
        (
            '<link name="base"/>',
            '<link name="base"><inertial><origin xyz="0 0 0"/><mass value="3"/><inertia ixx="0.1" ixy="0" ixz="0" '
            'iyy="0.11" iyz="0" izz="0.12"/></inertial></link>',
        ),
        "note", "<inertial> of link 'base'", 2,
        "a mass of 3 kg that never moves: load drops it, and no torque regressor contains it. Pinocchio keeps it "
        "apart, as inertia of the universe",
        "nothing need be done",
    ),
    "missing-inertial": Case(
        (FORE_INERTIAL, ""),
        "warning", "link 'fore'", 10,
        "the link moves and has no <inertial> (nor has any link fixed to it): its mass is zero. Pinocchio gives "
        "the link mass 0, yourdfpy none",
        "write an <inertial>",
    ),
    "fused-mass": Case(
        (
            TOOL,
            '<link name="tool"><inertial><origin xyz="0 0 0"/><mass value="0.5"/><inertia ixx="0.1" ixy="0" ixz="0" '
            'iyy="0.11" iyz="0" izz="0.12"/></inertial></link>',
        ),
        "note", "<inertial> of link 'tool'", 17,
        "the link is fixed: its 0.5 kg are added to the body of link 'fore'. Pinocchio does the same",
        "nothing need be done; urdf.fused_links gives the shares",
    ),
    "inertial-origin-missing": Case(
        (ORIGIN, ""),
        "note", "<inertial> of link 'upper'", 4,
        "without <origin>: the center of mass is the link origin",
        "write <origin>, if that is not meant",
    ),
    "inertial-rotated": Case(
        ('xyz="0 0 0.4" rpy="0 0 0"', 'xyz="0 0 0.4" rpy="0 0 0.3"'),
        "note", "<inertial> of link 'fore'", 11,
        "the inertial frame is rotated: the tensor is turned into link axes",
        "nothing need be done",
    ),
    "off-diagonal-inertia": Case(
        ('ixy="0"', 'ixy="0.01"'),
        "note", "<inertial> of link 'upper'", 4,
        "the tensor has off-diagonal entries",
        "nothing need be done",
    ),
    "zero-mass": Case(
        (MASS, '<mass value="0"/>', INERTIA, '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'),
        "warning", "<inertial> of link 'upper'", 4,
        "the mass is zero. Pinocchio and yourdfpy load it as it stands",
        "give the mass",
    ),
    "zero-inertia": Case(
        (FORE, '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'),
        "warning", "<inertial> of link 'fore'", 11,
        "1.5 kg with an inertia tensor of zero: a point mass. Pinocchio and yourdfpy load it as it stands",
        "give the tensor",
    ),
    "tiny-mass": Case(
        ('"2.5"', '"1e-6"'),
        "warning", "<inertial> of link 'upper'", 4,
        "the mass is 1e-06 kg",
        "give the mass in kg; it looks like a placeholder",
    ),
    "indefinite-inertia": Case(
        ('ixx="0.11"', 'ixx="-0.11"'),
        "warning", "<inertial> of link 'upper'", 4,
        "the tensor has a negative principal moment, -0.11 kg m²: no real body has one. Pinocchio and yourdfpy "
        "load it as it stands",
        "correct the tensor; a sign may be wrong, or entries swapped",
    ),
    "singular-inertia": Case(
        (FORE, '<inertia ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0"/>'),
        "warning", "<inertial> of link 'fore'", 11,
        "the tensor is singular: smallest principal moment 0 kg m². Pinocchio and yourdfpy load it as it stands",
        "give all moments",
    ),
    "triangle-inequality": Case(
        ('izz="0.17"', 'izz="0.5"'),
        "warning", "<inertial> of link 'upper'", 4,
        "principal moment 0.5 exceeds the sum 0.24 kg m² of the others. Pinocchio and yourdfpy load it as it stands",
        "correct the tensor: it must be about the center of mass, in kg m²",
    ),
    "isotropic-inertia": Case(
        (INERTIA, '<inertia ixx="0.11" ixy="0" ixz="0" iyy="0.11" iyz="0" izz="0.11"/>'),
        "note", "<inertial> of link 'upper'", 4,
        "the same moment about every axis, as of a sphere: probably a guess",
        "give the measured tensor, if forces matter",
    ),
    "gyration-radius": Case(
        (INERTIA, '<inertia ixx="11" ixy="0" ixz="0" iyy="13" iyz="0" izz="17"/>'),
        "warning", "<inertial> of link 'upper'", 4,
        "the radius of gyration is 2.61 m, the link reaches 0.374 m: tensor and mass do not fit",
        "give kg, m and kg m²; the tensor may be in kg mm² or g mm², or about another point",
    ),
    "rpy-truncated": Case(
        ('xyz="0.3 0 0" rpy="0 0 0"', 'xyz="0.3 0 0" rpy="1.5708 0 -3.1416"'),
        "note", "<origin> of joint 'elbow'", 26,
        "1.5708, -3.1416: a truncated multiple of π/2, off by 7.3e-06 rad; it is used as written",
        "write all digits: 1.5707963267948966",
    ),
    "joint-origin-missing": Case(
        ('<origin xyz="0 0 0.5" rpy="0 0 0"/>', ""),
        "note", "joint 'shoulder'", 18,
        "without <origin>: the joint is at the origin of its parent link",
        "write <origin>, if that is not meant",
    ),
    "continuous-joint": Case(
        (SHOULDER, '<joint name="shoulder" type="continuous">'),
        "note", "joint 'shoulder'", 18,
        "a continuous joint: its coordinate is one angle. In Pinocchio such a joint has two coordinates (cosine, "
        "sine), so that nq is not nv",
        "compare angles modulo 2π",
    ),
    "prismatic-joint": Case(
        (SHOULDER, '<joint name="shoulder" type="prismatic">'),
        "note", "joint 'shoulder'", 18,
        "a prismatic joint: metres and newtons",
        "nothing need be done",
    ),
    "mimic-joint": Case(
        (AXIS, '<axis xyz="0 0 1"/><mimic joint="elbow"/>'),
        "note", "joint 'shoulder'", 18,
        "it mimics joint 'elbow': it has no entry in q, v, a and τ. Pinocchio and yourdfpy load it as an independent "
        "joint unless asked otherwise",
        "nothing need be done; mimic='independent' makes it a joint of its own, mimic='locked' holds it still",
    ),
    "invalid-mimic": Case(
        (AXIS, '<axis xyz="0 0 1"/><mimic joint="knee"/>'),
        "error", "joint 'shoulder'", 18,
        "it mimics joint 'knee', which the robot lacks or chain= leaves out",
        "correct the name, take a longer chain, lock it, or load with mimic='independent'",
    ),
    "axis-missing": Case(
        (AXIS, ""),
        "note", "joint 'shoulder'", 18,
        "without <axis>: it is (1, 0, 0)",
        "write <axis>",
    ),
    "axis-not-normalised": Case(
        (AXIS, '<axis xyz="0 0 0.999"/>'),
        "note", "<axis> of joint 'shoulder'", 22,
        "the axis has length 0.999; load normalises it. Pinocchio normalises it, yourdfpy does not",
        "write it with more digits",
    ),
    "oblique-axis": Case(
        (AXIS, '<axis xyz="0 0.6 0.8"/>'),
        "note", "<axis> of joint 'shoulder'", 22,
        "the axis 0 0.6 0.8 is along no coordinate axis",
        "nothing need be done",
    ),
    "negative-axis": Case(
        (AXIS, '<axis xyz="0 0 -1"/>'),
        "note", "<axis> of joint 'shoulder'", 22,
        "the axis points along a negative coordinate axis",
        "nothing need be done",
    ),
    "limits-missing": Case(
        (LIMIT, '<limit lower="-1" effort="30" velocity="3"/>'),
        "warning", "<limit> of joint 'shoulder'", 23,
        "without upper: there is no such limit. Pinocchio refuses a revolute or prismatic joint without <limit>, "
        "and a <limit> without effort or velocity, and takes a missing lower or upper as 0 (in a file with "
        'version="1.2" it refuses that too)',
        "write it",
    ),
    "limits-zero": Case(
        ('lower="-1" upper="2"', 'lower="0" upper="0"'),
        "note", "<limit> of joint 'shoulder'", 23,
        "lower and upper limit are both 0: the joint cannot move; random states ignore such limits",
        "write the range",
    ),
    "effort-zero": Case(
        ('effort="30"', 'effort="0"'),
        "note", "<limit> of joint 'shoulder'", 23,
        "the effort limit is 0: a placeholder for an unknown one",
        "write the limit",
    ),
    "velocity-zero": Case(
        ('velocity="3"', 'velocity="0"'),
        "note", "<limit> of joint 'shoulder'", 23,
        "the velocity limit is 0: a placeholder for an unknown one",
        "write the limit",
    ),
    "effort-negative": Case(
        ('effort="30"', 'effort="-1"'),
        "warning", "<limit> of joint 'shoulder'", 23,
        "the effort limit -1 is negative. Pinocchio refuses the file, yourdfpy loads it",
        "write the limit",
    ),
    "velocity-negative": Case(
        ('velocity="3"', 'velocity="-1"'),
        "warning", "<limit> of joint 'shoulder'", 23,
        "the velocity limit -1 is negative. Pinocchio refuses the file, yourdfpy loads it",
        "write the limit",
    ),
    "joint-dynamics": Case(
        (AXIS, '<axis xyz="0 0 1"/><dynamics damping="0.5" friction="0.25"/>'),
        "note", "<dynamics> of joint 'shoulder'", 22,
        "damping 0.5, friction 0.25: kept with the joint, not part of the rigid dynamics. Pinocchio reads them too "
        "and leaves them out of rnea",
        "add it to the torques, if it matters",
    ),
    "unknown-joint-dynamics": Case(
        (AXIS, '<axis xyz="0 0 1"/><dynamics damping="0.5" mu_viscous="16"/>'),
        "note", "<dynamics> of joint 'shoulder'", 22,
        "URDF knows no attributes 'mu_viscous' of <dynamics>: not read",
        "correct their names, or give damping and friction",
    ),
    "rotor-inertia": Case(
        (),
        "note", None, None,
        "URDF has no place for rotor inertia: the model has none, though behind high gear ratios it can be most of "
        "the inertia that a motor accelerates",
        "add it to the mass matrix, if you know it",
    ),
    "inconsistent-body": Case(
        ('izz="0.17"', 'izz="0.5"'),
        "warning", "link 'upper'", 3,
        "together with all links fixed to it, no physically possible body: the pseudo-inertia matrix has eigenvalue "
        "-0.12. Pinocchio and yourdfpy load it as it stands",
        "correct mass, center of mass and tensor",
    ),
    "suspicious-lengths": Case(
        ('xyz="0 0 0.5"', 'xyz="0 0 500"'),
        "warning", None, None,
        "the joints span 500 m along the longest branch",
        "give lengths in metres; they may be in millimetres",
    ),
    "suspicious-masses": Case(
        ('"2.5"', '"25000"'),
        "warning", None, None,
        "2.5e+04 kg on a reach of 1 m",
        "give masses in kg; they may be in grams or tonnes",
    ),
    "urdf-version": Case(
        ('<robot name="arm">', '<robot name="arm" version="1.3">'),
        "warning", "robot 'arm'", 1,
        'version="1.3" is none of 1.0, 1.1, 1.2. Pinocchio refuses the file, yourdfpy loads it',
        "remove it",
    ),
    "processing-instruction": Case(
        (TOOL, f"{TOOL}<?hint x?>"),
        "warning", None, 17,
        "processing instructions <?…?> within the document: 1. Pinocchio refuses the file, yourdfpy loads it",
        "remove them",
    ),
    "name-spacing": Case(
        ('<child link="tool"/>', '<child link="\ntool"/>', 'name="tool"', 'name=" tool"'),
        "warning", "<child> of joint 'flange'", 36,
        "tabs or line breaks in link: an XML parser reads blanks. Pinocchio reads another name",
        "write blanks, or none",
    ),
    "number-spacing": Case(
        ('value="2.5"', 'value="2.5 "'),
        "warning", "<mass> of link 'upper'", 6,
        "blanks, tabs or line breaks in value that not every reader accepts. Pinocchio gives the link mass 0",
        "separate numbers by blanks, and put none after a single number",
    ),
    "incomplete-joint-part": Case(
        ('type="fixed">', 'type="fixed"><limit lower="0"/>'),
        "warning", "<limit> of joint 'flange'", 32,
        "without effort, velocity; dynamics do not need it. Pinocchio refuses the file",
        "correct it",
    ),
    "friction-negative": Case(
        (LIMIT, f'{LIMIT}<dynamics friction="-0.5"/>'),
        "warning", "<dynamics> of joint 'shoulder'", 23,
        "the friction -0.5 is negative. Pinocchio refuses the file, yourdfpy loads it",
        "write the friction",
    ),
    "reserved-name": Case(
        ('name="shoulder"', 'name="universe"'),
        "warning", "joint 'universe'", 18,
        "the ground has this name in Pinocchio. Pinocchio loads the file and confuses the two, yourdfpy "
        "loads it",
        "rename it",
    ),
    "far-center-of-mass": Case(
        ('xyz="0.1 0.2 0.3"', 'xyz="100 200 300"'),
        "warning", "<inertial> of link 'upper'", 4,
        "the center of mass is 374 m from the origin of the link",
        "give it in metres, in the link frame; it may be in millimetres",
    ),
    "other-encoding": Case(
        ("<robot", '<?xml version="1.0" encoding="ISO-8859-1"?><robot', '"tool"', '"töol"', '"tool"', '"töol"'),
        "warning", None, 1,
        "the text is encoded in ISO-8859-1. Pinocchio reads it as UTF-8, with other names or numbers",
        "save it in UTF-8",
    ),
    "mass-matrix-indefinite": Case(
        ('izz="0.17"', 'izz="-5"'),
        "warning", None, None,
        "the mass matrix has negative eigenvalues over 5 random states (seed 0): some motion has a negative "
        "kinetic energy",
        "correct the inertials that no real body can have",
    ),
    "mass-matrix-singular": Case(
        (FORE_INERTIAL, ""),
        "warning", None, None,
        "the mass matrix has rank 1 of 2 over 5 random states (seed 0): torques do not determine accelerations "
        "(bodies without mass or inertia: 'fore')",
        "give all moving links mass and inertia",
    ),
    "mass-matrix": Case(
        (),
        "note", None, None,
        "the mass matrix has rank 2 and condition number 1.12 to 3.56 over 5 random states (seed 0)",
        "nothing need be done",
    ),
    "mass-matrix-ill-conditioned": Case(
        (FORE_INERTIAL, f'<inertial><mass value="1e-9"/>{FORE.replace("0.0", "0.00000000005")}</inertial>'),
        "warning", None, None,
        "the condition number of the mass matrix reaches 5.27e+09: accelerations lose digits",
        "look for inertials that are far too small or too large",
    ),
}  # fmt: skip
