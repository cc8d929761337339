"""Least squares over physically consistent bodies: the common part of the convex methods.

With a strength: minimize ‖A u - b‖² + strength · d(u) over S_i ⪰ margin · E and the inequalities.

Strength 0 is the limit from above. If some best fits u are consistent, the one nearest to the prior is taken. Its base
parameters are those of weighted least squares to the last digit, whatever the solver's precision, because the solver
only searches the null space. The prior then decides only what the data do not determine. If no best
fit is consistent, the constraints are active. The quadratic distance with the strength WEAK_STRENGTH then fixes what
the data do not determine.

With more than WEAK_STRENGTH, Newton's method comes from the prior, or from the solution of another strength, to the
minimum in a few steps if that lies off the margin (polishing): the entropic distance is its own barrier, and a strong
quadratic one keeps bodies inside. Where it does not, Clarabel solves the cone program.

A solution is accepted by its eigenvalues, the inequalities and the certificate of its cost, whatever found it and
whatever status the solver reports.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.bodies.inequalities import VIOLATION_TOLERANCE, Inequalities
from graphdyn.identification.consistent.coordinates import PriorCoordinates
from graphdyn.identification.consistent.polishing import Cost, Metric, polished, suboptimality
from graphdyn.identification.consistent.semidefinite import (
    INFEASIBLE,
    OPTIMAL,
    ConicAnswer,
    SemidefiniteProgram,
    least_violations,
)
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.layout import Array

PRIOR_MARGIN = 1e-4
"""Fraction of its prior that every body keeps: P ⪰ PRIOR_MARGIN · P₀. Then M(q) ⪰ PRIOR_MARGIN · M₀(q) in every pose:
solutions do not lie on the boundary, where a mass matrix is singular."""

WEAK_STRENGTH = 1e-2
"""Strength without data if constraints are active: an entry of S costs one variance at fourteen times the prior."""

MIN_MARGIN_SHARE = 0.5
"""Fraction of the margin that a solution must keep; the solver is far more exact."""

MAX_COST_EXCESS = 1e-3
"""Largest amount of a solution's cost above the minimum, relative to the cost or one variance of the residuals."""


@dataclass(frozen=True, eq=False)
class ConsistentFit:
    """A physically consistent fit.

    u: in the coordinates of the prior                      (p,)
    best_fit: among the best fits; no constraint costs anything
    """

    coordinates: PriorCoordinates
    u: Array
    best_fit: bool

    @property
    def parameters(self) -> Array:
        """Parameters x (p,)."""
        return self.coordinates.fitting_parameters(self.u) if self.best_fit else self.coordinates.parameters(self.u)

    @property
    def excess(self) -> float:
        """‖A u - b‖² above that of unconstrained least squares, in variances of one residual."""
        return 0.0 if self.best_fit else self.coordinates.excess(self.u)

    @property
    def smallest_part(self) -> float:
        """Smallest eigenvalue of S over all bodies, 1 at the prior."""
        return float(self.coordinates.smallest_eigenvalues(self.u).min())

    def estimate(self, noise: Array, iterations: int, settings: Mapping[str, float], *remarks: str) -> Estimate:
        """The estimate, with a remark on the constraints.

        If the base parameters equal those of weighted least squares, so does the covariance. Otherwise there is none:
        the constraints or the prior bias the estimate and reduce its scatter.
        """
        if self.best_fit:
            told = (
                "consistent parameters are among the best fits: base parameters and their covariance are those of WLS"
            )
        else:
            told = (
                f"no best fit is consistent, or the prior counts: {self.excess:.4g} variances of one residual above WLS"
            )
        return Estimate(
            parameters=self.parameters,
            covariance=self.coordinates.base_covariance if self.best_fit else None,
            noise=noise,
            iterations=iterations,
            settings={**settings, "smallest part of prior": self.smallest_part, "excess": self.excess},
            remarks=(*remarks, told),
        )


@dataclass(frozen=True, eq=False)
class ConicFit(ConsistentFit):
    """A fit by the cone solver.

    suboptimality: bound on the cost above the minimum; 0 among the best fits
    answer: of the solver
    """

    suboptimality: float
    answer: ConicAnswer

    def told(self, noise: Array, settings: Mapping[str, float], *remarks: str) -> Estimate:
        """The estimate, with a remark on a solver status other than OPTIMAL."""
        answer = self.answer
        if answer.status != OPTIMAL:
            remarks += (
                f"Clarabel stopped with '{answer.status}'; the answer passed the checks: its cost "
                f"{answer.objective:.4g} is at most {self.suboptimality:.1g} above the minimum, every body keeps "
                f"{self.smallest_part:.1g} of its prior",
            )
        return self.estimate(noise, answer.iterations, settings, *remarks)


class ConsistentProblem:
    """min ‖A u - b‖² over physically consistent bodies, for one or many strengths.

    metric: distance from the prior
    inequalities: of x; see limits.inequalities
    margin: see PRIOR_MARGIN
    """

    def __init__(
        self, coordinates: PriorCoordinates, inequalities: Inequalities, *, metric: Metric, margin: float = PRIOR_MARGIN
    ):
        self._coordinates, self._names = coordinates, inequalities.names
        self._metric, self._margin = metric, margin
        g = inequalities.matrix @ coordinates.to_parameters
        size = np.maximum(np.linalg.norm(g, axis=1), np.abs(inequalities.right))
        self._g, self._h = g / size[:, None], inequalities.right / size
        self._programs: dict[Metric, SemidefiniteProgram] = {}
        self._last = coordinates.origin, np.zeros(len(self._h))  # where Newton's method begins

    def solve(self, strength: float = 0.0) -> ConicFit:
        """Fit with this strength of the prior.

        Raises EstimationFailed if no bodies keep the limits, which it names, or if no solution passes the checks.
        """
        if strength == 0:
            return self._best_fit() or self._whole(WEAK_STRENGTH, "pullback")
        return self._whole(strength, self._metric)

    def _best_fit(self) -> ConicFit | None:
        """The consistent best fit nearest to the prior, None if there is none."""
        c = self._coordinates
        found = None
        for metric in dict.fromkeys(("pullback", self._metric)):  # the quadratic one is sure to see infeasibility
            program = SemidefiniteProgram(c, (self._g, self._h), metric=metric, margin=self._margin, on_best_fits=True)
            answer = program.solve(1.0)
            if answer.u is None or self._violations(answer.u):
                break
            found = ConicFit(c, answer.u, True, 0.0, answer)
        return found

    def _whole(self, strength: float, metric: Metric) -> ConicFit:
        cost = Cost(self._coordinates, metric, strength)
        if strength > WEAK_STRENGTH and (found := self._by_newton(cost)):
            return found
        if metric not in self._programs:
            self._programs[metric] = SemidefiniteProgram(
                self._coordinates, (self._g, self._h), metric=metric, margin=self._margin
            )
        refused, size = "", max(1.0, float(np.linalg.norm(self._coordinates.right)))
        # in variances of the residuals; or, if limits cost millions of them, in more, up to the squares of all torques
        for unit in (1.0, size, size**2):
            answer = self._programs[metric].solve(strength, unit)
            if answer.status == INFEASIBLE:
                raise EstimationFailed(self._contradiction())
            if answer.u is None:
                refused = refused or f"Clarabel gives no answer: {answer.status}"
                continue
            fit, problems = self._polished(cost, answer)
            if not problems:
                return fit
            refused = refused or f"Clarabel's answer ({answer.status}) is not good enough: {'; '.join(problems)}"
        raise EstimationFailed(refused)

    def _polished(self, cost: Cost, answer: ConicAnswer) -> tuple[ConicFit, tuple[str, ...]]:
        """The fit after fast steps from an answer of the solver, and what is wrong with it."""
        assert answer.u is not None
        u, multipliers = polished(cost, answer.u, answer.multipliers, (self._g, self._h), self._margin)
        above = suboptimality(cost, u, self._g, self._h, multipliers, self._margin)
        problems = self._violations(u)
        if not above <= MAX_COST_EXCESS * max(1.0, answer.objective):
            problems += (f"its cost {answer.objective:.4g} may be {above:.2g} above the minimum",)
        return ConicFit(self._coordinates, u, False, above, answer), problems

    def _by_newton(self, cost: Cost) -> ConicFit | None:
        """The minimum from the last one, at first from the prior; None if Newton's method does not find it."""
        u, multipliers = polished(cost, *self._last, (self._g, self._h), self._margin)
        above, value = suboptimality(cost, u, self._g, self._h, multipliers, self._margin), cost.value(u)
        if self._violations(u) or not above <= MAX_COST_EXCESS * max(1.0, value):
            return None
        self._last = u, multipliers
        return ConicFit(self._coordinates, u, False, above, ConicAnswer(u, multipliers, OPTIMAL, value, 1))

    def _violations(self, u: Array) -> tuple[str, ...]:
        low = self._coordinates.smallest_eigenvalues(u)
        said = [
            f"body {i + 1} has eigenvalue {low[i]:.2g}"
            for i in np.flatnonzero(~(low >= MIN_MARGIN_SHARE * self._margin))
        ]
        short = self._h - self._g @ u
        size = np.maximum(1.0, np.abs(self._g) @ np.abs(u))
        return (*said, *(f"{self._names[k]} is violated" for k in np.flatnonzero(short > VIOLATION_TOLERANCE * size)))

    def _contradiction(self) -> str:
        """The limits that no bodies can keep, found from the amount by which each has to be relaxed."""
        short = least_violations(self._coordinates, (self._g, self._h), self._margin)
        broken = [name for name, value in zip(self._names, short, strict=True) if value > VIOLATION_TOLERANCE]
        return (
            f"no bodies with at least {self._margin:g} of the prior inertia keep all limits; "
            f"relax {' or '.join(broken) if broken else 'the limits'}"
        )
