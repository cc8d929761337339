"""Rank and null spaces of the rows that chords add, pose by pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn._linear import apply
from graphdyn._loops import RANK
from graphdyn.layout import Array

PREFERRED = 0.05
"""A preferred column becomes dependent only where all others are shorter than this part of the longest of J."""


@dataclass(frozen=True, eq=False)
class LoopSpaces:
    """J = U Σ Vᵀ with singular values below RANK taken as zero.

    left: U (…, m, m); right: V (…, n, n)
    inverse: 1/σ, and 0 where σ counts as zero              (…, min(m, n))
    """

    left: Array
    right: Array
    inverse: Array

    @property
    def rank(self) -> NDArray[np.intp]:
        return np.asarray(np.count_nonzero(self.inverse, axis=-1))

    @property
    def distance(self) -> Array:
        """From a singular pose (…): smallest by largest of the singular values that count; 1 where none does."""
        largest = self.inverse.max(axis=-1, initial=0.0)
        least = np.where(self.inverse > 0, self.inverse, np.inf).min(axis=-1, initial=np.inf)
        return np.where(largest > 0, least / np.where(largest > 0, largest, 1.0), 1.0)

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which columns of V are motions that keep the loops closed (…, n)."""
        return _padded(self.inverse == 0, self.right.shape[-1])

    @property
    def redundant(self) -> NDArray[np.bool_]:
        """Which columns of U are combinations of rows that hold nothing (…, m)."""
        return _padded(self.inverse == 0, self.left.shape[-1])

    @property
    def inverse_matrix(self) -> Array:
        """The pseudoinverse of J (…, n, m)."""
        k = self.inverse.shape[-1]
        matrix: Array = (self.right[..., :k] * self.inverse[..., None, :]) @ _transposed(self.left[..., :k])
        return matrix

    def least_motion(self, rows: Array) -> Array:
        """The smallest x (…, n) with J x = rows (…, m), where there is one; else the nearest."""
        k = self.inverse.shape[-1]
        return apply(self.right[..., :k], self.inverse * apply(_transposed(self.left[..., :k]), rows))

    def least_multipliers(self, torques: Array) -> Array:
        """The smallest λ (…, m) with Jᵀ λ = torques (…, n), where there is one; else the nearest."""
        k = self.inverse.shape[-1]
        return apply(self.left[..., :k], self.inverse * apply(_transposed(self.right[..., :k]), torques))


def loop_spaces(jacobian: Array) -> LoopSpaces:
    """Of J (…, m, n)."""
    left, values, right = np.linalg.svd(jacobian)
    kept = values > RANK * values.max(axis=-1, keepdims=True, initial=0.0)
    return LoopSpaces(left, _transposed(right), np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0))


def pivoted_columns(matrix: Array, count: int, last: Sequence[int] = ()) -> list[int]:
    """Independent columns: each the longest once what the chosen ones span is taken away.

    Golub and Van Loan, Matrix Computations, section 5.4 (QR with column pivoting).
    last: columns that are chosen only where all others are short (PREFERRED)
    """
    rest, chosen = matrix.copy(), list[int]()
    for _ in range(count):
        length = np.linalg.norm(rest, axis=0)
        length[chosen] = 0.0
        others = np.delete(length, last)
        if others.size and others.max() > PREFERRED * np.linalg.norm(matrix, axis=0).max():
            length[list(last)] = 0.0
        longest = int(length.argmax())
        direction = rest[:, longest] / np.linalg.norm(rest[:, longest])
        rest = rest - np.outer(direction, direction @ rest)
        chosen.append(longest)
    return chosen


def _padded(flags: NDArray[np.bool_], size: int) -> NDArray[np.bool_]:
    return np.concatenate([flags, np.ones((*flags.shape[:-1], size - flags.shape[-1]), dtype=bool)], axis=-1)


def _transposed(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
