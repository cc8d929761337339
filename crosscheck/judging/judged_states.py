"""The states at which foreign functions are evaluated."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.experiments import TrialStates
from crosscheck.referee.states import ACCELERATION_RANGE
from graphdyn import RobotModel
from graphdyn.layout import Array

EXPERIMENTS = 6
"""Number of states of the experiments; half of them with whole turns added to joints that can turn without end."""

TURNED = 10
"""Number of judged states with whole turns added, besides the random ones."""

TURNS = 2
"""Largest number of whole turns added, in either direction."""


class JudgedStates:
    """The judged states: q, v, a, tau (N, n)."""

    def __init__(self, model: RobotModel, q: Array, v: Array, a: Array, tau: Array, turn: Array):
        self.model, self.q, self.v, self.a, self.tau, self.turn = model, q, v, a, tau, turn

    @classmethod
    def draw(cls, model: RobotModel, samples: int, seed: int, *, needs_tau: bool) -> JudgedStates:
        """Random states, some with whole turns added, and the pose within the limits that is nearest to zero."""
        rng = np.random.default_rng(seed)
        q, v = model.random_state(rng, samples + TURNED + 1)
        endless = np.array([_turns_without_end(joint) for joint in model.joints])
        turn = 2 * np.pi * endless * rng.integers(-TURNS, TURNS + 1, q.shape)
        turn[:samples] = 0
        q = q + turn
        q[-1] = [_nearest_to_zero(joint) for joint in model.joints]
        a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
        tau = graphdyn.inverse_dynamics(model, q, v, a).tau * rng.uniform(0.5, 1.5, q.shape) if needs_tau else 0 * a
        return cls(model, q, v, a, tau, turn)

    @property
    def trial(self) -> TrialStates:
        """States for the experiments: random ones, then ones with whole turns added."""
        rows = [*range(EXPERIMENTS // 2), *range(-TURNED, -TURNED + EXPERIMENTS // 2)]
        rows = [row if row < 0 else row % len(self.q) for row in rows]
        return TrialStates(self.q[rows], self.v[rows])

    def arguments(self, name: str) -> tuple[Array, ...]:
        """The arguments of the function of this name."""
        return {
            "inverse_dynamics": (self.q, self.v, self.a),
            "forward_dynamics": (self.q, self.v, self.tau),
            "mass_matrix": (self.q,),
            "regressor": (self.q, self.v, self.a),
        }[name]


def _turns_without_end(joint: graphdyn.Joint) -> bool:
    limits = joint.limits
    return joint.kind == "continuous" or (joint.kind == "revolute" and limits.lower is None and limits.upper is None)


def _nearest_to_zero(joint: graphdyn.Joint) -> float:
    lower, upper = joint.limits.lower or 0.0, joint.limits.upper or 0.0
    return 0.0 if joint.kind == "continuous" else max(lower, 0.0) + min(upper, 0.0)
