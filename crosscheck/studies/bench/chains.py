"""Serial chains of any number of bodies."""

from __future__ import annotations

import numpy as np

from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn._rotation import rotation_about

LENGTH, RADIUS, MASS = 0.2, 0.04, 1.0
"""Length, radius and mass of each body, a cylinder along z [m, m, kg]."""

TWIST = 1.0
"""Angle about z between consecutive joint frames [rad]: it leaves no zeros that a compiler could exploit."""


def chain(n_bodies: int) -> RobotModel:
    """A serial chain of revolute joints with axes normal to the chain."""
    across = MASS * (3 * RADIUS**2 + LENGTH**2) / 12
    tensor = np.diag([across, across, MASS * RADIUS**2 / 2])
    turn = rotation_about(np.array([0.0, 0.0, 1.0]), TWIST)
    bodies, joints = [], []
    for k in range(n_bodies):
        place = Placement(turn, np.array([0.0, 0.0, LENGTH if k else 0.0]))
        bodies.append(Body(f"body_{k + 1}", MASS, np.array([0.0, 0.0, LENGTH / 2]), tensor))
        joints.append(Joint(f"joint_{k + 1}", "revolute", k, place, np.array([1.0, 0.0, 0.0])))
    return RobotModel(f"chain of {n_bodies}", tuple(bodies), tuple(joints))
