"""What `graphdyn show 1` says of a state: where the bodies are, how they move, what holds them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from crosscheck.report.records._fields import Keywords, Number, Vector3

Vector6 = Annotated[Sequence[float], Keywords(minItems=6, maxItems=6)]
NumberMatrix = Sequence[Annotated[Sequence[float], Keywords(description="A row.")]]


@dataclass(frozen=True, kw_only=True)
class BodyPlacementRecord:
    """Where the link frame of a body is in the world."""

    name: str
    """Of its link."""

    xyz: Vector3
    """Origin (3) [m]."""

    rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""


@dataclass(frozen=True, kw_only=True)
class MassMotionRecord:
    """Center of mass and momentum of all moving bodies together, in world axes."""

    center_of_mass: Vector3
    """In the world (3) [m]."""

    center_of_mass_velocity: Vector3
    """(3) [m/s]"""

    momentum: Vector6
    """Linear, then angular about the center of mass (6) [kg m/s, kg m²/s]."""

    momentum_about_origin: Vector6
    """Linear, then angular about the world's origin (6) [kg m/s, kg m²/s]."""


@dataclass(frozen=True, kw_only=True)
class FrameStateRecord:
    """Where a named frame is, and how it moves."""

    name: str
    """Of the frame, as given."""

    reference: Literal["world", "local", "local_world_aligned"]
    """Point and axes of velocity and Jacobian, in Pinocchio's words."""

    xyz: Vector3
    """Origin in the world (3) [m]."""

    rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""

    velocity: Vector6
    """Linear velocity, then angular velocity (6) [m/s, rad/s]."""

    jacobian: Annotated[NumberMatrix, Keywords(minItems=6, maxItems=6)]
    """J with velocity = J v (6, n) [m, 1 of revolute joints, 1, 0 of prismatic ones]."""


@dataclass(frozen=True, kw_only=True)
class StateRecord:
    """The robot at one state."""

    q: Sequence[float]
    """Joint positions (n) [rad or m]."""

    v: Sequence[float]
    """Joint velocities (n) [rad/s or m/s]."""

    kinetic_energy: float
    """[J]"""

    potential_energy: float
    """[J], zero where the centers of mass are at the height of the world's origin."""

    motion: MassMotionRecord | None
    """Of the whole robot; null where no body has mass."""

    gravity_torque: Sequence[float] | None
    """What holds the robot at rest (n) [N m or N]; with loops, at the motors, and null where these are unknown or leave
    a motion free."""

    bias_torque: Sequence[float] | None
    """h in M a + h = τ (n) [N m or N]; with loops as gravity_torque."""

    mass_matrix: NumberMatrix
    """M (n, n) [kg m², kg m, kg]; of a robot with loops, of the tree, whose joints are free."""

    mass_matrix_condition: Number
    """2-norm condition number of M in SI units. Null where it is infinite."""

    bodies: Sequence[BodyPlacementRecord]
    """Where the link frames are."""

    frame: FrameStateRecord
