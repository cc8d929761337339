"""The unknown bodies of a torque model: their prior, their reach, and the limits that make them plausible."""

from graphdyn.identification.bodies.limits import BodyLimits, PhysicalLimits, ReachedLimit

__all__ = ["BodyLimits", "PhysicalLimits", "ReachedLimit"]
