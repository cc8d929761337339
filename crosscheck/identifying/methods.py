"""The identification methods by name."""

from __future__ import annotations

from collections.abc import Callable

from crosscheck.identifying.pinocchio_method import WithPinocchio
from crosscheck.identifying.wrench_method import FromWrenches
from graphdyn import InvalidInput
from graphdyn.identification import (
    ConsistentLeastSquares,
    ConsistentWithPrior,
    EssentialParameters,
    Estimator,
    GeneralisedLeastSquares,
    LogCholesky,
    OrdinaryLeastSquares,
    ReweightedLeastSquares,
    Ridge,
    WeightedLeastSquares,
)

METHODS: dict[str, Callable[[], Estimator]] = {
    "ols": OrdinaryLeastSquares,
    "wls": WeightedLeastSquares,
    "wls-pinocchio": lambda: WithPinocchio(WeightedLeastSquares()),
    "gls": GeneralisedLeastSquares,
    "huber": lambda: ReweightedLeastSquares("huber"),
    "tukey": lambda: ReweightedLeastSquares("tukey"),
    "ridge": Ridge,
    "essential": EssentialParameters,
    "consistent": ConsistentLeastSquares,
    "entropic": lambda: ConsistentWithPrior("entropic"),
    "pullback": lambda: ConsistentWithPrior("pullback"),
    "log-cholesky": LogCholesky,
    "graph": FromWrenches,
}

STANDARD_METHODS = ("ols", "wls", "wls-pinocchio", "gls", "huber", "ridge", "consistent", "entropic", "graph")
"""The default methods, one of each kind; "all" has the others too."""


def method_named(name: str) -> Estimator:
    """The method of this name (METHODS). Raises InvalidInput for an unknown one."""
    if name not in METHODS:
        raise InvalidInput(f"there is no method '{name}'; known: {', '.join(METHODS)}, all")
    return METHODS[name]()
