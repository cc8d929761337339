"""How far graphdyn, Pinocchio and MuJoCo are from exact values, quantity by quantity."""

from crosscheck.comparing.accuracy.measuring import COMPILED_FROM, true_errors
from crosscheck.comparing.accuracy.results import (
    PINOCCHIO,
    CodeErrors,
    ErrorRatio,
    QuantityErrors,
    TrueErrors,
    over_robots,
)

__all__ = [
    "COMPILED_FROM",
    "PINOCCHIO",
    "CodeErrors",
    "ErrorRatio",
    "QuantityErrors",
    "TrueErrors",
    "over_robots",
    "true_errors",
]
