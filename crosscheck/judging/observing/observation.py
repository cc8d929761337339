"""Experiments with a function under test: its answers as torques, and how far the torques of codes are from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.recursion import DynamicsCode, State, torques_of
from crosscheck.judging.observing.function_under_test import FunctionUnderTest
from crosscheck.judging.states import (
    EXPERIMENT_PARTS,
    EquationTerms,
    JudgedStates,
    split,
    usual_acceleration,
)
from graphdyn import inverse_dynamics
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Observation:
    """Answers at T rows, from torques at R states.

    state: q, v, a (R, n)
    of: the state of each row (T,); less: the one whose torques are subtracted, -1 for none (T,)
    answers: torques, or differences of torques, relative to their scale (T, n); scale: (T, 1) [N m or N]
    part: "gravity", "inertia", "velocity" for the experiments, "judged" for judged states (T,)
    """

    state: State
    of: NDArray[np.intp]
    less: NDArray[np.intp]
    answers: Array
    scale: Array
    part: NDArray[np.str_]

    @property
    def state_key(self) -> tuple[bytes, ...]:
        """What tells its states from others."""
        return tuple(x.tobytes() for x in self.state)

    def residuals(self, codes: Sequence[DynamicsCode]) -> Array:
        """How far the torques of K codes are from the answers, relative to the scale (K, T, n)."""
        return self.left_by(torques_of(codes, self.state))

    def left_by(self, tau: Array) -> Array:
        """How far torques (K, R, n) of K codes are from the answers, relative to the scale (K, T, n)."""
        subtracted = np.where((self.less >= 0)[:, None], tau[:, self.less], 0.0)
        found: Array = (tau[:, self.of] - subtracted) / self.scale - self.answers
        return found

    def torques(self) -> Array:
        """The answers as torques [N m or N], where nothing is subtracted or what is subtracted is an answer too."""
        torque = self.answers * self.scale
        row = {int(state): k for k, state in enumerate(self.of)}
        added = np.array([row.get(int(state), -1) for state in self.less])
        whole = torque + np.where((added >= 0)[:, None], torque[added], 0.0)
        known: Array = whole[(self.less < 0) | (added >= 0)]
        return known

    def only(self, rows: NDArray[np.bool_]) -> Observation:
        """Some of the rows, and the states that they need."""
        of, less = self.of[rows], self.less[rows]
        needed = np.unique(np.concatenate([of, less[less >= 0]]))
        place = np.zeros(len(self.state[0]) + 1, dtype=np.intp)
        place[needed] = np.arange(len(needed))
        q, v, a = (x[needed] for x in self.state)
        subtracted = np.where(less >= 0, place[less], -1)
        return Observation((q, v, a), place[of], subtracted, self.answers[rows], self.scale[rows], self.part[rows])

    def and_(self, other: Observation) -> Observation:
        """The rows of both."""
        shift = len(self.state[0])
        return Observation(
            tuple(np.concatenate(pair) for pair in zip(self.state, other.state, strict=True)),  # type: ignore[arg-type]
            np.concatenate([self.of, other.of + shift]),
            np.concatenate([self.less, np.where(other.less >= 0, other.less + shift, -1)]),
            np.concatenate([self.answers, other.answers]),
            np.concatenate([self.scale, other.scale]),
            np.concatenate([self.part, other.part]),
        )


def of_experiments(trial: JudgedStates, parts: EquationTerms) -> Observation:
    """The experiments: at rest, accelerated from rest, moving; rows state by state."""
    size, n = trial.q.shape
    zero = np.zeros_like(trial.q)
    wrench = float(np.abs(inverse_dynamics(trial.model, trial.q, trial.v, zero).joint_wrenches).max())
    acceleration = parts.acceleration
    q = np.concatenate([trial.q, np.repeat(trial.q, n, axis=0), trial.q])
    v = np.concatenate([zero, np.zeros((size * n, n)), trial.v])
    a = np.concatenate([zero, np.tile(acceleration * np.eye(n), (size, 1)), zero])
    rest, accelerated, moving = np.arange(size), size + np.arange(size * n), size * (n + 1) + np.arange(size)
    places = {
        "gravity": (rest, -1 + 0 * rest),
        "inertia": (accelerated, np.repeat(rest, n)),
        "velocity": (moving, rest),
    }
    known = [part for part in EXPERIMENT_PARTS if getattr(parts, part) is not None]
    answers = {part: getattr(parts, part).reshape(-1, n) for part in known}
    if "inertia" in answers:
        answers["inertia"] = acceleration * answers["inertia"]
    largest = max(float(np.abs(x).max()) for x in answers.values())
    scale = max(largest, wrench if len(known) > 1 else 0.0) or 1.0
    part = np.concatenate([np.full(len(answers[name]), name) for name in known])
    return Observation(
        (q, v, a),
        np.concatenate([places[name][0] for name in known]),
        np.concatenate([places[name][1] for name in known]),
        np.concatenate([answers[name] for name in known]) / scale,
        np.full((len(part), 1), scale),
        part,
    )


def of_judged(name: str, answer: Array, states: JudgedStates) -> Observation | None:
    """The answers of a function at the judged states; None where no torques follow from them.

    Accelerations are read backwards, as states with the given torques.
    """
    n, zero = states.model.n_bodies, np.zeros_like(states.q)
    rows = np.arange(len(zero))
    if name in ("mass_matrix", "mass_matrix_inverse"):
        mass = answer if name == "mass_matrix" else np.linalg.inv(answer)
        none = np.zeros((len(zero) * (n + 1), n))
        a = np.concatenate([zero, np.tile(np.eye(n), (len(zero), 1))])
        state = np.concatenate([states.q, np.repeat(states.q, n, axis=0)]), none, a
        columns = np.swapaxes(mass, -1, -2).reshape(-1, n)
        scale = np.repeat(np.abs(mass).max(axis=(1, 2)), n)[:, None]
        return _judged(state, len(zero) + np.arange(len(zero) * n), np.repeat(rows, n), columns, scale)
    loads = 0 * zero
    if states.loads is not None:
        loads = (
            inverse_dynamics(states.model, states.q, states.v, states.a).tau
            - states.answer("inverse_dynamics", loaded=True).tau
        )
    known: Mapping[str, Callable[[], tuple[State, Array]]] = {
        "inverse_dynamics": lambda: ((states.q, states.v, states.a), answer + loads),
        "forward_dynamics": lambda: ((states.q, states.v, answer), states.tau + loads),
        "joint_torque_regressor": lambda: ((states.q, states.v, states.a), answer @ states.model.inertial_parameters),
        "bias_torque": lambda: ((states.q, states.v, zero), answer),
        "gravity_torque": lambda: ((states.q, zero, zero), answer),
    }
    if name not in known:
        return None
    state, torque = known[name]()
    wrenches = inverse_dynamics(states.model, *state).joint_wrenches
    scale = np.maximum(np.abs(wrenches).max(axis=(1, 2)), np.abs(torque).max(axis=1))[:, None]
    return _judged(state, rows, -1 + 0 * rows, torque, scale)


def _judged(state: State, of: NDArray[np.intp], less: NDArray[np.intp], torque: Array, scale: Array) -> Observation:
    scale = np.where(scale > 0, scale, 1.0)
    return Observation(state, of, less, torque / scale, scale, np.full(len(of), "judged"))


def observe(tested: FunctionUnderTest, trial: JudgedStates, torque: Array) -> EquationTerms | None:
    """The experiments with a function under test; None where its answers are no part of the equations of motion.

    torque: usual size per joint (n,), for forward dynamics, which gives M⁻¹ and from it the same terms
    Raises numpy.linalg.LinAlgError where forward dynamics give a singular M⁻¹.
    """
    acceleration = usual_acceleration(trial)
    shown = tested.known.shows
    if shown == "accelerations":
        return _of_accelerations(tested, trial, torque, acceleration)
    if shown == "torques per parameter":
        return split(lambda q, v, a: tested(q, v, a) @ trial.model.inertial_parameters, trial, acceleration)
    if shown == "torques":
        return split(tested, trial, acceleration)
    return _PARTS[shown](tested, trial) if shown else None


def _of_accelerations(
    tested: FunctionUnderTest, trial: JudgedStates, torque: Array, acceleration: float
) -> EquationTerms:
    response = split(lambda q, v, a: tested(q, v, a * torque), trial, 1.0)  # a (q, v, τ), one torque at a time
    assert response.inertia is not None
    mass = np.linalg.inv(np.swapaxes(response.inertia, -1, -2) / torque)
    others = (getattr(response, part) for part in ("gravity", "velocity", "doubled"))
    gravity, velocity, doubled = (-np.einsum("kij,kj->ki", mass, a) for a in others)
    return EquationTerms(gravity, np.swapaxes(mass, -1, -2), velocity, doubled, acceleration)


def _of_bias(tested: FunctionUnderTest, trial: JudgedStates) -> EquationTerms:
    q, v = (np.concatenate(x) for x in ([trial.q] * 3, [0 * trial.v, trial.v, 2 * trial.v]))
    rest, moving, fast = np.split(tested(q, v), 3)
    return EquationTerms(gravity=rest, velocity=moving - rest, doubled=fast - rest)


def _of_coriolis(tested: FunctionUnderTest, trial: JudgedStates) -> EquationTerms:
    q, v = np.concatenate([trial.q, trial.q]), np.concatenate([trial.v, 2 * trial.v])
    once, twice = np.split(np.einsum("kij,kj->ki", tested(q, v), v), 2)
    return EquationTerms(velocity=once, doubled=twice)


def _of_quadratic_form(tested: FunctionUnderTest, trial: JudgedStates) -> EquationTerms:
    """M_ij = T(e_i + e_j) - T(e_i) - T(e_j)."""
    size, n = trial.q.shape
    unit = np.eye(n)
    pairs = (unit[:, None] + unit[None, :]).reshape(-1, n)
    sums = tested(np.repeat(trial.q, n * n, axis=0), np.tile(pairs, (size, 1))).reshape(size, n, n)
    singles = np.einsum("kii->ki", sums) / 4  # T(2 e_i) = 4 T(e_i)
    return EquationTerms(inertia=sums - singles[:, :, None] - singles[:, None, :])


_PARTS: Mapping[str, Callable[[FunctionUnderTest, JudgedStates], EquationTerms]] = {
    "inertia": lambda tested, trial: EquationTerms(inertia=np.swapaxes(tested(trial.q), -1, -2)),
    "inverse of the inertia": lambda tested, trial: EquationTerms(
        inertia=np.swapaxes(np.linalg.inv(tested(trial.q)), -1, -2)
    ),
    "gravity": lambda tested, trial: EquationTerms(gravity=tested(trial.q)),
    "gravity and velocity terms": _of_bias,
    "velocity terms as a matrix": _of_coriolis,
    "inertia as a quadratic form": _of_quadratic_form,
}
"""Observations by what a function shows of the equations of motion (crosscheck.quantities.quantity.Shown)."""
