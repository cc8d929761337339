"""Estimators, one per file. Each says where it comes from, what it assumes and what it needs."""

from graphdyn.identification.estimators.ordinary import OrdinaryLeastSquares
from graphdyn.identification.estimators.weighted import WeightedLeastSquares

__all__ = ["OrdinaryLeastSquares", "WeightedLeastSquares"]
