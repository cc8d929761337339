"""What a function answered, as torques, and how far the torques of codes are from it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.recursion import DynamicsCode, State, torques_of
from crosscheck.judging.states.experiments import EXPERIMENT_PARTS, Parts, TrialStates
from crosscheck.judging.states.judged_states import JudgedStates
from graphdyn import RobotModel, inverse_dynamics
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

    def residuals(self, codes: Sequence[DynamicsCode]) -> Array:
        """How far the torques of K codes are from the answers, relative to the scale (K, T, n)."""
        tau = torques_of(codes, self.state)
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
        return Observation(
            (q, v, a),
            place[of],
            np.where(less >= 0, place[less], -1),
            self.answers[rows],
            self.scale[rows],
            self.part[rows],
        )

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


def of_experiments(model: RobotModel, trial: TrialStates, parts: Parts) -> Observation:
    """The experiments: at rest, accelerated from rest, moving; rows state by state."""
    size, n = trial.q.shape
    zero = np.zeros_like(trial.q)
    wrench = float(np.abs(inverse_dynamics(model, trial.q, trial.v, zero).joint_wrenches).max())
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
        loads = inverse_dynamics(states.model, states.q, states.v, states.a).tau - states.inverse.tau
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
