"""The elements of a URDF file, by what they mean for dynamics: one table for urdf.load and urdf.inspect.

URDF describes a tree of rigid bodies. Formats built on it have elements that close loops, couple joints, add forces or
change bodies. Tags are as written, with their prefix. Sources:

- ROS: the XML specification of URDF, wiki.ros.org/urdf/XML; the README of urdfdom for the versions 1.1 and 1.2
- URDF+: M. Chignoli et al., "URDF+: An Enhanced URDF for Robots with Kinematic Loops", 2024, arXiv:2411.19753
- Drake: "Parsing Models for Multibody Systems", section Drake Extensions; loop_joint is that of its former
  RigidBodyTree, read by RigidBodyDynamics.jl too
- constraint: the proposal of ros/urdfdom, pull request 264
- Gazebo: "SDFormat extensions to URDF (the <gazebo> tag)"; what it does not know is copied into the SDFormat model.
  joint:hinge and joint:slider are those of versions before 1.0
- MuJoCo: the documentation, chapter Modeling, section URDF extensions
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from lxml import etree

FIXED_JOINT_CHILDREN = ("origin", "parent", "child")
"""Children of a fixed joint that are read."""

READ_CHILDREN: Mapping[str, tuple[str, ...]] = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": (*FIXED_JOINT_CHILDREN, "axis", "limit", "dynamics", "mimic"),
    "origin": (),
    "mass": (),
    "inertia": (),
    "axis": (),
    "parent": (),
    "child": (),
    "limit": (),
    "dynamics": (),
    "mimic": (),
    "loop": ("predecessor", "successor", "axis", "length"),
    "coupling": ("predecessor", "successor", "ratio"),
    "predecessor": ("origin",),
    "successor": ("origin",),
    "loop_joint": ("link1", "link2", "axis"),
    "constraint": ("parent", "child", "parent_origin", "child_origin", "parent_axis", "child_axis"),
}
"""Per element that is read, its children that are read."""

LOOPS = ("loop", "coupling", "loop_joint", "constraint")
"""Elements of <robot> that close loops or couple joints, of forms that are read."""

NUMBERS: Mapping[str, Mapping[str, int]] = {
    "origin": {"xyz": 3, "rpy": 3},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "velocity": 1, "effort": 1},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "safety_controller": {"soft_lower_limit": 1, "soft_upper_limit": 1, "k_position": 1, "k_velocity": 1},
    "calibration": {"rising": 1, "falling": 1, "reference_position": 1},
}
"""Per element of a link or joint, its attributes that are numbers: how many each holds."""

ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    "inertial": (),
    "origin": (*NUMBERS["origin"], "quat_xyzw"),
    **{tag: tuple(NUMBERS[tag]) for tag in ("mass", "inertia", "axis")},
    "parent": ("link",),
    "child": ("link",),
    "predecessor": ("link",),
    "successor": ("link",),
    "link1": ("link", "xyz", "rpy"),
    "link2": ("link", "xyz", "rpy"),
    "parent_origin": ("xyz", "rpy", "quat_xyzw"),
    "child_origin": ("xyz", "rpy", "quat_xyzw"),
    "parent_axis": ("xyz",),
    "child_axis": ("xyz",),
    "ratio": ("value",),
    "length": ("value",),
}
"""Per element that dynamics are computed from, the attributes that URDF knows."""

CLOSING_CHILDREN: Mapping[str, Mapping[str, str]] = {
    "robot": {
        "loop": "closes a kinematic loop (URDF+)",
        "coupling": "couples joints (URDF+)",
        "loop_joint": "closes a kinematic loop (Drake)",
        "constraint": "constrains the motion of links",
        "drake:joint": "is a joint of a type that URDF does not know (Drake)",
        "drake:ball_constraint": "closes a kinematic loop (Drake)",
        "drake:tendon_constraint": "couples joints (Drake)",
        "drake:linear_bushing_rpy": "joins two links by springs (Drake)",
        "drake:linear_spring_damper": "joins two links by a spring (Drake)",
    },
    "gazebo": {
        "joint": "is a joint for Gazebo alone, which closes a kinematic loop",
        "joint:hinge": "is a joint for Gazebo alone, which closes a kinematic loop",
        "joint:slider": "is a joint for Gazebo alone, which closes a kinematic loop",
    },
    "mujoco": {
        "equality": "constrains the motion of links (MuJoCo)",
        "tendon": "couples joints (MuJoCo)",
    },
}
"""Per element, the children that close loops, couple joints or join links: urdf.load reads them or refuses."""


def _value(element: etree._Element) -> str:
    return (element.get("value") or element.text or "").strip().lower()


def _is_true(element: etree._Element) -> bool:
    return _value(element) in ("true", "1")


def _is_false(element: etree._Element) -> bool:
    return _value(element) in ("false", "0")


def _is_not_zero(element: etree._Element) -> bool:
    return not _zero(_value(element))


def _has_friction(element: etree._Element) -> bool:
    return any(not _zero(element.get(name, "0")) for name in ("damping", "friction"))


def _zero(text: str) -> bool:
    try:
        return float(text) == 0
    except ValueError:
        return False


def _always(element: etree._Element) -> bool:
    return True


UNREAD_CHANGES: Mapping[str, Mapping[str, tuple[str, Callable[[etree._Element], bool]]]] = {
    "link": {
        "gravity": ("turns gravity off for the link", _is_false),
        "kinematic": ("holds the link still", _is_true),
    },
    "joint": {"joint_properties": ("gives damping and friction, which <dynamics> should", _has_friction)},
    "gazebo": {
        "gravity": ("turns gravity off for a link", _is_false),
        "turnGravityOff": ("turns gravity off for a link", _is_true),
        "kinematic": ("holds a link still", _is_true),
        "static": ("holds the robot still", _is_true),
        "dampingFactor": ("damps the motion of a link", _is_not_zero),
        "velocity_decay": ("damps the motion of a link", _always),
        "springStiffness": ("puts a spring on a joint", _is_not_zero),
        "inertial": ("gives a link another inertia", _always),
        "link": ("adds a link", _always),
        "model": ("adds bodies", _always),
        "include": ("adds bodies", _always),
        "enable_wind": ("lets wind act on a link", _is_true),
    },
    "actuator": {"drake:rotor_inertia": ("gives the inertia of a rotor", _is_not_zero)},
    "mujoco": {
        "compiler": (
            "lets MuJoCo change masses and tensors",
            lambda element: any(
                element.get(name, "false").lower() not in ("false", "auto", "0", "-1")
                for name in ("balanceinertia", "boundmass", "boundinertia", "inertiafromgeom", "settotalmass")
            ),
        ),
        "option": (
            "changes gravity or adds a medium",
            lambda element: any(name in element.attrib for name in ("gravity", "wind", "density", "viscosity")),
        ),
    },
}
"""Per element, the children that change the dynamics elsewhere and are not read: what they do there, and when."""

HARMLESS_CHILDREN: Mapping[str, tuple[str, ...]] = {
    "robot": (
        *("material", "transmission", "gazebo", "ros2_control", "mujoco", "sensor", "frame", "plugin"),
        *("group", "group_state", "end_effector", "virtual_joint", "disable_collisions", "author", "license"),
        *("drake:collision_filter_group", "capsule"),
    ),
    "link": (
        *("visual", "collision", "contact", "surface", "sensor", "origin", "material"),
        *("self_filter", "self_collision_checking", "collision_checking", "gravity", "kinematic"),
    ),
    "joint": (*READ_CHILDREN["joint"], "calibration", "safety_controller", "joint_properties", "hardwareInterface"),
}
"""Per element, other children that do not affect dynamics."""
