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

Olsen, Swevers and Verdonck, "Maximum likelihood identification of a dynamic robot model: implementation issues", Int.
J. of Robotics Research 21(2), 2002; the iteration: Britt and Luecke, Technometrics 15(2), 1973.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.identification.algebra.solution import residual_deviations, solve
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.estimators.weighted import weighted_solution
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.identification.statistics.errors_in_variables import measured_motion, whitened
from graphdyn.identification.terms.friction import positive
from graphdyn.layout import Array

CONVERGENCE_SHARE = 0.01
"""Step of a base parameter, in its standard deviations, below which it counts as converged."""

MAX_LIKELIHOOD_ITERATIONS = 50
"""Iterations after which an estimate that still moves has diverged."""

MIN_NOISE_SHARE = 0.1
"""Smallest noise of a torque, relative to its residual, if the errors of the motion explain all of it: C is not
exact."""

LARGEST_SHARE_SETTING = "residual by errors of the motion"
"""Name of the setting with Σ G C Gᵀ over Σ e² of the joint with the largest ratio."""


@dataclass(frozen=True, eq=False)
class MaximumLikelihood:
    """Maximum likelihood with noisy positions.

    The standard parameters are those with the estimated base parameters that are nearest to the model's.

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
