"""Scalars that record the operations on them, small vectors of such scalars, and their automatic differentiation."""

from graphdyn.scalars.expressions import Program, Recorder

__all__ = ["Program", "Recorder"]
