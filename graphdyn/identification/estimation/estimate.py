"""The common interface of all estimators, and their common result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from graphdyn.display import short_repr
from graphdyn.identification.bodies.limits import BodyLimits
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class Estimate:
    """Result of an estimator.

    parameters: x of all columns of the torque model; of a method that finds base parameters alone, those that are
        nearest to the model's                              (p,)
    covariance: of the base parameters of the problem (Problem.base), None if the method gives none      (r, r)
    block_covariance: the same, allowing for correlation in time within each time block
    noise: standard deviation of the torque of each joint by this method, None likewise                  (n,) [N m or N]
    iterations: number of solutions of the equations
    settings: numbers that the method chose, such as the strength of a prior
    remarks: in sentences: a solver that stopped early, a fallback
    limits: of the bodies, that the parameters keep; None for a method without
    """

    parameters: Array
    covariance: Array | None = None
    block_covariance: Array | None = None
    noise: Array | None = None
    iterations: int = 1
    settings: Mapping[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    limits: BodyLimits | None = None


def base_estimate(
    problem: Problem,
    x: Array,
    covariance: Array,
    noise: Array | None,
    *,
    block_covariance: Array | None = None,
    iterations: int = 1,
    settings: Mapping[str, float] | None = None,
    remarks: tuple[str, ...] = (),
) -> Estimate:
    """The estimate of a method that finds base parameters x (r,) alone.

    Its standard parameters are those with these base parameters that are nearest to the model's.
    """
    parameters = model_prior(problem.torque_model).nearest(problem.base, x)
    return Estimate(parameters, covariance, block_covariance, noise, iterations, settings or {}, remarks)


class Estimator(Protocol):
    """A method of identification: any object with these four texts and this function.

    name: short, for tables
    reference: publication
    assumptions: conditions under which the result is right
    needs: what has to be measured or known
    """

    @property
    def name(self) -> str: ...
    @property
    def reference(self) -> str: ...
    @property
    def assumptions(self) -> str: ...
    @property
    def needs(self) -> str: ...

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed with the reason if there is none."""
        ...
