"""Weighted least squares on base parameters (IDIM-WLS): every joint is weighted by its own noise.

    x = argmin Σ_g ‖W_g x - τ_g‖² / σ_g²,     cov x = (Σ_g W_gᵀW_g / σ_g²)⁻¹

σ_g comes from the residual of joint g alone, fitted by the parameters that act on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from graphdyn.identification.algebra.base_parameters import MIN_COLUMN_SHARE, RANK_TOLERANCE
from graphdyn.identification.algebra.compressed import CompressedEquations, Solution, residual_deviations, solve
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.layout import Array


@dataclass(frozen=True)
class WeightedLeastSquares:
    """Weighted least squares.

    The standard parameters are those with the estimated base parameters that are nearest to the model's.
    """

    name: str = "WLS"
    reference: str = "Gautier, Dynamic identification of robots with power model, IEEE ICRA 1997"
    assumptions: str = "white noise of its own size on the torque of each joint; q, v, a without error"
    needs: str = "q, v, a and actuator torques"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        solution, noise = weighted_solution(problem.equations)
        blocks = jackknife_covariance(problem.blocks, solution.x, noise)
        return base_estimate(problem, solution.x, solution.inverse, noise, block_covariance=blocks)


def weighted_solution(equations: CompressedEquations) -> tuple[Solution, Array]:
    """The solution, whose inverse is its covariance, and the noise of each group (g,)."""
    noise = joint_noise(equations)
    return solve(equations, noise), noise


def joint_noise(equations: CompressedEquations) -> Array:
    """σ_g (g,) of the torque of each joint: as given, or from its own equations alone."""
    if equations.noise is not None:
        return equations.noise
    squares, used = np.empty(equations.n_groups), np.empty(equations.n_groups)
    for g, factor in enumerate(equations.factors):
        w, right = factor[:, :-1], factor[:, -1]
        length = np.linalg.norm(w, axis=0)
        seen = length > MIN_COLUMN_SHARE * length.max(initial=0.0)  # the rest is rounding, and stays so if not scaled
        unit = w[:, seen] / length[seen]
        x, _, used[g], _ = np.linalg.lstsq(unit, right, rcond=RANK_TOLERANCE)
        squares[g] = np.sum((unit @ x - right) ** 2)
    return residual_deviations(equations, squares, used)
