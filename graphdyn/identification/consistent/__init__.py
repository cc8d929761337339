"""Least squares over the inertias of real bodies: what the physically consistent estimators share."""

from graphdyn.identification.consistent.limits import PhysicalLimits

__all__ = ["PhysicalLimits"]
