"""What urdf.inspect says of joints, their limits and dynamics."""

from inspected.sample import AXIS, LIMIT, SHOULDER, Case

JOINTS = {
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
        "a prismatic joint: meters and newtons",
        "no action needed",
    ),
    "mimic-joint": Case(
        (AXIS, '<axis xyz="0 0 1"/><mimic joint="elbow"/>'),
        "note", "joint 'shoulder'", 18,
        "it mimics joint 'elbow': it has no entry in q, v, a and τ. Pinocchio and yourdfpy load it as an independent "
        "joint unless asked otherwise",
        "no action needed; mimic='independent' (--mimic independent) makes it a joint of its own, "
        "mimic='locked' (--mimic locked) holds it still",
    ),
    "axis-missing": Case(
        (AXIS, ""),
        "note", "joint 'shoulder'", 18,
        "without <axis>: it is (1, 0, 0)",
        "write <axis>",
    ),
    "axis-not-normalized": Case(
        (AXIS, '<axis xyz="0 0 0.999"/>'),
        "note", "<axis> of joint 'shoulder'", 22,
        "the axis has length 0.999; load normalizes it. Pinocchio normalizes it, yourdfpy does not",
        "write it with more digits",
    ),
    "oblique-axis": Case(
        (AXIS, '<axis xyz="0 0.6 0.8"/>'),
        "note", "<axis> of joint 'shoulder'", 22,
        "the axis 0 0.6 0.8 is along no coordinate axis",
        "no action needed",
    ),
    "negative-axis": Case(
        (AXIS, '<axis xyz="0 0 -1"/>'),
        "note", "<axis> of joint 'shoulder'", 22,
        "the axis points along a negative coordinate axis",
        "no action needed",
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
    "friction-negative": Case(
        (LIMIT, f'{LIMIT}<dynamics friction="-0.5"/>'),
        "warning", "<dynamics> of joint 'shoulder'", 23,
        "the friction -0.5 is negative. Pinocchio refuses the file, yourdfpy loads it",
        "write the friction",
    ),
}  # fmt: skip
