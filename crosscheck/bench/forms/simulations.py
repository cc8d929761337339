"""Steps of simulations: Runge-Kutta of order 4, from the same states, without torque."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crosscheck.bench.contender import Contender
from crosscheck.bench.states import SINGLE_STATE_SAMPLES, States
from crosscheck.reference.mujoco_model import MujocoModel
from graphdyn import rollout
from graphdyn.compiler import chosen_backend
from graphdyn.layout import Array

SIMULATION_NAME, SIMULATION_TITLE = "simulation", "simulated steps, Runge-Kutta of order 4"
N_STEPS, STEP_WIDTH = 100, 1e-3
"""Steps of each motion, fewer if there are fewer samples, and their width [s]. A sample is one step."""

ERROR_SCALE = "largest position and velocity of the motion"
ERROR_BOUND = 1e-11
"""Accelerations agree to rounding times the condition number of M, up to 1e4 in an arm, and a light wrist that turns
fast spreads the difference from step to step. Measured 2e-15 over a hundred steps of two arms."""

GRAPHDYN_ROLLOUT, MUJOCO_STEPS, PINOCCHIO_STEPS = "graphdyn rollout", "mujoco loop", "pinocchio loop"


def contenders(states: States, native: MujocoModel | None) -> list[Contender]:
    """None of the model: MuJoCo takes no part."""
    q, v, steps = states.q, states.v, _steps(states)

    def ours(count: int) -> Array:
        rows = slice(count // steps)
        found = rollout(
            states.model, q[rows], v[rows], step=STEP_WIDTH, duration=steps * STEP_WIDTH, every=steps, threads=1
        )
        return np.concatenate([found.q[:, -1], found.v[:, -1]], axis=-1)

    theirs = pinocchio_loop(states)

    def errors(answers: Array) -> Array:
        judged = min(SINGLE_STATE_SAMPLES, len(answers))
        reference = theirs(judged * steps)
        size = np.abs(reference).max(axis=-1)
        found: Array = np.abs(answers[:judged] - reference).max(axis=-1) / size
        return found

    name = GRAPHDYN_ROLLOUT if chosen_backend() == "llvm" else f"{GRAPHDYN_ROLLOUT}, NumPy"
    motion = f"{steps} steps of {STEP_WIDTH * 1e3:g} ms from each state"
    found = [
        Contender(name, 1, ours, errors, f"{motion}, all robots at once, memory made", ours=True, least=steps),
        Contender(
            PINOCCHIO_STEPS, 1, theirs, errors, f"{motion}: pin.aba at every stage, the step in NumPy", least=steps
        ),
    ]
    if native is not None:
        loop = native.steps_loop(q, v, steps, STEP_WIDTH)
        found.append(
            Contender(
                MUJOCO_STEPS, 1, lambda count: loop(count // steps), errors,
                f"{motion}: mj_step, one robot after the other", least=steps,
            )
        )  # fmt: skip
    return found


def pinocchio_loop(states: States) -> Callable[[int], Array]:
    """run(count): q and v at the ends of the motions (…, 2 n)."""
    aba, model, data = states.bare.aba, states.bare.model, states.bare.data
    n, steps = states.q.shape[-1], _steps(states)
    nothing, out = np.zeros(n), np.empty((len(states), 2 * n))

    def rates(y: Array) -> Array:
        return np.concatenate([y[n:], aba(model, data, y[:n], y[n:], nothing)])

    def run(count: int) -> Array:
        for k in range(count // steps):
            y = np.concatenate([states.q[k], states.v[k]])
            for _ in range(steps):
                first = rates(y)
                second = rates(y + STEP_WIDTH / 2 * first)
                third = rates(y + STEP_WIDTH / 2 * second)
                y = y + STEP_WIDTH / 6 * (first + 2 * (second + third) + rates(y + STEP_WIDTH * third))
            out[k] = y
        return out[: count // steps]

    return run


def _steps(states: States) -> int:
    return min(N_STEPS, len(states))
