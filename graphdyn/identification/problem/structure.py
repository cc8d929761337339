"""Parameters of a torque model that some motion could determine: its base parameters over random states."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.base_parameters import BaseParameters, base_parameters
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.verbs.assembly import assemble

STATES_PER_PARAMETER = 4
"""Random states per parameter: each gives n equations, far more than there are unknowns."""

MAX_RANDOM_ACCELERATION = 10.0
"""Largest random acceleration [rad/s² or m/s²]: inertia is then visible against gravity."""

MAX_RANDOM_SPEED = 10.0
"""Largest random speed [rad/s or m/s]: beyond it centrifugal torques would dominate all others."""

MIN_STEP, MAX_STEP = 1e-6, 0.1
"""Steps between random states of friction with memory [rad or m]: with only long steps all elements slip alike."""


@dataclass(frozen=True, eq=False)
class ParameterStructure:
    """Base parameters of a torque model, and the joints on which they act.

    base: over random states
    support: (n, b): whether column base.independent[k] can differ from zero in the torque of joint j
    """

    base: BaseParameters
    support: NDArray[np.bool_]


@functools.lru_cache(maxsize=8)
def structure(torque_model: TorqueModel, seed: int = 0) -> ParameterStructure:
    """Structure of a torque model. The same model and seed give the same result; the last few are cached."""
    samples = random_samples(torque_model, STATES_PER_PARAMETER * len(torque_model.columns), seed)
    w = torque_model.rows(samples)
    base = base_parameters(w.reshape(-1, w.shape[-1]))
    support = np.any(w[..., base.independent] != 0, axis=0)
    return ParameterStructure(base, support)


def random_samples(torque_model: TorqueModel, size: int, seed: int) -> Samples:
    """Random states within the limits of the robot, torques zero; times and temperatures random too.

    For friction with memory every second state is a random step away from the previous one.
    """
    rng = np.random.default_rng(seed)
    q, v = torque_model.model.random_state(rng, size)
    v = np.clip(v, -MAX_RANDOM_SPEED, MAX_RANDOM_SPEED)
    a = rng.uniform(-MAX_RANDOM_ACCELERATION, MAX_RANDOM_ACCELERATION, q.shape)
    if torque_model.has_memory:
        sizes = np.exp(rng.uniform(np.log(MIN_STEP), np.log(MAX_STEP), q[1::2].shape))
        q[1::2] = q[: 2 * len(sizes) : 2] + sizes * rng.choice([-1.0, 1.0], sizes.shape)
    if torque_model.model.chords:
        q, v, a = assemble(torque_model.model, q, v, a)
    time, temperature = rng.normal(size=size), rng.normal(size=q.shape)
    return Samples(q, v, a, np.zeros_like(q), time=time, temperature=temperature)
