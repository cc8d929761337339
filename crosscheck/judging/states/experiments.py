"""Experiments that take a dynamics function apart: rest, acceleration from rest, velocity at no acceleration.

τ(q, v, a) = g(q) + M(q) a + c(q, v). Differences of the torques of any function show which term is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from graphdyn import RobotModel, inverse_dynamics, mass_matrix
from graphdyn.layout import Array

Function = Callable[[Array, Array, Array], Array]
"""q, v, a (N, n) → torques (N, n)."""

EXPERIMENT_PARTS = {
    "gravity": "at rest (v = 0, a = 0)",
    "inertia": "accelerated from rest, one joint at a time, gravity subtracted",
    "velocity": "moving at a = 0, gravity subtracted",
}
"""The experiment for each part, in words."""

MIN_VELOCITY_TORQUE_SHARE = 1e-3
"""Smallest scale of velocity torques, as a part of the joint wrenches: they are differences of torques."""


@dataclass(frozen=True, eq=False)
class TrialStates:
    """The states of the experiments: q, v (N, n)."""

    q: Array
    v: Array


@dataclass(frozen=True, eq=False)
class EquationTerms:
    """The terms of a function; None where it does not give them. The trailing dimensions are those of the function.

    gravity: g                                              (N, n, …)
    inertia: one column of M per joint                      (N, n, n, …): state, accelerated joint, torque
    velocity, doubled: c at v and at 2 v                    (N, n, …)
    acceleration: at which the columns of M were found [rad/s² or m/s²]
    """

    gravity: Array | None = None
    inertia: Array | None = None
    velocity: Array | None = None
    doubled: Array | None = None
    acceleration: float = 1.0

    def known(self) -> tuple[str, ...]:
        return tuple(part for part in EXPERIMENT_PARTS if getattr(self, part) is not None)


def torques(model: RobotModel) -> Function:
    return lambda q, v, a: inverse_dynamics(model, q, v, a).tau


def split(function: Function, trial: TrialStates, acceleration: float) -> EquationTerms:
    """All experiments with one call of the function."""
    size, n = trial.q.shape
    zero, unit = np.zeros_like(trial.q), acceleration * np.eye(n)
    q = np.concatenate([trial.q, np.repeat(trial.q, n, axis=0), trial.q, trial.q])
    v = np.concatenate([zero, np.zeros((size * n, n)), trial.v, 2 * trial.v])
    a = np.concatenate([zero, np.tile(unit, (size, 1)), zero, zero])
    rest, accelerated, moving, fast = np.split(function(q, v, a), [size, size + size * n, 2 * size + size * n])
    columns = (accelerated.reshape(size, n, n) - rest[:, None]) / acceleration
    return EquationTerms(rest, columns, moving - rest, fast - rest, acceleration)


def usual_acceleration(model: RobotModel, trial: TrialStates) -> float:
    """An acceleration at which inertia takes torques as large as gravity: differences of torques then lose no
    digits."""
    weight = np.abs(inverse_dynamics(model, trial.q, 0 * trial.q, 0 * trial.q).joint_wrenches).max()
    inertia = np.abs(mass_matrix(model, trial.q)).max()
    return float(max(1.0, weight / inertia)) if inertia > 0 else 1.0


def scales(model: RobotModel, trial: TrialStates, *all_parts: EquationTerms) -> dict[str, float]:
    """The scale of each part: its largest entry, and for differences of torques the joint wrenches."""
    wrench = float(np.abs(inverse_dynamics(model, trial.q, trial.v, 0 * trial.v).joint_wrenches).max())
    floor = {"gravity": wrench, "inertia": 0.0, "velocity": MIN_VELOCITY_TORQUE_SHARE * wrench}
    largest = {
        part: max([floor[part], *(_size(getattr(parts, part)) for parts in all_parts if part in parts.known())])
        for part in EXPERIMENT_PARTS
    }
    return {part: size or 1.0 for part, size in largest.items()}


def deviations(x: EquationTerms, y: EquationTerms, scale: dict[str, float]) -> dict[str, float]:
    """Largest relative difference of each part that both have; NaN counts as infinite."""
    known = [part for part in x.known() if part in y.known()]
    found = {part: _size(getattr(x, part) - getattr(y, part)) / scale[part] for part in known}
    return {part: value if np.isfinite(value) else np.inf for part, value in found.items()}


def _size(x: Array) -> float:
    return float(np.abs(x).max())
