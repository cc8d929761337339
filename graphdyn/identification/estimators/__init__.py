"""Estimators, one per file. Each says where it comes from, what it assumes and what it needs."""

from graphdyn.identification.estimators.essential import EssentialParameters
from graphdyn.identification.estimators.generalised import GeneralisedLeastSquares
from graphdyn.identification.estimators.ordinary import OrdinaryLeastSquares
from graphdyn.identification.estimators.reweighted import ReweightedLeastSquares
from graphdyn.identification.estimators.ridge import Ridge
from graphdyn.identification.estimators.weighted import WeightedLeastSquares

__all__ = [
    "EssentialParameters",
    "GeneralisedLeastSquares",
    "OrdinaryLeastSquares",
    "ReweightedLeastSquares",
    "Ridge",
    "WeightedLeastSquares",
]
