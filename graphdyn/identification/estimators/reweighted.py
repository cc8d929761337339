"""Iteratively reweighted least squares: large residuals count less (M-estimation).

    x = argmin Σ_g Σ_t ρ(e_gt / σ_g),     weight w(u) = ρ'(u) / u

    Huber   ρ = u²/2 up to |u| = c, linear beyond                c = 1.345: 95 % efficient for normal noise
    Tukey   w = (1 - (u/c)²)² up to |u| = c, 0 beyond            c = 4.685; starts from Huber's estimate

σ_g is the median of |e_g| over 0.6745, renewed in every iteration.
cov x = A⁻¹ B A⁻¹ with A = Σ_g mean(ψ') W_gᵀW_g / σ_g², B = Σ_g κ_g mean(ψ²) W_gᵀW_g / σ_g².
Huber and Ronchetti, Robust Statistics, 2009, sections 6.4 and 7.8; Holland and Welsch, Communications in Statistics
A6, 1977.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import (
    EPS,
    CompressedEquations,
    leverages,
    solve,
    weighted_solution,
)
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
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
    """σ (n,) from the median of |e|, at least rounding. used: equations that the parameters use up (n,)."""
    counts = problem.equations.counts
    counted = (np.abs(column[np.isfinite(column)]) for column in residuals.T)
    median = np.array([np.median(sizes) for sizes in counted]) / NORMAL_MEDIAN * np.sqrt(counts / (counts - used))
    rounding = EPS * np.sqrt(problem.equations.measured_squares / counts) + np.finfo(float).tiny
    return np.maximum(median, rounding)


def weighted_blocks(
    problem: Problem,
    weights: Array,
    right: Callable[[slice, Array, Array], Array] | None = None,
    *,
    together: bool = False,
) -> tuple[CompressedEquations, ...]:
    """Equations of every time block, each equation multiplied by its weight.

    weights: (N, n); right: (rows, W, τ) → the right-hand sides, τ if left out
    together: all time blocks as one
    """
    blocks: dict[int, Accumulator] = defaultdict(
        lambda: Accumulator(problem.base.rank, problem.n_joints, support=problem.support)
    )
    position = 0
    for rows in problem.rows():
        here = slice(position, position + len(rows))
        matrix = problem.reduced(rows)
        values = rows.right if right is None else right(here, matrix, rows.right)
        blocks[0 if together else rows.block].add(matrix, values, kept=rows.kept, weights=weights[here])
        position = here.stop
    return tuple(accumulator.compressed for _, accumulator in sorted(blocks.items()))


MAX_REWEIGHTINGS = 50

MAX_CONVERGED_SHARE = 1e-3
"""Step of a parameter, in its standard deviations, below which it counts as converged."""

STEP_TOLERANCE = 1e-10
"""Step of a parameter, relative to itself, below which it counts as converged: the limit for data without noise."""


@dataclass(frozen=True)
class ReweightedLeastSquares:
    """Weighted least squares that gives samples with large residuals less weight. Every iteration reads the recording.

    norm: "huber" or "tukey"
    """

    norm: Literal["huber", "tukey"] = "huber"
    assumptions: str = "most noise white, of its own size per joint, the rest outliers; q, v, a without error"
    needs: str = "q, v, a and actuator torques"

    def __post_init__(self) -> None:
        if self.norm not in ("huber", "tukey"):
            raise InvalidInput(f"norm is '{self.norm}'; use 'huber' or 'tukey'")

    @property
    def name(self) -> str:
        return f"IRLS {self.norm.capitalize()}"

    @property
    def reference(self) -> str:
        sources = {"huber": "Huber, Annals of Mathematical Statistics 35(1), 1964", "tukey": "Beaton and Tukey, 1974"}
        return sources[self.norm]

    def estimate(self, problem: Problem) -> Estimate:
        start, _ = weighted_solution(problem.equations)
        fit = _iterate(problem, huber(), start.x)
        iterations, converged = fit.iterations, fit.converged
        if self.norm == "tukey":
            fit = _iterate(problem, tukey(), fit.x)
            iterations, converged = iterations + fit.iterations, converged and fit.converged
        remarks = () if converged else (f"stopped after {iterations} iterations before the parameters had settled",)
        return base_estimate(
            problem,
            fit.x,
            fit.covariance,
            fit.scale,
            block_covariance=jackknife_covariance(fit.blocks, fit.x, np.ones(problem.n_joints)),
            iterations=iterations,
            settings={"mean weight": fit.mean_weight},
            remarks=remarks,
        )


@dataclass(frozen=True, eq=False)
class _Fit:
    x: Array
    covariance: Array
    blocks: tuple[CompressedEquations, ...]
    scale: Array
    mean_weight: float
    iterations: int
    converged: bool


def _iterate(problem: Problem, norm: Norm, x: Array) -> _Fit:
    residuals, used = residuals_of(problem, x), np.zeros(problem.n_joints)
    iterations, converged = 0, False
    while not converged and iterations < MAX_REWEIGHTINGS:
        scale = robust_scale(problem, residuals, used)
        weights = np.sqrt(norm.weight(np.nan_to_num(residuals / scale))) / scale
        (equations,), ones = weighted_blocks(problem, weights, together=True), np.ones(problem.n_joints)
        solution = solve(equations, ones)
        used = leverages(equations, ones, solution.inverse)
        step, x = np.abs(solution.x - x), solution.x
        residuals = residuals_of(problem, x)
        converged = bool(
            np.all(step <= MAX_CONVERGED_SHARE * np.sqrt(np.diag(solution.inverse)) + STEP_TOLERANCE * np.abs(x))
        )
        iterations += 1
    scale = robust_scale(problem, residuals, used)
    covariance, mean_weight = _covariance(problem, norm, residuals, scale)
    blocks = _blocks_at_minimum(problem, norm, x, residuals, scale)
    return _Fit(x, covariance, blocks, scale, mean_weight, iterations, converged)


def _blocks_at_minimum(
    problem: Problem, norm: Norm, x: Array, residuals: Array, scale: Array
) -> tuple[CompressedEquations, ...]:
    """Least-squares equations of every time block with the gradient of ρ at its minimum x.

    Their second derivative is the mean one of ρ over each joint: W_gᵀ w W_g times c_g = mean(ψ') / mean(w).
    """
    u = residuals / scale
    counted = np.isfinite(u)
    ratio = np.mean(norm.slope(u), axis=0, where=counted) / np.mean(norm.weight(u), axis=0, where=counted)
    weights = np.sqrt(ratio * norm.weight(np.nan_to_num(u))) / scale

    def right(here: slice, matrix: Array, _: Array) -> Array:
        return np.asarray(matrix @ x - np.nan_to_num(residuals[here]) / ratio)

    return weighted_blocks(problem, weights, right)


def _covariance(problem: Problem, norm: Norm, residuals: Array, scale: Array) -> tuple[Array, float]:
    """Covariance A⁻¹ B A⁻¹, and the mean weight."""
    u = residuals / scale
    counted = np.isfinite(u)
    influence, slope = norm.influence(u), norm.slope(u)
    mean_slope = np.mean(slope, axis=0, where=counted)
    counts = problem.equations.counts
    share = problem.base.rank / counts.sum()  # of the equations that the parameters use up
    kappa = (1 + share * np.var(slope, axis=0, where=counted) / mean_slope**2) ** 2
    spread = kappa * np.mean(influence**2, axis=0, where=counted) / (1 - share)
    a = solve(problem.equations, scale / np.sqrt(mean_slope))
    b, _ = problem.equations.weighted(scale / np.sqrt(spread))
    half = b @ a.inverse
    return half.T @ half, float(np.mean(norm.weight(u), where=counted))
