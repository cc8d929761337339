"""Physically consistent least squares with a prior on the manifold of physically consistent inertias.

    minimize Σ_g ‖W_g x - τ_g‖² / σ_g² + strength Σ_i d(P_i(x), P₀_i)
    subject to P_i ⪰ margin · P₀_i for every body,  F_v, F_c, I_a ≥ 0

d is the entropic divergence (log-det Bregman divergence), or its quadratic approximation near the prior, the pullback
metric. Unlike a ridge in kg, kg m and kg m², both are independent of units and of the choice of link frames, and
measure every body by its own size. A strength γ expects the entries of a body within √(2/γ) of the prior, relative: 200
trusts it to 10 %. Cross-validation over time blocks chooses the strength. Strength 0 is the limit: the prior then
decides only what the data do not determine.

Lee, Wensing and Park, "Geometric robot dynamic identification: a convex programming approach", IEEE Transactions on
Robotics 36(2), 2020.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.compressed import CompressedEquations, joint_noise
from graphdyn.identification.consistent.bodies import PhysicalLimits, inequalities, unknown_bodies
from graphdyn.identification.consistent.coordinates import PriorCoordinates, prior_coordinates
from graphdyn.identification.consistent.fit import PRIOR_MARGIN, ConsistentProblem, consistent_estimate
from graphdyn.identification.consistent.polishing import Metric
from graphdyn.identification.estimation.cross_validation import Trained, cross_validation
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.prior import Prior
from graphdyn.identification.problem.problem import Problem

PRIOR_STRENGTHS = (0.0, 1e-1, 1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7)


@dataclass(frozen=True, eq=False)
class ConsistentWithPrior:
    """Weighted least squares over physically consistent bodies, drawn towards a prior by a distance between inertias.

    metric: "entropic" or "pullback"
    strength: of the prior; chosen by cross-validation from strengths if left out
    prior: the model's parameters if left out
    limits, margin: as in ConsistentLeastSquares

    Raises InvalidInput for another metric, or strengths that are negative or not increasing.
    """

    metric: Metric = "entropic"
    strength: float | None = None
    strengths: Sequence[float] = PRIOR_STRENGTHS
    prior: Prior | None = None
    limits: PhysicalLimits = field(default_factory=PhysicalLimits)
    margin: float = PRIOR_MARGIN
    reference: str = "Lee, Wensing and Park 2020"
    assumptions: str = "as WLS; every body is a real one, and about as likely to be lighter as heavier than the prior"
    needs: str = "q, v, a and actuator torques; a prior (CAD); cvxpy and Clarabel"
    takes_expected: ClassVar[bool] = True

    def __post_init__(self) -> None:
        tried = list(self.strengths if self.strength is None else (self.strength,))
        if self.metric not in ("entropic", "pullback"):
            raise InvalidInput(f"metric is '{self.metric}'; use 'entropic' or 'pullback'")
        if not tried or not tried[0] >= 0 or any(not b > a for a, b in itertools.pairwise(tried)):
            raise InvalidInput(f"strengths are {tried}; increasing numbers ≥ 0 needed")

    @property
    def name(self) -> str:
        return f"consistent, {self.metric} prior"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput for limits that make no sense."""
        bodies = unknown_bodies(problem.torque_model, self.prior)
        limits = inequalities(self.limits, bodies, [column.name for column in problem.torque_model.columns])
        noise = joint_noise(problem.equations)

        def prepared(equations: CompressedEquations) -> tuple[PriorCoordinates, ConsistentProblem]:
            coordinates = prior_coordinates(problem.base, *equations.informed(noise), bodies.prior, bodies.columns)
            return coordinates, ConsistentProblem(coordinates, limits, metric=self.metric, margin=self.margin)

        def trained(equations: CompressedEquations) -> Trained:
            program = prepared(equations)[1]
            return lambda strength: program.solve(strength).parameters

        strength, remarks = self.strength, bodies.remarks
        if strength is None:
            choice = cross_validation(problem, noise, self.strengths, trained)
            strength, remarks = choice.best, (*remarks, *choice.remarks)
        coordinates, program = prepared(problem.equations)
        return consistent_estimate(coordinates, program.solve(strength), noise, remarks, {"strength": strength})
