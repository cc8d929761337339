"""The motion of the paper's experiment at one instant (section 3.1; docs/deviations.md, C2)."""

from __future__ import annotations

import numpy as np

from graphdyn import BaseMotion, kr500_experiment
from graphdyn.experiments import RAIL_ACCELERATION
from graphdyn.layout import Array

ALONG_THE_RAIL = np.array([1.0, 0.0, 0.0])


def joint_motion(time: float) -> tuple[Array, Array, Array]:
    """q, v, a (6,) at a time [s]."""
    recording = kr500_experiment([time])
    return recording.q[0], recording.v[0], recording.a[0]


def rail(time: float) -> BaseMotion:
    """The carriage at a time [s], from rest."""
    speed, acceleration = np.zeros(6), np.zeros(6)
    speed[:3], acceleration[:3] = RAIL_ACCELERATION * time * ALONG_THE_RAIL, RAIL_ACCELERATION * ALONG_THE_RAIL
    path = RAIL_ACCELERATION * time**2 / 2 * ALONG_THE_RAIL
    return BaseMotion(translation=path, velocity=speed, acceleration=acceleration)
