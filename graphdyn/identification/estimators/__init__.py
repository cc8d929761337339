"""Estimators. Each states its reference, its assumptions and its needs."""

from graphdyn.identification.estimators.closed_loop import ClosedLoopOutputError, DirectInverse, InstrumentalVariables
from graphdyn.identification.estimators.consistent import (
    ConsistentLeastSquares,
    ConsistentWithPrior,
    LogCholesky,
    RobustConsistent,
)
from graphdyn.identification.estimators.contradicted_masses import ContradictedMass, contradicted_masses
from graphdyn.identification.estimators.generalized import GeneralizedLeastSquares
from graphdyn.identification.estimators.least_squares import (
    EssentialParameters,
    OrdinaryLeastSquares,
    TotalLeastSquares,
    WeightedLeastSquares,
)
from graphdyn.identification.estimators.maximum_likelihood import MaximumLikelihood
from graphdyn.identification.estimators.reweighted import ReweightedLeastSquares
from graphdyn.identification.estimators.ridge import Ridge

__all__ = [
    "ClosedLoopOutputError",
    "ConsistentLeastSquares",
    "ConsistentWithPrior",
    "ContradictedMass",
    "DirectInverse",
    "EssentialParameters",
    "GeneralizedLeastSquares",
    "InstrumentalVariables",
    "LogCholesky",
    "MaximumLikelihood",
    "OrdinaryLeastSquares",
    "ReweightedLeastSquares",
    "Ridge",
    "RobustConsistent",
    "TotalLeastSquares",
    "WeightedLeastSquares",
    "contradicted_masses",
]
