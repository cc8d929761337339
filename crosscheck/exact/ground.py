"""The ground frame in balls: at rest where the robot stands, or on a base that moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crosscheck.exact.balls import Balls, cross, nearest_rotation, zeros
from crosscheck.exact.robot import ExactRobot
from graphdyn.compiler import GROUND_SHAPES

BASE_SHAPES = {"rotation": (3, 3), "translation": (3,), "velocity": (6,), "acceleration": (6,)}
"""The arrays of graphdyn.BaseMotion, for one state."""


@dataclass(frozen=True, eq=False)
class ExactGround:
    """rotation to world axes (3, 3); position, velocity and acceleration of the origin, ω and ω̇ in world axes (3,)."""

    rotation: Balls
    position: Balls
    velocity: Balls
    acceleration: Balls
    omega: Balls
    alpha: Balls

    def columns(self, robot: ExactRobot) -> list[Any]:
        """The input of a program of graphdyn's recursions on a moving base: motions in the axes of the frame."""
        turned = {
            "velocity": self.velocity,
            "omega": self.omega,
            "alpha": self.alpha,
            "compensated": self.acceleration - robot.gravity,
        }
        own = {name: self.rotation.T @ vector for name, vector in turned.items()}
        placed = {"rotation": self.rotation.ravel(), "position": self.position}
        return [x for name in GROUND_SHAPES for x in {**placed, **own}[name]]


def ground(robot: ExactRobot, base: Mapping[str, Balls] | None = None) -> ExactGround:
    """base: BASE_SHAPES, of which the rotation is replaced by the nearest orthogonal matrix; at rest without"""
    arm = robot.base.translation
    if base is None:
        return ExactGround(robot.base.rotation, arm, zeros(3), zeros(3), zeros(3), zeros(3))
    rotation = nearest_rotation(base["rotation"])
    arm = rotation @ arm
    (velocity, omega), (acceleration, alpha) = ((x[:3], x[3:]) for x in (base["velocity"], base["acceleration"]))
    return ExactGround(
        rotation=rotation @ robot.base.rotation,
        position=base["translation"] + arm,
        velocity=velocity + cross(omega, arm),
        acceleration=acceleration + cross(alpha, arm) + cross(omega, cross(omega, arm)),
        omega=omega,
        alpha=alpha,
    )
