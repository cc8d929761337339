"""Roll, pitch and yaw of a rotation, R = R_z(yaw) R_y(pitch) R_x(roll), accurate in every pose."""

from __future__ import annotations

import numpy as np

from graphdyn._rotation import rotation_about
from graphdyn.layout import Array


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """R (3, 3) of the three angles [rad]."""
    x, y, z = np.eye(3)
    return rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)


def rpy_from_rotation(rotation: Array) -> Array:
    """(roll, pitch, yaw) (3,) [rad], pitch in [-π/2, π/2], of a rotation (3, 3).

    Roll is taken from R_z(-yaw) R, so that the three angles are consistent: they reproduce the matrix to rounding even
    at pitch = ±π/2, where yaw alone is arbitrary. -0.0 becomes 0.0.
    """
    r = rotation
    yaw = np.arctan2(r[1, 0], r[0, 0])
    pitch = np.arctan2(-r[2, 0], np.hypot(r[0, 0], r[1, 0]))
    s, c = np.sin(yaw), np.cos(yaw)
    roll = np.arctan2(s * r[0, 2] - c * r[1, 2], c * r[1, 1] - s * r[0, 1])
    return np.array([roll, pitch, yaw]) + 0.0
