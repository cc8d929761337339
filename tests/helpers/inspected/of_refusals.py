"""What urdf.load refuses, and what urdf.inspect says of it."""

from inspected.sample import AXIS, LOOP, MASS, SHOULDER, TOOL, UNREADABLE, Case

REFUSALS = {
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
        "'l': type 'planar' is not modeled. Pinocchio and yourdfpy load the tree without it",
        "use one of revolute, continuous, prismatic, fixed, spherical, distance, or replace it by several links and "
        "joints",
    ),
    "invalid-loop": Case(
        ("</robot>", f"{LOOP.format('revolute')}<successor link=\"hand\"/></loop></robot>"),
        "error", "<loop> of robot 'arm'", 37,
        "'l': link 'hand' of <successor> does not exist. Pinocchio and yourdfpy load the tree without it",
        "correct the name or add the link",
    ),
    "quaternion-origin": Case(
        ('xyz="0.3 0 0" rpy="0 0 0"', 'xyz="0.3 0 0" quat_xyzw="0 0 0 1"'),
        "error", "<origin> of joint 'elbow'", 26,
        "attribute 'quat_xyzw' is not read. Pinocchio reads it in files of version 1.1 and later, yourdfpy does not",
        "give the rotation as rpy",
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
        "error", "<child> of joint 'flange'", 35,
        "child link 'tol' does not exist. Pinocchio refuses the file, yourdfpy loads it",
        "correct the name or add it",
    ),
    "two-parents": Case(
        ('<child link="tool"/>', '<child link="upper"/>'),
        "error", "<child> of joint 'flange'", 35,
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
        "swap them, or load the file with repair=['limits'] (--repair limits)",
    ),
    "no-moving-joint": Case(
        ('type="revolute"', 'type="fixed"', 'type="revolute"', 'type="fixed"'),
        "error", None, None,
        "no moving body: every joint is fixed or locked",
        "leave a joint free",
    ),
    "invalid-mimic": Case(
        (AXIS, '<axis xyz="0 0 1"/><mimic joint="knee"/>'),
        "error", "joint 'shoulder'", 18,
        "it mimics joint 'knee', which the robot lacks or the chain leaves out",
        "correct the name, take a longer chain, lock it, or load with mimic='independent' (--mimic independent)",
    ),
}  # fmt: skip
