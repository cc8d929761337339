"""A robot written in the link frames, joint names and joint positions of another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.aligning.axes import matrix, placement_of
from graphdyn.aligning.joint_map import JointMap
from graphdyn.aligning.walk import Walk
from graphdyn.layout import Array
from graphdyn.model.parts import Body, Frame, Joint, JointLimits
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import Placement, rotation_about


def reexpressed(first: RobotModel, second: RobotModel, joint_map: JointMap, places: Array, walk: Walk) -> RobotModel:
    """B as the same robot with the link frames of A, as near as its axes allow.

    places: what moves ground and links of B, at q = 0, over those of A                        (n + 1, 4, 4)

    A link frame must lie on the axis of its joint: where the axis of B passes A's origin at a distance, its foot is
    taken. Of B's named frames those are kept that A has on the same link.
    """
    inside = np.linalg.inv(places[0] @ matrix(second.base)) @ matrix(first.base)
    bodies, joints, frames = [], [], []
    for k, (body, joint) in enumerate(zip(second.bodies, second.joints, strict=True)):
        frame = np.linalg.inv(places[k + 1] @ walk.second.links[k]) @ walk.first.links[k]  # A's link frame, in B's
        if not joint.is_prismatic:
            frame[:3, 3] = (joint.axis @ frame[:3, 3]) * joint.axis
        sign, zero = float(joint_map.signs[k]), float(joint_map.zeros[k])
        placement = np.linalg.inv(inside) @ matrix(joint.placement) @ matrix(_motion(joint, zero)) @ frame
        rotation = frame[:3, :3]
        joints.append(
            replace(
                joint,
                name=first.joints[k].name,
                placement=placement_of(placement),
                axis=sign * rotation.T @ joint.axis,
                limits=mapped_limits(joint.limits, sign, zero),
            )
        )
        center = rotation.T @ (body.center_of_mass - frame[:3, 3])
        bodies.append(Body(first.bodies[k].name, body.mass, center, rotation.T @ body.inertia @ rotation))
        here = np.linalg.inv(frame)
        for name, one in _frames_of(second, k + 1).items():
            if name in _frames_of(first, k + 1):
                frames.append(Frame(name, k + 1, placement_of(here @ matrix(one.placement))))
        inside = frame
    return RobotModel(
        second.name, tuple(bodies), tuple(joints), first.gravity, first.base, first.base_name, tuple(frames)
    )


def _frames_of(model: RobotModel, body: int) -> dict[str, Frame]:
    return {frame.name: frame for frame in model.frames if frame.body == body}


def _motion(joint: Joint, position: float) -> Placement:
    """What a joint does at this position."""
    if joint.is_prismatic:
        return Placement(np.eye(3), position * joint.axis)
    return Placement(rotation_about(joint.axis, position), np.zeros(3))


def mapped_limits(limits: JointLimits, sign: float, zero: float) -> JointLimits:
    """Limits of q_A from those of q_B = sign q_A + zero."""
    lower, upper = (None if each is None else sign * (each - zero) for each in (limits.lower, limits.upper))
    return replace(limits, lower=lower, upper=upper) if sign > 0 else replace(limits, lower=upper, upper=lower)
