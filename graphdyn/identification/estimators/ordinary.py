"""Ordinary least squares on base parameters (IDIM-OLS).

    x = argmin Σ_g ‖W_g x - τ_g‖²

All joints have the same weight, in N m. The standard deviations allow each joint its own noise:
cov x = C (Σ_g σ_g² W_gᵀW_g) C,  C = (WᵀW)⁻¹,  σ_g² = ‖W_g x - τ_g‖² / (N_g - tr(W_g C W_gᵀ)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.algebra.compressed import (
    CompressedEquations,
    Solution,
    leverages,
    residual_deviations,
    solve,
)
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.layout import Array


@dataclass(frozen=True)
class OrdinaryLeastSquares:
    """Ordinary least squares.

    The standard parameters are those with the estimated base parameters that are nearest to the model's.
    """

    name: str = "OLS"
    reference: str = "Atkeson, An and Hollerbach, Int. J. of Robotics Research 5(3), 1986; Gautier, 1991"
    assumptions: str = "white noise of the same size on all torques; q, v, a without error"
    needs: str = "q, v, a and actuator torques"

    def estimate(self, problem: Problem) -> Estimate:
        solution, covariance, noise = ordinary_solution(problem.equations)
        blocks = jackknife_covariance(problem.blocks, solution.x, np.ones(problem.n_joints))
        return base_estimate(problem, solution.x, covariance, noise, block_covariance=blocks)


def ordinary_solution(equations: CompressedEquations) -> tuple[Solution, Array, Array]:
    """The solution, its covariance (b, b), and the noise of each group (g,)."""
    ones = np.ones(equations.n_groups)
    solution = solve(equations, ones)
    used = leverages(equations, ones, solution.inverse)
    noise = residual_deviations(equations, equations.residual_squares(solution.x), used)
    noisy = noise[:, None, None] * equations.factors[..., :-1]
    spread = noisy.reshape(-1, equations.n_columns) @ solution.inverse
    return solution, spread.T @ spread, noise
