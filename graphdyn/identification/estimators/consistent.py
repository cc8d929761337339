"""Weighted least squares over physically consistent parameters: a program with linear matrix inequalities.

    minimize Σ_g ‖W_g x - τ_g‖² / σ_g²   subject to   P_i(x) ⪰ margin · P₀_i for every body,   F_v, F_c, I_a ≥ 0

P_i is the 4×4 pseudo-inertia matrix of body i, linear in its ten parameters. It is positive definite if and only if
some distribution of mass has these parameters: positive mass, positive definite tensor, triangle inequalities. P₀ is
that of the prior. The margin keeps the solution off the boundary, where a mass matrix is singular in some pose. Masses
and centers of mass may be bounded. If the data determine less than all parameters, the solution nearest to the prior is
taken (see consistent.fit).

Sousa and Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix inequality
approach", International Journal of Robotics Research 33(6), 2014. Wensing, Kim and Slotine, "Linear matrix inequalities
for physically consistent inertial parameter identification: a statistical perspective on the mass distribution", IEEE
Robotics and Automation Letters 3(1), 2018.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from graphdyn.identification.algebra.compressed import joint_noise
from graphdyn.identification.consistent.bodies import PhysicalLimits, inequalities, unknown_bodies
from graphdyn.identification.consistent.coordinates import prior_coordinates
from graphdyn.identification.consistent.fit import PRIOR_MARGIN, ConsistentProblem, consistent_estimate
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.prior import Prior
from graphdyn.identification.problem.problem import Problem


@dataclass(frozen=True, eq=False)
class ConsistentLeastSquares:
    """Weighted least squares over physically consistent bodies, by linear matrix inequalities.

    limits: on masses and centers of mass
    prior: for parameters that the data do not determine, and reference of the margin; the model's parameters if left
        out
    margin: fraction of the prior's inertia that every body keeps
    """

    limits: PhysicalLimits = field(default_factory=PhysicalLimits)
    prior: Prior | None = None
    margin: float = PRIOR_MARGIN
    name: str = "consistent"
    reference: str = "Sousa and Cortesão 2014; Wensing, Kim and Slotine 2018"
    assumptions: str = "as WLS; every body is a real one with at least a small part of the prior's inertia"
    needs: str = "q, v, a and actuator torques; a rough prior (CAD); cvxpy and Clarabel"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput for limits that make no sense."""
        bodies = unknown_bodies(problem.torque_model, self.prior)
        limits = inequalities(self.limits, bodies, [column.name for column in problem.torque_model.columns])
        noise = joint_noise(problem.equations)
        coordinates = prior_coordinates(problem.base, *problem.equations.informed(noise), bodies.prior, bodies.columns)
        fit = ConsistentProblem(coordinates, limits, metric="pullback", margin=self.margin).solve()
        return consistent_estimate(coordinates, fit, noise, bodies.remarks)
