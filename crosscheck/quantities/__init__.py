"""The table of quantities: how each is computed here and in Pinocchio, its scale, its tolerance, and the states."""

from crosscheck.quantities.quantity import LOADS, RECURSIVE, Quantity, argument_at
from crosscheck.quantities.table import (
    COMPARED,
    COUPLED,
    FUNCTIONS,
    LOOPED,
    QUANTITIES,
    ComparedQuantity,
    TabulatedQuantity,
    known_function,
)

__all__ = [
    "COMPARED",
    "COUPLED",
    "FUNCTIONS",
    "LOADS",
    "LOOPED",
    "QUANTITIES",
    "RECURSIVE",
    "ComparedQuantity",
    "Quantity",
    "TabulatedQuantity",
    "argument_at",
    "known_function",
]
