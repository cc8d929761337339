"""The fast forms: recursions over the bodies, written once on scalars, and the table of them."""

from graphdyn.recursions.table import ARRAYS, RECURSIONS

__all__ = ["ARRAYS", "RECURSIONS"]
