"""The states at which functions under test are evaluated, and experiments that take a dynamics function apart.

The experiments are rest, acceleration from rest, and velocity at no acceleration: τ(q, v, a) = g(q) + M(q) a + c(q, v).
Differences of the torques of any function show which term is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

import graphdyn
from crosscheck.judging.special_states import (
    NEAREST_TO_ZERO,
    ORDINARY,
    nearest_to_zero,
    position_limits,
    special_states,
)
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.states import ACCELERATION_RANGE, LOAD
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


def split(function: Function, trial: JudgedStates, acceleration: float) -> EquationTerms:
    """All experiments with one call of the function."""
    size, n = trial.q.shape
    zero, unit = np.zeros_like(trial.q), acceleration * np.eye(n)
    q = np.concatenate([trial.q, np.repeat(trial.q, n, axis=0), trial.q, trial.q])
    v = np.concatenate([zero, np.zeros((size * n, n)), trial.v, 2 * trial.v])
    a = np.concatenate([zero, np.tile(unit, (size, 1)), zero, zero])
    rest, accelerated, moving, fast = np.split(function(q, v, a), [size, size + size * n, 2 * size + size * n])
    columns = (accelerated.reshape(size, n, n) - rest[:, None]) / acceleration
    return EquationTerms(rest, columns, moving - rest, fast - rest, acceleration)


def usual_acceleration(trial: JudgedStates) -> float:
    """An acceleration at which inertia takes torques as large as gravity: differences of torques then lose no
    digits."""
    weight = np.abs(inverse_dynamics(trial.model, trial.q, 0 * trial.q, 0 * trial.q).joint_wrenches).max()
    inertia = np.abs(mass_matrix(trial.model, trial.q)).max()
    return float(max(1.0, weight / inertia)) if inertia > 0 else 1.0


def scales(trial: JudgedStates, *all_parts: EquationTerms) -> dict[str, float]:
    """The scale of each part: its largest entry, and for differences of torques the joint wrenches."""
    wrench = float(np.abs(inverse_dynamics(trial.model, trial.q, trial.v, 0 * trial.v).joint_wrenches).max())
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


N_EXPERIMENT_STATES = 6
"""Number of states of the experiments; half of them with whole turns added to joints that can turn without end."""

N_TURNED_STATES = 10
"""Number of judged states with whole turns added, besides the random ones."""

BEYOND_LIMITS_SHARE = 0.2
"""States beyond the limits, on request, as a part of the random ones."""

MAX_BEYOND_LIMITS = 0.5
"""How far they are outside, at most: positions, as a part of the range; velocities, as a part of the limit."""

MAX_WHOLE_TURNS = 2
"""Largest number of whole turns added, in either direction."""


@dataclass(frozen=True, eq=False)
class JudgedStates(ScaledStates):
    """The judged states; the sizes of errors are graphdyn's.

    labels: what is special about each state, "" for ordinary ones (N,) or for all of them
    """

    labels: NDArray[np.str_] = field(default_factory=lambda: np.array(ORDINARY))

    @classmethod
    def draw(
        cls,
        model: RobotModel,
        samples: int,
        seed: int,
        *,
        needs_tau: bool,
        loaded: bool = False,
        beyond_limits: bool = False,
        frame: str | None = None,
    ) -> JudgedStates:
        """Random states, some with whole turns added, the pose within the limits that is nearest to zero, and special
        states.

        beyond_limits: adds states outside the limits, after the random ones
        """
        rng = np.random.default_rng(seed)
        q, v = model.random_state(rng, samples + N_TURNED_STATES + 1)
        if beyond_limits:
            outside = _beyond(model, np.random.default_rng(seed), int(np.ceil(BEYOND_LIMITS_SHARE * samples)))
            q, v = (np.concatenate([x[:samples], y, x[samples:]]) for x, y in zip((q, v), outside, strict=True))
            samples += len(outside[0])
        endless = np.array([_turns_without_end(joint) for joint in model.joints])
        turn = 2 * np.pi * endless * rng.integers(-MAX_WHOLE_TURNS, MAX_WHOLE_TURNS + 1, q.shape)
        turn[:samples] = 0
        q = q + turn
        q[-1] = [nearest_to_zero(joint) for joint in model.joints]
        a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
        factors = rng.uniform(0.5, 1.5, q.shape)  # drawn in any case: what follows is the same for all functions
        labels, *special = special_states(model, seed, ACCELERATION_RANGE)
        q, v, a = (np.concatenate([x, y]) for x, y in zip((q, v, a), special, strict=True))
        factors = np.concatenate([factors, np.where(a[-len(labels) :].any(axis=1, keepdims=True), factors[0], 0.0)])
        tau = graphdyn.inverse_dynamics(model, q, v, a).tau * factors if needs_tau else 0 * a
        weight = 9.81 * sum(body.mass for body in model.bodies)
        loads = LOAD * weight * rng.normal(size=(*q.shape, 6)) if loaded else None
        labels = np.concatenate([np.full(len(q) - len(labels) - 1, ORDINARY), [NEAREST_TO_ZERO], labels])
        return cls(model, q, v, a, tau, loads, frame, labels)

    def rows(self, selected: NDArray[np.bool_] | NDArray[np.intp]) -> JudgedStates:
        """Some of the states."""
        names = ("q", "v", "a", "tau", *([] if self.loads is None else ["loads"]))
        labels = np.broadcast_to(self.labels, len(self.q))
        return self.but(labels=labels[selected], **{name: getattr(self, name)[selected] for name in names})

    @property
    def ordinary(self) -> NDArray[np.bool_]:
        """Which states are not special (N,)."""
        return np.broadcast_to(self.labels == ORDINARY, len(self.q))

    def but(self, **arrays: Array | NDArray[np.str_]) -> JudgedStates:
        """The same robot in other states."""
        return replace(self, **arrays)  # type: ignore[arg-type]

    @property
    def trial(self) -> JudgedStates:
        """States for the experiments."""
        return self.rows(self.trial_rows)

    @property
    def trial_rows(self) -> NDArray[np.intp]:
        """Numbers of these states: random ones, then ones with whole turns added."""
        rows = [*range(N_EXPERIMENT_STATES // 2), *range(-N_TURNED_STATES, -N_TURNED_STATES + N_EXPERIMENT_STATES // 2)]
        drawn = np.flatnonzero(self.ordinary | (self.labels == NEAREST_TO_ZERO))
        rows = [row if row < 0 else row % len(drawn) for row in rows]
        return drawn[rows]


def joined(parts: Sequence[JudgedStates]) -> JudgedStates:
    """States of one robot, one part after the other."""
    first = parts[0]
    names = ("q", "v", "a", "tau", *([] if first.loads is None else ["loads"]))
    labels = np.concatenate([np.broadcast_to(part.labels, len(part.q)) for part in parts])
    return first.but(labels=labels, **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def _beyond(model: RobotModel, rng: np.random.Generator, count: int) -> tuple[Array, Array]:
    """q, v (count, n): every other position and velocity, on the average, is outside its limits, at a third of the
    states each those of positions alone, of velocities alone, and of both."""
    q, v = model.random_state(rng, count)
    for k, joint in enumerate(model.joints):
        outside, below = rng.integers(2, size=(2, 2, count)).astype(bool)
        outside[0, 1::3] = outside[1, 2::3] = False
        far = MAX_BEYOND_LIMITS * rng.uniform(size=(2, count))
        (lower, upper), speed = position_limits(joint), joint.limits.velocity
        if np.isfinite(upper):
            reach = far[0] * (upper - lower)
            q[:, k] = np.where(outside[0], np.where(below[0], lower - reach, upper + reach), q[:, k])
        if speed:
            v[:, k] = np.where(outside[1], np.where(below[1], -1, 1) * (1 + far[1]) * speed, v[:, k])
    return q, v


def _turns_without_end(joint: graphdyn.Joint) -> bool:
    limits = joint.limits
    return joint.kind == "continuous" or (joint.kind == "revolute" and limits.lower is None and limits.upper is None)
