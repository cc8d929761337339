"""Regressors as steps of one body: Atkeson, An and Hollerbach, 1986 (graphdyn.recursions.regressors)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from graphdyn.compiler.rolled.program import ColumnPasses, Pass, Product
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps.matrices import ACCELERATED, inverse
from graphdyn.compiler.rolled.steps.world import axis, ground, moved, moving
from graphdyn.layout import ANGULAR, LINEAR
from graphdyn.recursions.motion import BodyMotion
from graphdyn.recursions.regressors import of_moving_body
from graphdyn.scalars.vectors import Scalars, cross, zeros

WITH_FORCE = 4
"""Parameters that take a force, m and m c; those of the tensor take a moment alone."""


def _regressor(x: BodyStep) -> Scalars:
    """Y (6, 10) in link axes."""
    to_link = x.link.link_axes @ x.kept("rotation").T
    return of_moving_body(BodyMotion(*(to_link @ x.kept(name) for name in ("omega", "alpha", "compensated"))))


def _of_body(x: BodyStep) -> None:
    moving(x)
    x.answer("body_regressor", _regressor(x))


def _taken(x: BodyStep) -> None:
    """Force and moment per parameter, in world axes."""
    to_world, regressor = x.kept("rotation") @ x.link.link_axes.T, _regressor(x)
    x.carry("force", to_world @ regressor[LINEAR, :WITH_FORCE])
    x.carry("moment", to_world @ regressor[ANGULAR, :WITH_FORCE])
    x.carry("moment_alone", to_world @ regressor[ANGULAR, WITH_FORCE:])


def _felt(array: str) -> Callable[[BodyStep], None]:
    def felt(x: BodyStep) -> None:
        force, moment, alone, arm, p = *map(x.carried, ("force", "moment", "moment_alone")), x.kept("arm"), axis(x)
        row = [*(p @ force), *zeros(alone.shape[1])] if x.prismatic else [*(p @ moment), *(p @ alone)]
        x.answer(array, row, "body", "column")
        x.carry("moment", moment + np.array([cross(arm, column) for column in force.T], dtype=object).T)

    return felt


def _joint_torques(array: str) -> ColumnPasses:
    return ColumnPasses((Pass("column", _taken), Pass("path", _felt(array))))


def _resting(x: BodyStep) -> None:
    ground(x)
    for name in ("omega", "alpha", "compensated"):
        x.keep(name, zeros(3))


def _starting(x: BodyStep) -> None:
    moved(x, 0.0, x.joint("v"))


PASSES: dict[str, tuple[Pass | ColumnPasses | Product, ...]] = {
    "body_regressor": (Pass("ground", ground), Pass("outwards", _of_body)),
    "joint_torque_regressor": (
        Pass("ground", ground),
        Pass("outwards", moving),
        _joint_torques("joint_torque_regressor"),
    ),
    "momentum_regressor": (Pass("ground", _resting), Pass("outwards", _starting), _joint_torques("momentum_regressor")),
    "forward_dynamics_parameter_derivatives": (
        *ACCELERATED,
        _joint_torques("joint_torque_regressor"),
        *inverse("mass_matrix_inverse"),
        Product("mass_matrix_inverse", "joint_torque_regressor", "forward_dynamics_parameter_derivatives", sign=-1),
    ),
}
"""Passes by recursion."""
