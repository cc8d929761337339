"""The identification methods by name, also with Pinocchio's regressor instead of ours: the independent baseline."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from crosscheck.identifying.methods.wrench_method import FromWrenches
from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import (
    ClosedLoopOutputError,
    ConsistentLeastSquares,
    ConsistentWithPrior,
    DirectInverse,
    EssentialParameters,
    Estimate,
    Estimator,
    GeneralizedLeastSquares,
    InstrumentalVariables,
    LogCholesky,
    MaximumLikelihood,
    OrdinaryLeastSquares,
    Problem,
    ReweightedLeastSquares,
    Ridge,
    RobustConsistent,
    TotalLeastSquares,
    WeightedLeastSquares,
)
from graphdyn.identification.terms import RigidBodies

if TYPE_CHECKING:
    from crosscheck.reference.pinocchio_model import PinocchioModel


@dataclass(frozen=True, eq=False)
class OfEstimator:
    """A method that runs an estimator, and states what this one states."""

    estimator: Estimator

    @property
    def reference(self) -> str:
        return self.estimator.reference

    @property
    def assumptions(self) -> str:
        return self.estimator.assumptions

    @property
    def needs(self) -> str:
        return self.estimator.needs


@dataclass(frozen=True, eq=False)
class WithPinocchio(OfEstimator):
    """An estimator that runs on Pinocchio's regressor, and on ours for comparison.

    estimator: runs on both; reference: Pinocchio's reading of the robot, made from its RobotModel if left out

    The setting "difference" of its estimate compares the base parameters with those on our regressor: the largest
    difference, as the torque it causes, relative to the largest torque of a base parameter.
    """

    pinocchio: PinocchioModel | None = None

    @property
    def name(self) -> str:
        return f"{self.estimator.name}, Pinocchio's regressor"

    @property
    def reference(self) -> str:
        return f"{super().reference}; Pinocchio, computeJointTorqueRegressor"

    @property
    def needs(self) -> str:
        return f"{super().needs}; unknown rigid bodies"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed if no body is unknown."""
        from crosscheck.comparing.baseline import PinocchioBodies  # 50 MB of memory, which other methods do without
        from crosscheck.reference.pinocchio_model import PinocchioModel

        model = problem.torque_model
        if not any(isinstance(term, RigidBodies) for term in model.terms):
            raise EstimationFailed("no body is unknown, so there is no regressor of rigid bodies to exchange")
        bodies = PinocchioBodies(self.pinocchio or PinocchioModel.from_model(model.model))
        terms = [bodies if isinstance(term, RigidBodies) else term for term in model.terms]
        there = replace(problem, torque_model=replace(model, terms=terms))
        theirs, ours = self.estimator.estimate(there), self.estimator.estimate(problem)
        scale = np.linalg.norm(problem.equations.factors[..., :-1], axis=(0, 1))
        x, y = (scale * problem.base.values(estimate.parameters) for estimate in (ours, theirs))
        difference = float(np.abs(x - y).max() / np.abs(x).max())
        same = np.array_equal(there.base.independent, problem.base.independent)
        return replace(
            theirs,
            covariance=theirs.covariance if same else None,
            block_covariance=theirs.block_covariance if same else None,
            settings={**theirs.settings, "difference": difference},
            remarks=(*theirs.remarks, f"differs from {self.estimator.name} by {difference:.1e} of the torque"),
        )


ESTIMATORS: dict[str, Callable[[], Estimator]] = {
    "ols": OrdinaryLeastSquares,
    "wls": WeightedLeastSquares,
    "wls-pinocchio": lambda: WithPinocchio(WeightedLeastSquares()),
    "gls": GeneralizedLeastSquares,
    "huber": lambda: ReweightedLeastSquares("huber"),
    "tukey": lambda: ReweightedLeastSquares("tukey"),
    "ridge": Ridge,
    "essential": EssentialParameters,
    "consistent": ConsistentLeastSquares,
    "entropic": lambda: ConsistentWithPrior("entropic"),
    "pullback": lambda: ConsistentWithPrior("pullback"),
    "consistent-huber": RobustConsistent,
    "entropic-huber": lambda: RobustConsistent("entropic"),
    "pullback-huber": lambda: RobustConsistent("pullback"),
    "log-cholesky": LogCholesky,
    "graph": FromWrenches,
    "tls": TotalLeastSquares,
    "ml": MaximumLikelihood,
    "iv": InstrumentalVariables,
    "didim": DirectInverse,
    "cloe": lambda: ClosedLoopOutputError("position"),
    "clie": lambda: ClosedLoopOutputError("torque"),
}

STANDARD_METHODS = (
    *("ols", "wls", "wls-pinocchio", "gls", "huber", "ridge"),
    *("consistent", "entropic", "consistent-huber", "graph"),
)
"""The default methods, one of each kind; "all" includes the others."""

METHODS_OF_WRENCHES = ("graph",)
"""Methods that need force and moment in every joint; without them they are left out unless they are named."""


def without_wrenches(names: Iterable[str]) -> list[str]:
    """The methods that need no wrenches."""
    return [name for name in names if name not in METHODS_OF_WRENCHES]


FIXED_ESTIMATOR_FIELDS = ("name", "reference", "assumptions", "needs", "norm", "metric", "prior", "limits", "recording")
"""Fields of the estimators that are not settings of a method."""


def method_named(name: str) -> Estimator:
    """The method of this name (ESTIMATORS). Raises InvalidInput for an unknown one."""
    if name not in ESTIMATORS:
        raise InvalidInput(f"there is no method '{name}'; known: {', '.join(ESTIMATORS)}, all")
    return ESTIMATORS[name]()


def method_with(method: str, *, name: str | None = None, **settings: Any) -> Estimator:
    """A method with settings, such as the strength of a prior, so that one method can be compared with itself.

    method: as in ESTIMATORS
    name: for tables; the method's own name followed by the settings, unless given
    settings: fields of the estimator of the method

    Raises InvalidInput for a method or a setting that does not exist, and as the estimator does.
    """
    estimator: Any = method_named(method)
    known = (
        [field.name for field in fields(estimator) if field.name not in FIXED_ESTIMATOR_FIELDS]
        if is_dataclass(estimator)
        else []
    )
    for setting in settings:
        if setting not in known:
            raise InvalidInput(
                f"the method '{method}' has no setting '{setting}'; it has: {', '.join(known) or 'none'}"
            )
    if not settings and name is None:
        return method_named(method)
    said = ", ".join(f"{setting} {_short(value)}" for setting, value in settings.items())
    return Labeled(replace(estimator, **settings), name or f"{estimator.name}, {said}")


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


@dataclass(frozen=True, eq=False)
class Labeled(OfEstimator):
    """An estimator under another name."""

    name: str

    @property
    def takes_expected(self) -> bool:
        return getattr(self.estimator, "takes_expected", False)

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of the estimator."""
        return self.estimator.estimate(problem)
