"""Least squares over physically consistent inertias: the common parts of the physically consistent estimators."""

from graphdyn.identification.consistent.limits import PhysicalLimits

__all__ = ["PhysicalLimits"]
