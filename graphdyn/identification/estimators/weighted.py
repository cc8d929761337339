"""Weighted least squares on base parameters (IDIM-WLS): every joint is weighted by its own noise.

    x = argmin Σ_g ‖W_g x - τ_g‖² / σ_g²,     cov x = (Σ_g W_gᵀW_g / σ_g²)⁻¹

σ_g comes from the residual of joint g alone, fitted by the parameters that act on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from graphdyn.identification.algebra.compressed import (
    weighted_solution,
)
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance


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
