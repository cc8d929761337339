"""Parameters of a torque model that some motion could determine: its base parameters over random states.

Gram matrices of a torque model come directly from the motion, without stored equations: the rigid bodies from
compiler.gram, which multiplies the columns of the regressor as it computes them. The columns of the other terms are
passed to it, joint by joint.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import refuse_non_finite
from graphdyn.compiler.gram.gram import torque_gram
from graphdyn.identification.algebra.base_parameters import BaseParameters, base_parameters
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import Array
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


class DirectSums:
    """[W_j | τ_j]ᵀ [W_j | τ_j] of every joint, in the base parameters of the structure."""

    def __init__(self, torque_model: TorqueModel, structure: ParameterStructure) -> None:
        self._torque_model = torque_model
        self._independent = independent = structure.base.independent
        known_to_kernel = any(type(term) is RigidBodies for term in torque_model.terms)  # another regressor is not
        rigid = (torque_model.slice_of(RigidBodies) if known_to_kernel else None) or slice(0, 0)
        is_rigid = (independent >= rigid.start) & (independent < rigid.stop)
        self._rigid, self._others = np.flatnonzero(is_rigid), np.flatnonzero(~is_rigid)
        self._other_columns = independent[self._others]
        acting = [np.flatnonzero(row[self._others]) for row in structure.support]
        self._acting = acting
        self._n_extra = max(map(len, acting))
        if not torque_model.model.chords:  # which the kernel does not cover
            columns = (independent[self._rigid] - rigid.start).tolist()
            self._gram = torque_gram(torque_model.model, columns, self._n_extra, weighted=True)
        self._width = len(independent) + 1

    def __call__(self, samples: Samples, kept: NDArray[np.bool_]) -> list[Array]:
        """Gram matrices of all joints (b + 1, b + 1), over the equations that count (N, n).

        Raises InvalidInput for NaN, infinity.
        """
        right = np.asarray(samples.tau, dtype=float) - self._torque_model.known_torque(samples)
        if samples.base is not None or self._torque_model.model.chords:
            return self._plain_sums(samples, right, kept)
        others = self._torque_model.rows(samples, self._other_columns)
        extra = np.zeros((*right.shape, self._n_extra))
        for joint, columns in enumerate(self._acting):
            extra[:, joint, : len(columns)] = others[:, joint, columns]
        matrices, seen = self._gram(samples.q, samples.v, samples.a, right, extra, kept.astype(float))
        if np.isnan(seen["finite"]):
            arrays = {name: getattr(samples, name) for name in ("q", "v", "a", "tau")}
            refuse_non_finite(self._torque_model.model, arrays)
        return [self._spread(joint, matrix) for joint, matrix in enumerate(matrices)]

    def _plain_sums(self, samples: Samples, right: Array, kept: NDArray[np.bool_]) -> list[Array]:
        """Gram matrices on a moving base and with loops, which the kernel does not cover."""
        equations = np.concatenate([self._torque_model.rows(samples, self._independent), right[..., None]], axis=-1)
        chosen = [equations[kept[:, joint], joint] for joint in range(right.shape[1])]
        return [rows.T @ rows for rows in chosen]

    def _spread(self, joint: int, matrix: Array) -> Array:
        """Expand the columns that act on a joint to all columns."""
        own = self._acting[joint]
        rigid = self._rigid[self._gram.columns[joint]]
        used = np.concatenate([np.arange(len(rigid) + len(own)), [len(matrix) - 1]])
        places = np.concatenate([rigid, self._others[own], [self._width - 1]])
        spread = np.zeros((self._width, self._width))
        spread[np.ix_(places, places)] = matrix[np.ix_(used, used)]
        return spread
