"""Ordinary least squares on base parameters (IDIM-OLS).

    x = argmin Σ_g ‖W_g x - τ_g‖²

All joints count alike, in N m. The standard deviations allow each joint its own noise:
cov x = C (Σ_g σ_g² W_gᵀW_g) C,  C = (WᵀW)⁻¹,  σ_g² = ‖W_g x - τ_g‖² / (N_g - tr(W_g C W_gᵀ)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.compressed import CompressedEquations
from graphdyn.identification.estimate import Estimate
from graphdyn.identification.prior import model_prior
from graphdyn.identification.problem import Problem
from graphdyn.identification.solution import leverages, residual_deviations, solve
from graphdyn.layout import Array


@dataclass(frozen=True)
class OrdinaryLeastSquares:
    """The standard parameters are those with the estimated base parameters that are nearest to the model's."""

    name: str = "OLS"
    reference: str = "Gautier and Khalil, Direct calculation of minimum set of inertial parameters, 1990"
    assumptions: str = "white noise of the same size on all torques; q, v, a without error"
    needs: str = "q, v, a and actuator torques"

    def estimate(self, problem: Problem) -> Estimate:
        x, covariance, noise = ordinary_solution(problem.equations)
        parameters = model_prior(problem.torque_model).nearest(problem.base, x)
        return Estimate(parameters, covariance, noise)


def ordinary_solution(equations: CompressedEquations) -> tuple[Array, Array, Array]:
    """x (b,), its covariance (b, b), noise of each group (g,)."""
    ones = np.ones(equations.n_groups)
    solution = solve(equations, ones)
    noise = residual_deviations(equations, solution.x, leverages(equations, ones, solution.inverse))
    noisy = noise[:, None, None] * equations.factors[..., :-1]
    spread = noisy.reshape(-1, equations.n_columns) @ solution.inverse
    return solution.x, spread.T @ spread, noise
