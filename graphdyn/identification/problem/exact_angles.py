"""The robot that a file with rounded angles means: axes that are exactly parallel or perpendicular.

Many robot files write π/2 as 1.5708 or 1.571. Axes that are parallel in the robot are then apart by 1e-6 to 1e-3 rad in
the model, and torques show parameters that in the robot are regrouped with others. They are as weak as the angle is
small: no recording determines them, and noise makes them as large as one likes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

MAX_ANGLE_ROUNDING = 2e-3
"""Difference from a right angle or from parallel [rad] that is rounding: 1.57 for π/2 has 0.8e-3, 3.14 for π 1.6e-3."""

EXACT_ANGLE = 1e-12
"""Difference [rad] that the products of rotations leave of exact angles."""


def with_exact_angles(model: RobotModel) -> RobotModel:
    """The same robot with each axis exactly parallel or perpendicular to the one before it, where rounding hides that.

    The axes of the first joints are compared with gravity. The model itself where no axis turns.
    """
    joints, turned = list(model.joints), False
    for k, joint in enumerate(joints):
        before = joints[joint.inside - 1].axis if joint.inside else model.base.rotation.T @ model.gravity
        axis = joint.placement.rotation @ joint.axis
        exact = _exact_direction(axis, before)
        if exact is not None:
            rotation = _turn(axis, exact) @ joint.placement.rotation
            joints[k] = replace(joint, placement=replace(joint.placement, rotation=rotation))
            turned = True
    return replace(model, joints=tuple(joints)) if turned else model


def _exact_direction(axis: Array, before: Array) -> Array | None:
    """The unit vector next to an axis that is parallel or perpendicular to another; None if it is already, or far."""
    length = float(np.linalg.norm(before))
    if length == 0:
        return None
    other = before / length
    along = float(axis @ other)
    across = axis - along * other
    apart, tilted = float(np.linalg.norm(across)), abs(along)
    if EXACT_ANGLE < apart < MAX_ANGLE_ROUNDING:
        return np.asarray(np.copysign(1.0, along) * other)
    if EXACT_ANGLE < tilted < MAX_ANGLE_ROUNDING:
        return np.asarray(across / apart)
    return None


def _turn(start: Array, end: Array) -> Array:
    """The smallest rotation from one unit vector to another one nearby (3, 3), by Rodrigues' formula."""
    x, y, z = np.cross(start, end)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1.0 + start @ end))
