"""The convex program of an identification problem: its bodies, their limits, and the choice of a strength."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

from graphdyn.identification.algebra.compressed import CompressedEquations
from graphdyn.identification.bodies.inequalities import Inequalities, inequalities
from graphdyn.identification.bodies.limits import BodyLimits, PhysicalLimits
from graphdyn.identification.bodies.unknown_bodies import Bodies, unknown_bodies
from graphdyn.identification.consistent.coordinates import PriorCoordinates, prior_coordinates
from graphdyn.identification.consistent.fit import PRIOR_MARGIN, ConsistentProblem
from graphdyn.identification.consistent.polishing import Metric
from graphdyn.identification.estimation.cross_validation import Trained, cross_validation
from graphdyn.identification.problem.prior import Prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class ConsistentProgram:
    """The convex program of a problem, for all of its equations or for some folds of them.

    metric: distance from the prior; prior: the model's parameters if left out
    margin, limits: as in ConsistentLeastSquares
    """

    problem: Problem
    prior: Prior | None
    metric: Metric
    margin: float = PRIOR_MARGIN
    limits: PhysicalLimits = field(default_factory=PhysicalLimits)

    @cached_property
    def bodies(self) -> Bodies:
        return unknown_bodies(self.problem.torque_model, self.prior)

    @cached_property
    def body_limits(self) -> BodyLimits:
        return self.limits.of(self.bodies)

    @cached_property
    def inequalities(self) -> Inequalities:
        names = [column.name for column in self.problem.torque_model.columns]
        return inequalities(self.body_limits, self.bodies, names)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was changed in the prior, and which limits CAD does not give."""
        return self.bodies.remarks + self.body_limits.remarks

    def coordinates(self, equations: CompressedEquations, noise: Array) -> PriorCoordinates:
        """The equations, weighted by the noise σ_g (n,), in coordinates in which the prior is the unit matrix."""
        informed = equations.informed(noise)
        return prior_coordinates(self.problem.base, *informed, self.bodies.prior, self.bodies.columns)

    def convex(self, equations: CompressedEquations, noise: Array) -> ConsistentProblem:
        """The program, to be solved with one or many strengths."""
        coordinates = self.coordinates(equations, noise)
        return ConsistentProblem(coordinates, self.inequalities, metric=self.metric, margin=self.margin)

    def strength(
        self, given: float | None, tried: Sequence[float], noise: Array, folds: Sequence[CompressedEquations]
    ) -> tuple[float, tuple[str, ...]]:
        """The given strength of the prior, or that of cross-validation over the folds, with remarks on the choice."""
        if given is not None:
            return given, ()

        def trained(equations: CompressedEquations) -> Trained:
            program = self.convex(equations, noise)
            return lambda strength: program.solve(strength).parameters

        choice = cross_validation(self.problem, noise, tried, trained, folds=folds)
        return choice.best, choice.remarks
