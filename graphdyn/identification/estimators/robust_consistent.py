"""Physically consistent least squares in which samples with large residuals count less, by Huber's norm.

    minimize Σ_g Σ_t 2 ρ(e_gt / σ_g) + strength Σ_i d(P_i(x), P₀_i)
    subject to P_i ⪰ margin · P₀_i for every body,  F_v, F_c, I_a ≥ 0

by iterative reweighting: with the weights w(u) = ρ'(u) / u of the last residuals it is the program of
ConsistentWithPrior (ConsistentLeastSquares without a metric). At a given σ the cost is convex, and each step lowers it.
Stiction at standstill, slips and collisions then distort neither friction nor links. Cross-validation chooses the
strength of the prior, with the weights that were found without a prior.

Huber, Annals of Mathematical Statistics 35(1), 1964; Wensing, Kim and Slotine, IEEE Robotics and Automation Letters
3(1), 2018; Lee, Wensing and Park, IEEE Transactions on Robotics 36(2), 2020.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from graphdyn.identification.algebra.compressed import CompressedEquations, merged, weighted_solution
from graphdyn.identification.consistent.bodies import Bodies, Inequalities, PhysicalLimits, inequalities, unknown_bodies
from graphdyn.identification.consistent.coordinates import PriorCoordinates, prior_coordinates
from graphdyn.identification.consistent.fit import (
    PRIOR_MARGIN,
    WEAK_STRENGTH,
    ConsistentFit,
    ConsistentProblem,
    consistent_estimate,
)
from graphdyn.identification.consistent.polishing import Metric
from graphdyn.identification.estimation.cross_validation import Trained, cross_validation
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.estimators.consistent_prior import PRIOR_STRENGTHS
from graphdyn.identification.estimators.reweighted import (
    HUBER_THRESHOLD,
    Norm,
    huber,
    residuals_of,
    robust_scale,
    weighted_blocks,
)
from graphdyn.identification.problem.prior import Prior
from graphdyn.identification.problem.problem import Problem, together
from graphdyn.layout import Array

MAX_TORQUE_CHANGE = 1e-2
"""Root mean square change of a joint's predicted torque, relative to its noise, below which the iteration has
converged."""

MAX_ROBUST_ITERATIONS = 30


@dataclass(frozen=True, eq=False)
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
    needs: str = "q, v, a and actuator torques; a rough prior (CAD); cvxpy and Clarabel"

    @property
    def name(self) -> str:
        return f"consistent, {self.metric} prior, Huber" if self.metric else "consistent, Huber"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed, and InvalidInput for limits that make no sense."""
        bodies = unknown_bodies(problem.torque_model, self.prior)
        limits = inequalities(self.limits, bodies, [column.name for column in problem.torque_model.columns])
        program = _Program(problem, bodies, limits, self.metric or "pullback", self.margin, huber(self.threshold))
        start, _ = weighted_solution(problem.equations)
        # weights without a prior first, so that cross-validation compares strengths with the same outliers left out
        state = program.settled(residuals_of(problem, start.x), WEAK_STRENGTH)
        strength, remarks = 0.0 if self.metric is None else self.strength, bodies.remarks
        if strength is None:
            folds, ones = together(state.blocks), np.ones(problem.n_joints)

            def trained(equations: CompressedEquations) -> Trained:
                return lambda chosen: program.solve(equations, chosen)[1].parameters

            choice = cross_validation(problem, ones, self.strengths, trained, folds=folds)
            strength, remarks = choice.best, (*remarks, *choice.remarks)
        iterations = state.iterations
        if strength > 0:
            state = program.settled(state.residuals, strength)
            iterations += state.iterations
        coordinates, fit = program.solve(merged(state.blocks), strength)
        if not state.converged:
            remarks += (f"stopped after {MAX_ROBUST_ITERATIONS} reweightings before the torques had settled",)
        settings = {"strength": strength} if self.metric else {}
        settings["mean weight"] = state.mean_weight
        found = consistent_estimate(coordinates, fit, state.scale, remarks, settings)
        return replace(found, covariance=None, iterations=iterations)


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
class _Program:
    problem: Problem
    bodies: Bodies
    limits: Inequalities
    metric: Metric
    margin: float
    norm: Norm

    def solve(self, equations: CompressedEquations, strength: float) -> tuple[PriorCoordinates, ConsistentFit]:
        """Fit to equations that contain their weights."""
        weighted = equations.weighted(np.ones(equations.n_groups))
        coordinates = prior_coordinates(self.problem.base, *weighted, self.bodies.prior, self.bodies.columns)
        program = ConsistentProblem(coordinates, self.limits, metric=self.metric, margin=self.margin)
        return coordinates, program.solve(strength)

    def settled(self, residuals: Array, strength: float) -> _State:
        """Iterate from these residuals until the fit converges."""
        used = self.problem.base.rank / self.problem.equations.counts.sum()
        iteration, converged = 0, False
        while not converged and iteration < MAX_ROBUST_ITERATIONS:
            iteration += 1
            # noise from the residuals, then weights from both, then the fit, until the torques settle
            scale = robust_scale(self.problem, residuals, used * self.problem.equations.counts)
            weights = self.norm.weight(np.nan_to_num(residuals / scale))
            blocks = weighted_blocks(self.problem, np.sqrt(weights) / scale)
            x = self.problem.base.values(self.solve(merged(blocks), strength)[1].parameters)
            before, residuals = residuals, residuals_of(self.problem, x)
            step = np.sqrt(np.nanmean((residuals - before) ** 2, axis=0))
            converged = bool(np.all(step <= MAX_TORQUE_CHANGE * scale))
            if converged:
                break
        return _State(
            residuals, blocks, scale, float(np.mean(weights, where=np.isfinite(before))), iteration, converged
        )
