"""The paper's robot: KUKA KR500 as six homogeneous steel cylinders (section 3, Table 2; docs/deviations.md, C1)."""

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.experiments.experiment import simulate_recording
from graphdyn.experiments.virtual_recording import VirtualRecording
from graphdyn.model.parts import Body, Joint
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import Placement
from graphdyn.motion_laws import ConstantAcceleration, Rail

STEEL_DENSITY = 7801.0
"""Steel [kg/m³]: with it the cylinder formula gives Table 2 to every printed digit."""

GRAVITY = (0.0, 0.0, -9.80665)
BODY_LENGTHS = (1.045, 1.245, 1.21, 0.315, 0.29, 0.3)
BODY_RADII = (0.5, 0.3, 0.2, 0.2, 0.2, 0.3)

RAIL_ACCELERATION = 2.0
"""Acceleration of the moving base along e_1^(0) [m/s²]."""

JOINT_ACCELERATION = np.radians(30.0)
"""Accelerations of joints O1 (positive) and O2 (negative) in the experiment of section 3.1 [rad/s²]."""

_E1, _E2 = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
_AXES = (_E1, _E2, _E2, _E1, _E2, _E1)
_UPRIGHT = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Columns e_1 = z, e_2 = y, e_3 = -x: bodies 1 and 2 stand at q = 0, bodies 3 to 6 lie along the world x axis."""


def cylinder(name: str, length: float, radius: float, density: float = STEEL_DENSITY) -> Body:
    """Homogeneous cylinder along e_1 with its inside joint at one end, Eq. (21). [m, m, kg/m³]"""
    mass = density * np.pi * radius**2 * length
    along, across = mass * radius**2 / 2, mass * (3 * radius**2 + length**2) / 12
    return Body(name, mass, np.array([length / 2, 0.0, 0.0]), np.diag([along, across, across]))


def kr500() -> RobotModel:
    """The KR500 of the paper, gravity 9.80665 m/s² along -z; q = 0 is the initial pose of Figure 2.

    >>> import graphdyn
    >>> model = graphdyn.kr500()
    >>> model.joint_names
    ('O1', 'O2', 'O3', 'O4', 'O5', 'O6')
    """
    bodies = [
        cylinder(f"B{i}", length, radius)
        for i, (length, radius) in enumerate(zip(BODY_LENGTHS, BODY_RADII, strict=True), 1)
    ]
    rotations = (_UPRIGHT, np.eye(3), _UPRIGHT.T, np.eye(3), np.eye(3), np.eye(3))
    ends = (0.0, *BODY_LENGTHS[:-1])
    joints = [
        Joint(f"O{j}", "continuous", j - 1, Placement(rotation, np.array([end, 0.0, 0.0])), np.array(axis))
        for j, (rotation, end, axis) in enumerate(zip(rotations, ends, _AXES, strict=True), start=1)
    ]
    return RobotModel("kr500", tuple(bodies), tuple(joints), gravity=np.array(GRAVITY), base_name="B0")


def kr500_experiment(times: ArrayLike | None = None) -> VirtualRecording:
    """The experiment of section 3.1, which the paper simulated with ADAMS (docs/deviations.md, C2).

    From rest in the initial pose of Figure 2 the moving base accelerates at 2 m/s² along e_1^(0), joint O1 at +30°/s²
    about the vertical, joint O2 at -30°/s² about its e_2, so that B2 leans back; the others are locked. The text gives
    the 30°/s² as 9.5493 rad/s² (it is 0.5236 rad/s²) and no sign; only this one gives the printed positive λ_64, λ_65.
    Eq. (75)-(77) hold O_1 at O_0, which contradicts the rail: here the base moves as prescribed.

    times: increasing; if left out, the paper's 0 … 2 s in 100 steps      (N,)  [s]

    >>> import graphdyn
    >>> graphdyn.kr500_experiment([0.0, 1.0, 2.0])
    <VirtualRecording: virtual recording of kr500: 6 joints, 3 rows, 0 to 2 s>
    """
    return simulate_recording(
        kr500(),
        np.linspace(0.0, 2.0, 101) if times is None else times,
        {"O1": ConstantAcceleration(JOINT_ACCELERATION), "O2": ConstantAcceleration(-JOINT_ACCELERATION)},
        base=Rail((1.0, 0.0, 0.0), ConstantAcceleration(RAIL_ACCELERATION)),
    )
