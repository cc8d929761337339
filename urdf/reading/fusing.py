"""Rigidly connected links become one body: masses, first moments and tensors add.

From links and joints to moving bodies: fixed and locked joints are fused, their links stay as frames.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from graphdyn import Body, Frame, Joint, JointLimits, Placement
from graphdyn.layout import Array
from graphdyn.model import parallel_axis, parameters_from_inertia, rotation_about
from urdf.document.numbers import MIN_UNLIMITED

if TYPE_CHECKING:
    import yourdfpy
    from yourdfpy.urdf import Joint as URDFJoint
    from yourdfpy.urdf import Link


@dataclass(frozen=True, eq=False)
class Inertial:
    """mass [kg]; center of mass (3,) [m]; tensor (3, 3) about it [kg m²], both in the axes of one link frame."""

    mass: float
    center: Array
    tensor: Array

    def seen_from(self, placement: Placement) -> Inertial:
        """The same inertial in another frame; placement: of its own frame in that one."""
        rotation = placement.rotation
        rotated = not np.array_equal(rotation, np.eye(3))  # an unrotated tensor keeps every bit
        return Inertial(
            self.mass,
            rotation @ self.center + placement.translation,
            rotation @ self.tensor @ rotation.T if rotated else self.tensor,
        )


def fuse(parts: Sequence[Inertial]) -> Inertial:
    """One inertial for all parts, given in the same frame.

    The tensor is summed about the common center of mass, from parallel-axis terms that are all ≥ 0: no cancellation.
    """
    if not parts:
        return Inertial(0.0, np.zeros(3), np.zeros((3, 3)))
    if len(parts) == 1:
        return parts[0]
    mass = sum(part.mass for part in parts)
    moment = np.sum([part.mass * part.center for part in parts], axis=0)
    center = moment / mass if mass > 0 else np.zeros(3)
    tensors = [part.tensor + parallel_axis(part.mass, part.center - center) for part in parts]
    return Inertial(mass, center, np.sum(tensors, axis=0))


@dataclass(eq=False)
class Assembly:
    """The bodies, joints and frames of a model.

    massless: per body without any <inertial>, the names of its links
    weightless: per body whose <inertial>s have mass zero, the names of their links
    locations: per link, its body and its placement in the link frame of that body
    fused: per fixed link with an <inertial>: number of the body that carries it, and what it adds to that body's
        inertial parameters (10,)
    """

    bodies: list[Body] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    massless: list[list[str]] = field(default_factory=list)
    weightless: list[list[str]] = field(default_factory=list)
    fused: dict[str, tuple[int, Array]] = field(default_factory=dict)
    locations: dict[str, tuple[int, Placement]] = field(default_factory=dict)


def assemble(robot: yourdfpy.urdf.Robot, root: str, order: Sequence[str], locked: Mapping[str, float]) -> Assembly:
    """Bodies and joints in the given order of joints; frames in file order.

    root: the root link, the ground; its inertia, and that of everything fused to it, never moves and is dropped
    locked: value per joint that is held still [rad or m]
    """
    by_name = {joint.name: joint for joint in robot.joints}
    links = {link.name: link for link in robot.links}
    assembly = Assembly()
    location = assembly.locations
    location[root] = 0, Placement()
    members: list[list[str]] = [[root]]  # per body: its links
    for joint in map(by_name.__getitem__, order):
        inside, placement = location[joint.parent]
        if joint.origin is not None:
            placement = placement @ _placement(joint.origin)
        if joint.type == "fixed" or joint.name in locked:
            location[joint.child] = inside, placement @ _motion(joint, locked.get(joint.name, 0.0))
            members[inside].append(joint.child)
        else:
            location[joint.child] = len(members), Placement()
            members.append([joint.child])
            assembly.joints.append(_joint(joint, inside, placement))
    for number, names in enumerate(members[1:], start=1):
        parts = {
            name: inertial.seen_from(location[name][1])
            for name in names
            if (inertial := _inertial(links[name])) is not None
        }
        whole = fuse(list(parts.values()))
        assembly.bodies.append(Body(names[0], whole.mass, whole.center, whole.tensor))
        assembly.fused |= {
            name: (number, parameters_from_inertia(part.mass, part.center, part.tensor))
            for name, part in parts.items()
            if name != names[0]
        }
        if not parts:
            assembly.massless.append(names)
        elif whole.mass == 0:
            assembly.weightless.append(list(parts))
    moving = {joint.name for joint in assembly.joints}
    assembly.frames = [
        Frame(joint.child, *location[joint.child], aliases=() if joint.name in links else (joint.name,))
        for joint in robot.joints
        if joint.name not in moving
    ]
    return assembly


def _placement(origin: np.ndarray | None) -> Placement:
    """Placement of yourdfpy's homogeneous matrix (4, 4); the identity for None, where the file has no <origin>."""
    return Placement() if origin is None else Placement(origin[:3, :3], origin[:3, 3])


def _motion(joint: URDFJoint, value: float) -> Placement:
    """Placement of the child link frame in the joint frame at this joint value [rad or m]."""
    if value == 0:
        return Placement()
    axis = _joint(joint, 0, Placement()).axis  # of unit length
    if joint.type == "prismatic":
        return Placement(translation=value * axis)
    return Placement(rotation_about(axis, value))


def _inertial(link: Link) -> Inertial | None:
    """Inertial of the link, in the axes of the link frame; None where the file has no <inertial>."""
    if link.inertial is None:
        return None
    inertial = Inertial(link.inertial.mass, np.zeros(3), link.inertial.inertia)
    return inertial.seen_from(_placement(link.inertial.origin))


def _joint(joint: URDFJoint, inside: int, placement: Placement) -> Joint:
    dynamics = joint.dynamics
    damping, friction = (dynamics.damping, dynamics.friction) if dynamics is not None else (None, None)
    return Joint(
        joint.name,
        joint.type,
        inside,
        placement,
        joint.axis,
        _limits(joint),
        damping=float(damping or 0.0),
        friction=float(friction or 0.0),
    )


def _limits(joint: URDFJoint) -> JointLimits:
    """The limits as the file states them, None where it states none. A continuous joint has no position limits."""
    names = ("velocity", "effort") if joint.type == "continuous" else ("lower", "upper", "velocity", "effort")
    stated = {name: getattr(joint.limit, name, None) for name in names}
    return JointLimits(
        **{name: limit for name, limit in stated.items() if limit is not None and abs(limit) < MIN_UNLIMITED}
    )
