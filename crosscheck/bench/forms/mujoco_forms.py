"""MuJoCo in the benchmark, where it is installed and can represent the robot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.bench.contender import AMORTIZED_SAMPLES, Contender
from crosscheck.bench.states import States
from crosscheck.reference.mujoco_model import MujocoModel

MUJOCO_LOOP, MUJOCO_ROLLOUT = "mujoco loop", "mujoco rollout"


def inverse(states: States, native: MujocoModel) -> list[Contender]:
    out = np.empty(states.q.shape)
    return [
        Contender(
            MUJOCO_LOOP,
            1,
            lambda count: native.inverse_loop(states.q[:count], states.v[:count], states.a[:count], out[:count]),
            states.torque_errors,
            "a Python loop of mj_inverse, arguments copied to MjData and results from there",
        )
    ]


def forward(states: States, native: MujocoModel, threads: Sequence[int]) -> list[Contender]:
    return [
        Contender(
            MUJOCO_ROLLOUT,
            used,
            native.rollout(states.q, states.v, states.tau, used),
            states.acceleration_errors,
            "one step of mujoco.rollout per state: forward dynamics and the integration of the state",
            least=AMORTIZED_SAMPLES,
        )
        for used in threads
    ]
