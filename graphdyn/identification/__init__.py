"""Inertial parameters from data."""

from graphdyn.identification.base_parameters import BaseParameters, base_parameters
from graphdyn.identification.least_squares import LeastSquares, ordinary_least_squares

__all__ = ["BaseParameters", "LeastSquares", "base_parameters", "ordinary_least_squares"]
