"""Physically consistent identification without constraints: nonlinear least squares in log-Cholesky coordinates.

    minimize Σ_g ‖W_g x(θ) - τ_g‖² / σ_g² + strength · ½ ‖S(θ) - E‖²

Every θ is a physically consistent body, so that no cone solver is needed. In return the cost is not convex. It is
minimized from several starts around the prior, with the analytic Jacobian, and the result states how many of them
agree. The quadratic prior keeps directions finite that the data do not determine. If the cheapest start does not pass
the certificate of the convex problem with the same cost, the convex problem is solved instead (it needs cvxpy and
Clarabel), and a remark says so.

Rucker and Wensing, "Smooth parameterization of rigid-body inertia", IEEE Robotics and Automation Letters 7(2), 2022.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.compressed import joint_noise
from graphdyn.identification.consistent.bodies import Bodies, PhysicalLimits, inequalities, unknown_bodies
from graphdyn.identification.consistent.coordinates import PriorCoordinates, prior_coordinates
from graphdyn.identification.consistent.fit import (
    PRIOR_MARGIN,
    ConsistentProblem,
    consistent_estimate,
    constraint_remark,
)
from graphdyn.identification.consistent.log_cholesky import PRIOR_STRENGTH, log_cholesky_fit
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.prior import Prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class LogCholesky:
    """Nonlinear least squares in log-Cholesky parameters, whose every value is a physically consistent body.

    prior: the model's parameters if left out
    starts: number of starts; the first from the prior, the others drawn around it
    strength: of the quadratic prior, > 0
    margin: as in ConsistentLeastSquares
    seed: of the starts
    """

    prior: Prior | None = None
    starts: int = 3
    strength: float = PRIOR_STRENGTH
    margin: float = PRIOR_MARGIN
    seed: int = 0
    name: str = "log-Cholesky"
    reference: str = "Rucker and Wensing 2022"
    assumptions: str = "as WLS; every body is a real one; one of the starts leads to the lowest minimum"
    needs: str = "q, v, a and actuator torques; a rough prior (CAD); for the fallback cvxpy and Clarabel"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput without a start or with a strength of 0."""
        bodies = unknown_bodies(problem.torque_model, self.prior)
        noise = joint_noise(problem.equations)
        coordinates = prior_coordinates(problem.base, *problem.equations.informed(noise), bodies.prior, bodies.columns)
        nonnegative = np.array([name in bodies.nonnegative for name in bodies.further], dtype=bool)
        try:
            fit = log_cholesky_fit(
                coordinates,
                nonnegative,
                strength=self.strength,
                starts=self.starts,
                margin=self.margin,
                seed=self.seed,
            )
        except EstimationFailed as failure:
            return self._fallback(problem, coordinates, bodies, noise, failure)
        missed = self.starts - fit.agreeing
        told = f"{missed} of {self.starts} starts ended higher" if missed else ""
        return Estimate(
            parameters=fit.parameters,
            covariance=coordinates.base_covariance if fit.best_fit else None,
            noise=noise,
            iterations=sum(start.evaluations for start in fit.starts),
            settings={
                "strength": self.strength,
                "starts that agree": float(fit.agreeing),
                "smallest part of prior": float(fit.eigenvalues.min()),
                "excess": fit.excess,
            },
            remarks=(*bodies.remarks, *filter(None, [told]), constraint_remark(fit.best_fit, fit.excess)),
        )

    def _fallback(
        self, problem: Problem, coordinates: PriorCoordinates, bodies: Bodies, noise: Array, failure: EstimationFailed
    ) -> Estimate:
        """Solution of the convex program with the same cost."""
        limits = inequalities(PhysicalLimits(), bodies, [column.name for column in problem.torque_model.columns])
        try:
            fit = ConsistentProblem(coordinates, limits, metric="pullback", margin=self.margin).solve(self.strength)
        except EstimationFailed as second:
            raise EstimationFailed(f"{failure}; and the convex fallback failed: {second}") from second
        remark = f"{failure}; this is the answer of the convex program with the same cost"
        return consistent_estimate(coordinates, fit, noise, (*bodies.remarks, remark), {"strength": self.strength})
