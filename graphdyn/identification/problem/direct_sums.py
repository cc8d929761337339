"""Gram matrices of a torque model, computed directly from the motion without storing equations.

The rigid bodies come from compiler.gram, which multiplies the columns of the regressor as it computes them. The
columns of the other terms are passed to it, joint by joint.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import refuse_non_finite
from graphdyn.compiler.gram.gram import torque_gram
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.structure import ParameterStructure
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import Array


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
