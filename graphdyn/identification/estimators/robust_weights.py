"""Common parts of robust methods: norms, residuals, a scale insensitive to outliers, and weighted equations."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import CompressedEquations
from graphdyn.identification.algebra.solution import EPS
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

NORMAL_MEDIAN = 0.6745
"""Median of |u| for normal noise of unit deviation."""


HUBER_THRESHOLD = 1.345
"""Huber's threshold: 95 % efficient for normal noise."""


@dataclass(frozen=True)
class Norm:
    """A robust norm. influence: ψ(u); slope: ψ'(u)."""

    influence: Callable[[Array], Array]
    slope: Callable[[Array], Array]

    def weight(self, u: Array) -> Array:
        """Weight ψ(u) / u, 1 at u = 0."""
        return np.divide(self.influence(u), u, out=np.ones_like(u), where=u != 0)


def huber(c: float = HUBER_THRESHOLD) -> Norm:
    return Norm(lambda u: np.clip(u, -c, c), lambda u: (np.abs(u) <= c).astype(float))


def tukey(c: float = 4.685) -> Norm:
    def inside(u: Array) -> Array:
        return np.maximum(1.0 - (u / c) ** 2, 0.0)

    return Norm(lambda u: u * inside(u) ** 2, lambda u: inside(u) * (inside(u) - 4.0 * (u / c) ** 2))


def residuals_of(problem: Problem, x: Array) -> Array:
    """Residuals e (N, n), NaN for equations that do not count."""
    parts = (np.where(rows.kept, problem.reduced(rows) @ x - rows.right, np.nan) for rows in problem.rows())
    return np.concatenate(list(parts))


def robust_scale(problem: Problem, residuals: Array, used: Array) -> Array:
    """σ (n,) from the median of |e|, at least the rounding of the torque. used: equations used up by parameters
    (n,).
    """
    counts = problem.equations.counts
    counted = (np.abs(column[np.isfinite(column)]) for column in residuals.T)
    median = np.array([np.median(sizes) for sizes in counted]) / NORMAL_MEDIAN * np.sqrt(counts / (counts - used))
    rounding = EPS * np.sqrt(problem.equations.measured_squares / counts) + np.finfo(float).tiny
    return np.maximum(median, rounding)


def weighted_blocks(
    problem: Problem, weights: Array, right: Callable[[slice, Array, Array], Array] | None = None
) -> tuple[CompressedEquations, ...]:
    """Equations of every time block, each equation multiplied by its weight.

    weights: (N, n); right: (rows, W, τ) → the right-hand sides, τ if left out
    """
    blocks: dict[int, Accumulator] = defaultdict(
        lambda: Accumulator(problem.base.rank, problem.n_joints, support=problem.support)
    )
    position = 0
    for rows in problem.rows():
        here = slice(position, position + len(rows))
        matrix = problem.reduced(rows)
        values = rows.right if right is None else right(here, matrix, rows.right)
        blocks[rows.block].add(matrix, values, kept=rows.kept, weights=weights[here])
        position = here.stop
    return tuple(accumulator.compressed for _, accumulator in sorted(blocks.items()))
