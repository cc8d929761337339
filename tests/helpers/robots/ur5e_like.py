"""An arm like the UR5e twice: as URDF, and as MJCF with a turned base, axes of a calibrated arm and other masses."""

import numpy as np

from graphdyn import Body, Joint, JointLimits, Placement, RobotModel
from graphdyn.model import rotation_about

NAMES = ("pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
MASSES = (3.8, 8.4, 2.3, 1.2, 1.25, 0.2)
OTHER_MASSES = (3.7, 8.0, 2.9, 1.2, 1.25, 0.3)
SHIFTS = (0.0, 0.9e-3, 1.1e-3, 0.5e-3, 0.8e-3, 0.6e-3)
"""Distances by which axes of the MJCF file are displaced in the link before them [m]."""

ACROSS = rotation_about([1, 0, 0], np.pi / 2)
PLACES = (
    Placement(np.eye(3), [0, 0, 0.1625]),
    Placement(ACROSS, [0, 0.05, 0]),
    Placement(np.eye(3), [-0.425, 0, 0.02]),
    Placement(np.eye(3), [-0.3922, 0, 0.06]),
    Placement(ACROSS, [0, -0.0997, 0.01]),
    Placement(ACROSS.T, [0, 0.0996, 0.02]),
)
CENTERS = (
    *((0, -0.02, 0.01), (-0.21, 0.01, 0.11), (-0.2, 0.01, 0.05)),
    *((0.01, -0.02, 0.03), (0.02, 0.01, 0.02), (0.01, 0.02, -0.03)),
)


def ur5e_like(masses=MASSES, shifts=None) -> RobotModel:
    """The arm; shifts: of axes, across them, in their joint frames [m]"""
    bodies, joints = [], []
    for k, (name, place, mass, center) in enumerate(zip(NAMES, PLACES, masses, CENTERS, strict=True)):
        shift = np.zeros(3) if shifts is None else place.rotation @ [shifts[k], 0, 0]
        inertia = mass * np.diag([0.01, 0.012, 0.008]) + 1e-3 * mass
        bodies.append(Body(f"{name}_link", mass, center, inertia))
        moved = Placement(place.rotation, place.translation + shift)
        limits = JointLimits(-2 * np.pi, 2 * np.pi, np.pi, 150.0)
        joints.append(Joint(f"{name}_joint", "revolute", k, moved, [0, 0, 1], limits))
    return RobotModel("ur5e_like", tuple(bodies), tuple(joints))
