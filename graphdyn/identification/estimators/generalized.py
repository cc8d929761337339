"""Generalized least squares: noise that is correlated between the joints.

    x = argmin Σ_t e_tᵀ Σ⁻¹ e_t,  e_t = W_t x - τ_t (n,),     cov x = (Σ_t W_tᵀ Σ⁻¹ W_t)⁻¹

Σ (n, n) comes from the residuals of weighted least squares. If some equations of a sample are left out, the rows and
columns of the others are used. Aitken, 1936; Zellner, "An efficient method of estimating seemingly unrelated
regressions", J. of the American Statistical Association 57, 1962.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import (
    EPS,
    CompressedEquations,
    leverages,
    merged,
    solve,
    weighted_solution,
)
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.layout import Array

MIN_COMPLETE_SAMPLES = 10
"""Fewest complete samples per joint: fewer give no usable covariance between the joints."""

MIN_CORRELATION_EIGENVALUE = 1e-6
"""Smallest eigenvalue of the correlation between the joints; below it, some joints repeat the noise of others."""


@dataclass(frozen=True)
class GeneralizedLeastSquares:
    """Generalized least squares."""

    name: str = "GLS"
    reference: str = "Zellner, J. of the American Statistical Association 57, 1962"
    assumptions: str = "noise white in time, correlated between the joints of one sample; q, v, a without error"
    needs: str = "q, v, a and actuator torques of all joints at the same instants"

    def estimate(self, problem: Problem) -> Estimate:
        start, noise = weighted_solution(problem.equations)
        used = leverages(problem.equations, noise, start.inverse)
        covariance = error_covariance(problem, start.x, used)
        blocks = whitened_blocks(problem, covariance)
        ones = np.ones(problem.n_joints)
        solution = solve(merged(blocks), ones)
        deviations = np.sqrt(np.diag(covariance))
        correlation = covariance / deviations / deviations[:, None]
        strongest = float(np.abs(correlation - np.eye(len(noise))).max())
        return base_estimate(
            problem,
            solution.x,
            solution.inverse,
            deviations,
            block_covariance=jackknife_covariance(blocks, solution.x, ones),
            iterations=2,
            settings={"largest correlation between joints": strongest},
        )


def error_covariance(problem: Problem, x: Array, used: Array) -> Array:
    """Σ (n, n) over the samples whose equations all count; used: equations of each joint that the parameters use up
    (n,).

    Raises EstimationFailed if there are too few samples, or one joint repeats the noise of others.
    """
    n, count = problem.n_joints, 0
    products, squares = np.zeros((n, n)), np.zeros(n)
    for rows in problem.rows():
        complete = rows.kept.all(axis=1)
        residual = (problem.reduced(rows) @ x - rows.right)[complete]
        products += residual.T @ residual
        squares += np.sum(rows.right[complete] ** 2, axis=0)
        count += len(residual)
    if count < MIN_COMPLETE_SAMPLES * n:
        raise EstimationFailed(
            f"only {count} samples have equations of all {n} joints, {MIN_COMPLETE_SAMPLES * n} needed for the "
            "covariance between the joints; lower min_speed, or use weighted least squares"
        )
    spare = count - used * count / problem.equations.counts
    products += np.diag(EPS**2 * squares + np.finfo(float).tiny)
    covariance = products / np.sqrt(np.outer(spare, spare))
    deviations = np.sqrt(np.diag(covariance))
    weakest = float(np.linalg.eigvalsh(covariance / deviations / deviations[:, None])[0])
    if weakest < MIN_CORRELATION_EIGENVALUE:
        raise EstimationFailed(
            f"the noise of some joints repeats that of others (smallest eigenvalue of the correlation {weakest:.2g}); "
            "is one torque computed from others? Use weighted least squares"
        )
    return covariance


def whitened_blocks(problem: Problem, covariance: Array) -> list[CompressedEquations]:
    """L⁻¹ W_t x = L⁻¹ τ_t with Σ = L Lᵀ, time block by time block."""
    n = problem.n_joints
    blocks: dict[int, Accumulator] = defaultdict(lambda: Accumulator(problem.base.rank, n))
    for rows in problem.rows():
        matrix, right = problem.reduced(rows), rows.right
        for pattern in np.unique(rows.kept, axis=0):
            if not pattern.any():
                continue
            samples = np.flatnonzero((rows.kept == pattern).all(axis=1))
            joints = np.flatnonzero(pattern)
            whiten = np.linalg.inv(np.linalg.cholesky(covariance[np.ix_(joints, joints)]))
            at = np.ix_(samples, joints)
            white_rows, white_right = np.zeros((len(samples), n, matrix.shape[-1])), np.zeros((len(samples), n))
            white_rows[:, joints] = np.einsum("jk,tkc->tjc", whiten, matrix[at])
            white_right[:, joints] = right[at] @ whiten.T
            blocks[rows.block].add(white_rows, white_right, kept=np.broadcast_to(pattern, white_right.shape))
    return [accumulator.compressed for _, accumulator in sorted(blocks.items())]
