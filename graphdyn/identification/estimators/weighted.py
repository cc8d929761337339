"""Weighted least squares on base parameters (IDIM-WLS): every joint counts by its own noise.

    x = argmin Σ_g ‖W_g x - τ_g‖² / σ_g²,     cov x = (Σ_g W_gᵀW_g / σ_g²)⁻¹

σ_g comes from the residual of joint g alone, fitted by the parameters that it sees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.compressed import CompressedEquations
from graphdyn.identification.estimate import Estimate
from graphdyn.identification.prior import model_prior
from graphdyn.identification.problem import Problem
from graphdyn.identification.solution import EPS, residual_deviations, solve
from graphdyn.layout import Array


@dataclass(frozen=True)
class WeightedLeastSquares:
    """The standard parameters are those with the estimated base parameters that are nearest to the model's."""

    name: str = "WLS"
    reference: str = "Gautier, Dynamic identification of robots with power model, ICRA 1997"
    assumptions: str = "white noise of its own size on the torque of each joint; q, v, a without error"
    needs: str = "q, v, a and actuator torques"

    def estimate(self, problem: Problem) -> Estimate:
        x, covariance, noise = weighted_solution(problem.equations)
        parameters = model_prior(problem.torque_model).nearest(problem.base, x)
        return Estimate(parameters, covariance, noise)


def weighted_solution(equations: CompressedEquations) -> tuple[Array, Array, Array]:
    """x (b,), its covariance (b, b), noise of each group (g,)."""
    noise = joint_noise(equations)
    solution = solve(equations, noise)
    return solution.x, solution.inverse, noise


def joint_noise(equations: CompressedEquations) -> Array:
    """σ_g (g,) of the torque of each joint, from its own equations alone."""
    noise = np.empty(equations.n_groups)
    for g, factor in enumerate(equations.factors):
        w, right = factor[:, :-1], factor[:, -1]
        length = np.linalg.norm(w, axis=0)
        length[length == 0] = 1.0
        x, _, rank, _ = np.linalg.lstsq(w / length, right, rcond=len(w) * EPS)
        alone = CompressedEquations(equations.factors[g : g + 1], equations.counts[g : g + 1])
        noise[g] = residual_deviations(alone, x / length, np.array([float(rank)]))[0]
    return noise
