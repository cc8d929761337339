"""Weighted least squares over physically consistent parameters: a program with linear matrix inequalities.

    minimize Σ_g ‖W_g x - τ_g‖² / σ_g²   subject to   P_i(x) ⪰ margin · P₀_i for every body,   F_v, F_c, I_a ≥ 0

P_i is the 4×4 pseudo-inertia matrix of body i, linear in its ten parameters. It is positive definite if and only if
some distribution of mass has these parameters: positive mass, positive definite tensor, triangle inequalities. P₀ is
that of the prior. The margin keeps the solution off the boundary, where a mass matrix is singular in some pose. Masses
stay near those of CAD and matter within the reach of its link (bodies.limits). If the data determine less than all
parameters, the solution nearest to the prior is taken (see consistent.fit).

Sousa and Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix inequality
approach", International Journal of Robotics Research 33(6), 2014. Wensing, Kim and Slotine, "Linear matrix inequalities
for physically consistent inertial parameter identification: a statistical perspective on the mass distribution", IEEE
Robotics and Automation Letters 3(1), 2018.

ConsistentWithPrior adds a prior on the manifold of physically consistent inertias.

    minimize Σ_g ‖W_g x - τ_g‖² / σ_g² + strength Σ_i d(P_i(x), P₀_i)
    subject to P_i ⪰ margin · P₀_i for every body,  F_v, F_c, I_a ≥ 0

d is the entropic divergence (log-det Bregman divergence), or its quadratic approximation near the prior, the pullback
metric. Unlike a ridge in kg, kg m and kg m², both are independent of units and of the choice of link frames, and
measure every body by its own size. A strength γ expects the entries of a body within √(2/γ) of the prior, relative: 200
trusts it to 10 %. Cross-validation over time blocks chooses the strength. Strength 0 is the limit: the prior then
decides only what the data do not determine.

Lee, Wensing and Park, "Geometric robot dynamic identification: a convex programming approach", IEEE Transactions on
Robotics 36(2), 2020.

In RobustConsistent samples with large residuals count less, by Huber's norm.

    minimize Σ_g Σ_t 2 ρ(e_gt / σ_g) + strength Σ_i d(P_i(x), P₀_i)
    subject to P_i ⪰ margin · P₀_i for every body,  F_v, F_c, I_a ≥ 0

by iterative reweighting: with the weights w(u) = ρ'(u) / u of the last residuals it is the program of
ConsistentWithPrior (ConsistentLeastSquares without a metric). At a given σ the cost is convex, and each step lowers it.
Stiction at standstill, slips and collisions then distort neither friction nor links. Cross-validation chooses the
strength of the prior, with the weights that were found without a prior.

Huber, Annals of Mathematical Statistics 35(1), 1964; Wensing, Kim and Slotine, IEEE Robotics and Automation Letters
3(1), 2018; Lee, Wensing and Park, IEEE Transactions on Robotics 36(2), 2020.

LogCholesky needs no constraints: it is nonlinear least squares in log-Cholesky coordinates.

    minimize Σ_g ‖W_g x(θ) - τ_g‖² / σ_g² + strength · ½ ‖S(θ) - E‖²

Every θ is a physically consistent body, so that no cone solver is needed. In return the cost is not convex. It is
minimized from several starts around the prior, with the analytic Jacobian, and the result states how many of them
agree. The quadratic prior keeps directions finite that the data do not determine. If the cheapest start does not pass
the certificate of the convex problem with the same cost, or leaves a limit of the bodies, the convex problem is solved
instead (it needs Clarabel), and a remark says so.

Rucker and Wensing, "Smooth parameterization of rigid-body inertia", IEEE Robotics and Automation Letters 7(2), 2022.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.compressed import CompressedEquations, joint_noise, merged, weighted_solution
from graphdyn.identification.bodies.limits import PhysicalLimits
from graphdyn.identification.consistent.fit import (
    PRIOR_MARGIN,
    WEAK_STRENGTH,
)
from graphdyn.identification.consistent.log_cholesky import PRIOR_STRENGTH, log_cholesky_fit
from graphdyn.identification.consistent.polishing import Metric
from graphdyn.identification.consistent.program import ConsistentProgram
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.estimators.reweighted import (
    HUBER_THRESHOLD,
    huber,
    residuals_of,
    robust_scale,
    weighted_blocks,
)
from graphdyn.identification.problem.prior import Prior
from graphdyn.identification.problem.problem import Problem, together
from graphdyn.layout import Array

CONE_SOLVER = ("clarabel",)
"""Packages without which a convex program has no answer."""


@dataclass(frozen=True, eq=False)
@short_repr
class ConsistentLeastSquares:
    """Weighted least squares over physically consistent bodies, by linear matrix inequalities.

    limits: on masses, centers of mass and sizes; by default those of CAD
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
    needs: str = "q, v, a and actuator torques; a rough prior (CAD); Clarabel"
    packages: ClassVar[tuple[str, ...]] = CONE_SOLVER
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput for limits that make no sense."""
        program = ConsistentProgram(problem, self.prior, "pullback", self.margin, self.limits)
        noise = joint_noise(problem.equations)
        found = program.convex(problem.equations, noise).solve().told(noise, {}, *program.remarks)
        return replace(found, limits=program.body_limits)


PRIOR_STRENGTHS = (1e2, 1e3, 1e4, 1e5, 1e6, 1e7)
"""Strengths among which cross-validation chooses. The weakest trusts the entries of a body to 14 %: folds of a short
recording prefer less by chance, and other rows do not (TX40: 13.0 % without this floor, 12.9 % with it; UR10 with
Huber's weights: 7.5 and 7.6 %)."""


@dataclass(frozen=True, eq=False)
@short_repr
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
    needs: str = "q, v, a and actuator torques; a prior (CAD); Clarabel"
    packages: ClassVar[tuple[str, ...]] = CONE_SOLVER
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
        program = ConsistentProgram(problem, self.prior, self.metric, self.margin, self.limits)
        noise = joint_noise(problem.equations)
        strength, remarks = program.strength(self.strength, self.strengths, noise, problem.folds)
        fit = program.convex(problem.equations, noise).solve(strength)
        found = fit.told(noise, {"strength": strength}, *program.remarks, *remarks)
        return replace(found, limits=program.body_limits)


MAX_TORQUE_CHANGE = 1e-2
"""RMS change of a joint's predicted torque, relative to its noise, below which the iteration has converged."""

MAX_ROBUST_ITERATIONS = 30


@dataclass(frozen=True, eq=False)
@short_repr
class RobustConsistent:
    """Huber's norm over physically consistent bodies. Every iteration reads the recording and solves a cone program.

    metric: distance from the prior, "entropic" or "pullback"; none without a prior
    strength: of the prior; chosen by cross-validation from strengths if left out
    prior, limits, margin: as in ConsistentLeastSquares
    threshold: residual, in units of the noise, from which samples count less
    """

    metric: Metric | None = None
    strength: float | None = None
    strengths: Sequence[float] = PRIOR_STRENGTHS
    prior: Prior | None = None
    limits: PhysicalLimits = field(default_factory=PhysicalLimits)
    margin: float = PRIOR_MARGIN
    threshold: float = HUBER_THRESHOLD
    reference: str = "Huber 1964; Wensing, Kim and Slotine 2018; Lee, Wensing and Park 2020"
    assumptions: str = "most noise white, of its own size per joint, the rest outliers; every body is a real one"
    needs: str = "q, v, a and actuator torques; a rough prior (CAD); Clarabel"
    packages: ClassVar[tuple[str, ...]] = CONE_SOLVER

    @property
    def name(self) -> str:
        return f"consistent, {self.metric} prior, Huber" if self.metric else "consistent, Huber"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput for limits that make no sense."""
        program = ConsistentProgram(problem, self.prior, self.metric or "pullback", self.margin, self.limits)
        start, _ = weighted_solution(problem.equations)
        # weights without a prior first, so that cross-validation compares strengths with the same outliers left out
        state = self._settled(program, residuals_of(problem, start.x), WEAK_STRENGTH)
        given, ones = 0.0 if self.metric is None else self.strength, np.ones(problem.n_joints)
        strength, remarks = program.strength(given, self.strengths, ones, together(state.blocks))
        iterations = state.iterations
        if strength > 0:
            state = self._settled(program, state.residuals, strength)
            iterations += state.iterations
        if not state.converged:
            remarks += (f"stopped after {MAX_ROBUST_ITERATIONS} reweightings before the torques had settled",)
        settings = {"strength": strength} if self.metric else {}
        settings["mean weight"] = state.mean_weight
        fit = program.convex(merged(state.blocks), ones).solve(strength)
        found = fit.told(state.scale, settings, *program.remarks, *remarks)
        return replace(found, covariance=None, iterations=iterations, limits=program.body_limits)

    def _settled(self, program: ConsistentProgram, residuals: Array, strength: float) -> _State:
        """Iterate from these residuals until the fit converges."""
        problem, norm, ones = program.problem, huber(self.threshold), np.ones(program.problem.n_joints)
        used = problem.base.rank / problem.equations.counts.sum()
        iteration, converged = 0, False
        while not converged and iteration < MAX_ROBUST_ITERATIONS:
            iteration += 1
            # noise from the residuals, then weights from both, then the fit, until the torques settle
            scale = robust_scale(problem, residuals, used * problem.equations.counts)
            weights = norm.weight(np.nan_to_num(residuals / scale))
            blocks = weighted_blocks(problem, np.sqrt(weights) / scale)
            x = problem.base.values(program.convex(merged(blocks), ones).solve(strength).parameters)
            before, residuals = residuals, residuals_of(problem, x)
            step = np.sqrt(np.nanmean((residuals - before) ** 2, axis=0))
            converged = bool(np.all(step <= MAX_TORQUE_CHANGE * scale))
        mean_weight = float(np.mean(weights, where=np.isfinite(before)))
        return _State(residuals, blocks, scale, mean_weight, iteration, converged)


@dataclass(frozen=True, eq=False)
class _State:
    """State of the iteration.

    residuals (N, n), blocks with the weights of the previous residuals, scale (n,) [N m or N]
    """

    residuals: Array
    blocks: tuple[CompressedEquations, ...]
    scale: Array
    mean_weight: float
    iterations: int
    converged: bool


@dataclass(frozen=True, eq=False)
@short_repr
class LogCholesky:
    """Nonlinear least squares in log-Cholesky parameters, whose every value is a physically consistent body.

    prior: the model's parameters if left out
    starts: number of starts; the first from the prior, the others drawn around it
    strength: of the quadratic prior, > 0
    limits, margin: as in ConsistentLeastSquares; if the result would leave the limits, the convex problem with the same
        cost is solved within them
    seed: of the starts
    """

    prior: Prior | None = None
    starts: int = 3
    strength: float = PRIOR_STRENGTH
    limits: PhysicalLimits = field(default_factory=PhysicalLimits)
    margin: float = PRIOR_MARGIN
    seed: int = 0
    name: str = "log-Cholesky"
    reference: str = "Rucker and Wensing 2022"
    assumptions: str = "as WLS; every body is a real one; one of the starts leads to the lowest minimum"
    needs: str = "q, v, a and actuator torques; a rough prior (CAD); for the fallback Clarabel"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput without a start or with a strength of 0."""
        program = ConsistentProgram(problem, self.prior, "pullback", self.margin, self.limits)
        bodies, noise = program.bodies, joint_noise(problem.equations)
        nonnegative = np.array([name in bodies.nonnegative for name in bodies.further], dtype=bool)
        try:
            fit = log_cholesky_fit(
                program.coordinates(problem.equations, noise),
                nonnegative,
                strength=self.strength,
                starts=self.starts,
                margin=self.margin,
                seed=self.seed,
            )
        except EstimationFailed as failure:
            return self._fallback(program, noise, failure)
        if left := program.inequalities.violated(fit.parameters):
            return self._fallback(program, noise, EstimationFailed(f"log-Cholesky left {' and '.join(left)}"))
        missed = self.starts - fit.agreeing
        remarks = (f"{missed} of {self.starts} starts ended higher",) if missed else ()
        settings = {"strength": self.strength, "starts that agree": float(fit.agreeing)}
        evaluations = sum(start.evaluations for start in fit.starts)
        found = fit.estimate(noise, evaluations, settings, *program.remarks, *remarks)
        return replace(found, limits=program.body_limits)

    def _fallback(self, program: ConsistentProgram, noise: Array, failure: EstimationFailed) -> Estimate:
        """Solution of the convex program with the same cost."""
        try:
            convex = program.convex(program.problem.equations, noise)
            fit = convex.solve()
            if not fit.best_fit:
                fit = convex.solve(self.strength)
        except EstimationFailed as second:
            raise EstimationFailed(f"{failure}; and the convex fallback failed: {second}") from second
        remark = f"{failure}; this is the answer of the convex program with the same cost"
        found = fit.told(noise, {"strength": self.strength}, *program.remarks, remark)
        return replace(found, limits=program.body_limits)
