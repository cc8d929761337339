"""The paper's robot: KUKA KR500 as six homogeneous steel cylinders (section 3, Table 2; docs/deviations.md, C1)."""

import numpy as np

from graphdyn.model import Body, Joint, RobotModel
from graphdyn.placement import Placement

DENSITY = 7801.0
"""Steel [kg/m³]: with it the cylinder formula gives Table 2 to every printed digit."""

GRAVITY = (0.0, 0.0, -9.80665)
LENGTHS = (1.045, 1.245, 1.21, 0.315, 0.29, 0.3)
RADII = (0.5, 0.3, 0.2, 0.2, 0.2, 0.3)

_E1, _E2 = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
_AXES = (_E1, _E2, _E2, _E1, _E2, _E1)
_UPRIGHT = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Columns e_1 = z, e_2 = y, e_3 = -x: bodies 1 and 2 stand at q = 0, bodies 3 to 6 lie along the world x axis."""


def cylinder(name: str, length: float, radius: float, density: float = DENSITY) -> Body:
    """Homogeneous cylinder along e_1 with its inside joint at one end, Eq. (21). [m, m, kg/m³]"""
    mass = density * np.pi * radius**2 * length
    along, across = mass * radius**2 / 2, mass * (3 * radius**2 + length**2) / 12
    return Body(name, mass, np.array([length / 2, 0.0, 0.0]), np.diag([along, across, across]))


def kr500() -> RobotModel:
    """The KR500 of the paper, gravity 9.80665 m/s² along -z; q = 0 is the initial pose of Figure 2."""
    bodies = [
        cylinder(f"B{i}", length, radius) for i, (length, radius) in enumerate(zip(LENGTHS, RADII, strict=True), 1)
    ]
    rotations = (_UPRIGHT, np.eye(3), _UPRIGHT.T, np.eye(3), np.eye(3), np.eye(3))
    ends = (0.0, *LENGTHS[:-1])
    joints = [
        Joint(f"O{j}", "continuous", j - 1, Placement(rotation, np.array([end, 0.0, 0.0])), np.array(axis))
        for j, (rotation, end, axis) in enumerate(zip(rotations, ends, _AXES, strict=True), start=1)
    ]
    return RobotModel("kr500", tuple(bodies), tuple(joints), gravity=np.array(GRAVITY), base_name="B0")
