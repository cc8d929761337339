"""Equations of a recording beside the simulated loop: those of instrumental variables, and those of the output error.

Every row of the measured equations is taken with the simulated regressor and torque. Instrumental variables sum up
Z_gᵀ W_g x = Z_gᵀ τ_g of every joint g and time block:

    x = A⁻¹ Σ_g Z_gᵀ τ_g / σ_g²,   A = Σ_g Z_gᵀ W_g / σ_g²,   cov x = A⁻¹ (Σ_g Z_gᵀ Z_g / σ_g²) A⁻ᵀ

The products square the condition number, so columns are scaled to unit length before the solution.

One Gauss-Newton step of the output error takes the torques of the simulated loop, linearized:

    S_g dx ≈ τ_g - τ_g(x)     for every joint g, S_g = dτ_g/dx or its approximation
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import (
    EPS,
    leverages,
    merged,
    residual_deviations,
    solve,
)
from graphdyn.identification.data.rows import Rows
from graphdyn.identification.data.samples import Samples, TorqueFreeSamples, joined_samples
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance, left_out_covariance
from graphdyn.layout import Array

SIMULATED_ROWS_AT_ONCE = 4096
"""Rows whose simulated regressor is computed at once: enough for compiled code to pay off."""


@dataclass(frozen=True, eq=False)
class RowBlock:
    """Some rows of a recording.

    measured: its equations, filtered; matrix: their W in base parameters of the problem   (N, n, r)
    regressor: W of the simulated motion, in the same        (N, n, r)
    output: torque of the simulated motion, filtered like the measured one   (N, n)  [N m or N]

    The simulated regressor has no noise, and needs no filter: what a low-pass would remove from it has no counterpart
        in
    the filtered equations by which it is multiplied.
    """

    measured: Rows
    matrix: Array
    regressor: Array
    output: Array


def beside(problem: Problem, simulated: list[Samples]) -> Iterator[RowBlock]:
    """All equations of a problem, chunk by chunk, with the simulated stretches."""
    motion = _decimated(problem, simulated)
    position, first, window = 0, 0, np.empty((0, problem.n_joints, problem.base.rank))
    for rows in problem.rows():
        end = position + len(rows)
        if end > first + len(window):
            first = position
            ahead = TorqueFreeSamples(motion[first : max(end, first + SIMULATED_ROWS_AT_ONCE)])
            window = problem.torque_model.rows(ahead, problem.base.independent)
        yield RowBlock(rows, problem.reduced(rows), window[position - first : end - first], motion.tau[position:end])
        position = end


def _decimated(problem: Problem, stretches: list[Samples]) -> Samples:
    """The rows that count, in order: torques after the filter; of the other arrays, the rows that the filter keeps."""
    parts: list[Samples] = []
    for samples in stretches:
        left = samples[:: 1 if samples.row_filter is None else samples.row_filter.factor]
        tau = samples.tau if samples.row_filter is None else samples.row_filter(samples.tau)
        parts.append(replace(left, tau=tau))
    return joined_samples(parts, problem.chosen(np.arange(sum(map(len, parts)))))


@dataclass(frozen=True, eq=False)
class LoopSolution:
    """Solution x (r,), its covariance (r, r) for white noise, and the covariance that allows for correlation in time.

    The last needs two time blocks, and is None otherwise.
    noise: of the torques or outputs                        (n,)
    """

    x: Array
    covariance: Array
    block_covariance: Array | None
    noise: Array


@dataclass(frozen=True, eq=False)
class CrossedEquations:
    """Sums of the instrumental-variable equations.

    products: Z_gᵀ [W_g | τ_g] of every time block         (B, n, r, r + 1)
    instruments: Z_gᵀ Z_g                                   (n, r, r)
    """

    products: Array
    instruments: Array

    @classmethod
    def of(cls, parts: Iterable[RowBlock], support: NDArray[np.bool_]) -> CrossedEquations:
        """Sum up these rows. support: where W can differ from zero (n, r)."""
        n, r = support.shape
        blocks: dict[int, Array] = defaultdict(lambda: np.zeros((n, r, r + 1)))
        squares = np.zeros((n, r, r))
        columns = [np.flatnonzero(row) for row in support]
        for part in parts:
            block = blocks[part.measured.block]
            for g, own in enumerate(columns):
                kept = part.measured.kept[:, g]
                z, w = part.regressor[kept, g][:, own], part.matrix[kept, g][:, own]
                block[g][np.ix_(own, np.append(own, r))] += z.T @ np.column_stack([w, part.measured.right[kept, g]])
                squares[g][np.ix_(own, own)] += z.T @ z
        return cls(np.array([block for _, block in sorted(blocks.items())]), squares)

    def solve(self, noise: Array) -> LoopSolution:
        """Solve with the noise σ_g (n,). Raises EstimationFailed if the instruments do not determine the parameters."""
        weights = 1 / noise[:, None, None] ** 2
        blocks = np.sum(self.products * weights, axis=1)
        together = blocks.sum(axis=0)
        squares = np.sum(self.instruments * weights, axis=0)
        scale = np.sqrt(np.diag(squares))
        if not np.all(scale > 0):
            raise EstimationFailed(f"the simulated motion does not excite base parameter {int(np.argmin(scale)) + 1}")
        a = together[:, :-1] / scale / scale[:, None]
        u, s, v_t = np.linalg.svd(a)
        if s.size and s[-1] <= len(s) * EPS * s[0]:
            raise EstimationFailed("the instruments do not determine the parameters: the simulated motion is another")
        inverse = (v_t.T / s) @ u.T / scale / scale[:, None]
        x = inverse @ together[:, -1]
        scores = blocks[:, :, -1] - blocks[:, :, :-1] @ x
        over_blocks = left_out_covariance(blocks[:, :, :-1], scores, scale)
        return LoopSolution(x, inverse @ squares @ inverse.T, over_blocks, noise)


def output_step(problem: Problem, x: Array, parts: Iterable[RowBlock], noise: Array | None) -> LoopSolution:
    """One step from base parameters x (r,).

    parts: with S as their regressor, and τ(x) as their output; noise: as given, None if it is to be estimated (n,)
    """
    blocks: dict[int, Accumulator] = defaultdict(lambda: Accumulator(problem.base.rank, problem.n_joints))
    for part in parts:
        left = part.measured.measured - part.output
        blocks[part.measured.block].add(part.regressor, left, kept=part.measured.kept)
    equations = tuple(accumulator.compressed for _, accumulator in sorted(blocks.items()))
    together = replace(merged(equations), noise=noise)
    even = np.full(problem.n_joints, problem.base.rank / problem.n_joints)
    start = np.sqrt(together.measured_squares / np.maximum(together.counts, 1)) + np.finfo(float).tiny
    noise = residual_deviations(together, together.residual_squares(solve(together, start).x), even)
    solution = solve(together, noise)
    noise = residual_deviations(
        together, together.residual_squares(solution.x), leverages(together, noise, solution.inverse)
    )
    return LoopSolution(x + solution.x, solution.inverse, jackknife_covariance(equations, solution.x, noise), noise)
