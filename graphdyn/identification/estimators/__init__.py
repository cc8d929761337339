"""Estimators, one per file. Each states its reference, its assumptions and its needs."""

from graphdyn.identification.estimators.consistent import ConsistentLeastSquares
from graphdyn.identification.estimators.consistent_prior import ConsistentWithPrior
from graphdyn.identification.estimators.direct_inverse import DirectInverse
from graphdyn.identification.estimators.essential import EssentialParameters
from graphdyn.identification.estimators.generalized import GeneralizedLeastSquares
from graphdyn.identification.estimators.instrumental import InstrumentalVariables
from graphdyn.identification.estimators.log_cholesky import LogCholesky
from graphdyn.identification.estimators.maximum_likelihood import MaximumLikelihood
from graphdyn.identification.estimators.ordinary import OrdinaryLeastSquares
from graphdyn.identification.estimators.output_error import ClosedLoopOutputError
from graphdyn.identification.estimators.reweighted import ReweightedLeastSquares
from graphdyn.identification.estimators.ridge import Ridge
from graphdyn.identification.estimators.robust_consistent import RobustConsistent
from graphdyn.identification.estimators.total import TotalLeastSquares
from graphdyn.identification.estimators.weighted import WeightedLeastSquares

__all__ = [
    "ClosedLoopOutputError",
    "ConsistentLeastSquares",
    "ConsistentWithPrior",
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
]
