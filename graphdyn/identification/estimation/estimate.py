"""The common interface of all estimators, and their common answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Estimate:
    """What an estimator answers.

    parameters: x of all columns of the torque model        (p,)
    covariance: of the base parameters of the problem (Problem.base), None where the method gives none   (r, r)
    block_covariance: the same, allowing for correlation in time within each time block
    noise: standard deviation of the torque of each joint as the method sees it, None likewise           (n,) [N m or N]
    iterations: how often the equations were solved
    settings: numbers the method chose, such as the strength of a prior
    remarks: in sentences: a solver that stopped early, a fallback
    """

    parameters: Array
    covariance: Array | None = None
    block_covariance: Array | None = None
    noise: Array | None = None
    iterations: int = 1
    settings: Mapping[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


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
    """A method of identification. Any object with these four texts and one function is one.

    name: short, for tables
    reference: where it is published
    assumptions: what has to hold for its answer to be right
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
        """Raises EstimationFailed, saying why, where there is no answer."""
        ...
