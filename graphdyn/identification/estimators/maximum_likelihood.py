"""Maximum likelihood with noise on the torques and on q, v and a.

    minimize Σ_t (τ_t - W(μ_t) x)ᵀ Σ⁻¹ (τ_t - W(μ_t) x) + (m_t - μ_t)ᵀ C⁻¹ (m_t - μ_t)    over x and every μ_t

m = (q, v, a) is the measured motion, μ the true one, Σ the variances of the torques. C is known: the noise of the
positions, after low-pass and differences, is the common noise of q, v and a. Each step linearizes at the current
estimate of μ, with G = ∂τ/∂m there:

    e = τ - W(μ) x - G (m - μ),     S = Σ + G C Gᵀ
    dx = argmin Σ_t (e - W(μ) dx)ᵀ S⁻¹ (e - W(μ) dx),     μ ← m + C Gᵀ S⁻¹ e

The weight of a row includes the torque error that the errors of its motion cause. W is that of the estimated motion:
with W(m), however weighted, the noise of W would stay in the residual, and the bias with it. Without errors of the
motion this is WLS.

After a parallel filter C is that of the filtered errors, and W(μ) - W(m) is added to the filtered W(m): G counts as
constant over the memory of the filter. Rows count as independent; block deviations allow for their correlation.

The steps of the slopes G = ∂τ/∂(q, v, a) are the standard deviations of the errors of q, v and a, so that sign(v) has
a slope where the error may reverse it, and none elsewhere.

Olsen, Swevers and Verdonck, "Maximum likelihood identification of a dynamic robot model: implementation issues", Int.
J. of Robotics Research 21(2), 2002; the iteration: Britt and Luecke, Technometrics 15(2), 1973.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.display import short_repr
from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import (
    CompressedEquations,
    merged,
    residual_deviations,
    solve,
    weighted_solution,
)
from graphdyn.identification.data.rows import ROW_ARRAYS, Rows, runs
from graphdyn.identification.data.samples import Samples, joined_samples
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem, pieces_of
from graphdyn.identification.problem.slopes import torque_slopes
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.identification.terms.friction import positive
from graphdyn.layout import Array

MEASURED_ROWS_AT_ONCE = 4096
"""Rows that are computed at once: enough for compiled code to pay off."""

NO_ERRORS = (
    "needs the errors of q, v and a (motion_covariance of the samples), which crosscheck.identify estimates from "
    "recorded positions"
)


@dataclass(frozen=True, eq=False)
class MeasuredRows:
    """Consecutive rows of one run.

    rows: their equations; blocks: the time block of each   (N,)
    motion: their q, v, a
    covariance: of the errors of all q, then v, then a      (3 n, 3 n)
    """

    rows: Rows
    blocks: NDArray[np.int64]
    motion: Samples
    covariance: Array


def measured_motion(problem: Problem) -> Iterator[MeasuredRows]:
    """All equations, window by window.

    Raises EstimationFailed if the errors are not known, for a moving base, and for friction with memory.
    """
    if problem.torque_model.has_memory:
        raise EstimationFailed("knows the errors of a row at a time, and friction with memory takes all rows together")
    motion, covariances, run, position = *_motion(problem), 0
    for parts in _windows(problem.rows()):
        arrays: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ROW_ARRAYS}
        rows = Rows(**arrays)
        blocks = np.concatenate([np.full(len(part), part.block) for part in parts])
        end = position + len(rows)
        yield MeasuredRows(rows, blocks, motion[position:end], covariances[run[position]])
        position = end


def _windows(chunks: Iterable[Rows]) -> Iterator[list[Rows]]:
    """Neighboring chunks of one run, joined up to MEASURED_ROWS_AT_ONCE rows."""
    parts: list[Rows] = []
    for chunk in chunks:
        if parts and (chunk.first or sum(map(len, parts)) >= MEASURED_ROWS_AT_ONCE):
            yield parts
            parts = []
        parts.append(chunk)
    yield parts


def joined(covariance: Array) -> Array:
    """Covariance of all q, then v, then a (3 n, 3 n) from that of q, v, a of each joint (n, 3, 3)."""
    n = len(covariance)
    return np.asarray(np.einsum("jab,jk->ajbk", covariance, np.eye(n))).reshape(3 * n, 3 * n)


def _motion(problem: Problem) -> tuple[Samples, list[Array], NDArray[np.int64]]:
    """The rows that count; the covariance of the errors of every run; the run of each row."""
    parts, covariances, lengths = list[Samples](), list[Array](), list[int]()
    for run in runs(pieces_of(problem.data)):
        pieces = list(run.samples)
        if any(piece.base is not None for piece in pieces):
            raise EstimationFailed("the base of the recording moves; errors of the motion know a base at rest only")
        if pieces[0].motion_covariance is None:
            raise EstimationFailed(NO_ERRORS)
        covariances.append(joined(pieces[0].motion_covariance))
        left = joined_samples(pieces, slice(None, None, 1 if run.row_filter is None else run.row_filter.factor))
        parts.append(left)
        lengths.append(len(left))
    of_run = np.repeat(np.arange(len(lengths)), lengths)
    return joined_samples(parts, problem.chosen(np.arange(len(of_run)))), covariances, problem.chosen(of_run)


@dataclass(frozen=True, eq=False)
class Whitened:
    """N rows multiplied by L⁻¹, with S = L Lᵀ the covariance of their residual.

    matrix, right: W(μ) and e                               (N, n, r), (N, n)
    shift: μ - m, the estimated minus the measured motion   (N, 3 n)
    squares: Σ e² over the rows; explained: Σ of the variances G C Gᵀ   (n,)
    """

    matrix: Array
    right: Array
    shift: Array
    squares: Array
    explained: Array


def whitened(problem: Problem, x: Array, part: MeasuredRows, shift: Array, noise: Array) -> Whitened:
    """Whitened rows at base parameters x (r,) and the current estimate of the motion; noise: of the torques (n,)."""
    torque_model, columns = problem.torque_model, problem.base.independent
    measured, kept = part.motion, part.rows.kept[..., None]
    q, v, a = np.split(shift, 3, axis=1)
    estimated = replace(measured, q=measured.q + q, v=measured.v + v, a=measured.a + a)
    steps = np.sqrt(np.diag(part.covariance)).reshape(3, -1)
    standard = model_prior(torque_model).nearest(problem.base, x)
    slopes = torque_slopes(torque_model, standard, estimated, steps) * kept
    # the measured equations are filtered: the difference that the estimated motion makes is added to them
    change = torque_model.rows(estimated, columns) - torque_model.rows(measured, columns)
    known = torque_model.known_torque(estimated) - torque_model.known_torque(measured)
    matrix = (problem.reduced(part.rows) + change) * kept
    # τ - W(μ) x + G (μ - m): the residual at the measured motion, to first order
    e = (part.rows.right - known)[..., None] * kept - matrix @ x[:, None] + slopes @ shift[..., None]
    # S = G C Gᵀ + noise²; the motion that fits best is m + C Gᵀ S⁻¹ e
    gain = part.covariance @ np.swapaxes(slopes, 1, 2)
    propagated = slopes @ gain
    covariance = propagated + np.diag(noise**2)
    factor = np.linalg.cholesky(covariance)
    white = np.linalg.solve(factor, np.concatenate([matrix, e], axis=-1))
    shift = (gain @ np.linalg.solve(covariance, e))[..., 0]
    explained = np.einsum("tjj->j", propagated)
    return Whitened(white[..., :-1], white[..., -1], shift, np.sum(e[..., 0] ** 2, axis=0), explained)


CONVERGENCE_SHARE = 0.01
"""Step of a base parameter, in its standard deviations, below which it counts as converged."""

MAX_LIKELIHOOD_ITERATIONS = 50
"""Iterations after which an estimate that still moves has diverged."""

MIN_NOISE_SHARE = 0.1
"""Smallest noise of a torque, relative to its residual, if errors of the motion explain all: C is not exact."""

LARGEST_SHARE_SETTING = "residual by errors of the motion"
"""Name of the setting with Σ G C Gᵀ over Σ e² of the joint with the largest ratio."""


@dataclass(frozen=True, eq=False)
@short_repr
class MaximumLikelihood:
    """Maximum likelihood with noisy positions.

    torque_noise: Σ^½ of the filtered torques, one for all or (n,); if left out, the part of each joint's residual that
        the errors of the motion do not explain   [N m or N]
    most: iterations after which an estimate that still moves counts as diverged
    """

    torque_noise: ArrayLike | None = None
    most: int = MAX_LIKELIHOOD_ITERATIONS
    name: str = "ML"
    reference: str = "Olsen, Swevers and Verdonck, Int. J. of Robotics Research 21(2), 2002"
    assumptions: str = "noise of known size on the positions, white noise on the torques, independent of each other"
    needs: str = "as WLS; the noise of the positions, and how v and a come from them"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem.

        Raises EstimationFailed if the errors of the motion are not known, or the iteration diverges; InvalidInput for a
        torque_noise that is not positive.
        """
        start, noise = weighted_solution(problem.equations)
        x, noise = start.x, self._torque_noise(noise)
        shifts = [np.zeros((len(part.rows), 3 * problem.n_joints)) for part in measured_motion(problem)]
        ones, moved = np.ones(problem.n_joints), np.inf
        for iteration in range(1, self.most + 1):
            blocks, squares, explained = _linearized(problem, x, shifts, noise)
            step = solve(merged(blocks), ones)
            x = x + step.x
            moved = float(np.abs(step.x / np.sqrt(np.diag(step.inverse))).max(initial=0.0))
            if moved < CONVERGENCE_SHARE and iteration > 1:  # the first step knows of no error of the motion
                return base_estimate(
                    problem,
                    x,
                    step.inverse,
                    noise,
                    block_covariance=jackknife_covariance(blocks, step.x, ones),
                    iterations=iteration,
                    settings={
                        LARGEST_SHARE_SETTING: float(np.max(explained / np.maximum(squares, np.finfo(float).tiny)))
                    },
                )
            left = np.maximum(squares - explained, MIN_NOISE_SHARE**2 * squares)
            used = np.full(problem.n_joints, problem.base.rank / problem.n_joints)
            noise = self._torque_noise(residual_deviations(problem.equations, left, used))
        raise EstimationFailed(
            f"diverged: after {self.most} iterations the estimate still moves by {moved:.2g} standard deviations; "
            "lower the cutoff, leave slow rows out (min_speed)"
        )

    def _torque_noise(self, left: Array) -> Array:
        return left if self.torque_noise is None else positive("torque_noise", self.torque_noise, len(left))


def _linearized(
    problem: Problem, x: Array, shifts: list[Array], noise: Array
) -> tuple[list[CompressedEquations], Array, Array]:
    """Equations of a step, block by block, with Σ e² and Σ G C Gᵀ of every joint (n,); it updates `shifts`."""
    blocks: dict[int, Accumulator] = defaultdict(lambda: Accumulator(problem.base.rank, problem.n_joints))
    squares, explained = np.zeros((2, problem.n_joints))
    for number, part in enumerate(measured_motion(problem)):
        rows = whitened(problem, x, part, shifts[number], noise)
        shifts[number] = rows.shift
        for block in np.unique(part.blocks):
            here = part.blocks == block
            blocks[block].add(rows.matrix[here], rows.right[here], kept=part.rows.kept[here])
        squares += rows.squares
        explained += rows.explained
    return [accumulator.compressed for _, accumulator in sorted(blocks.items())], squares, explained
