"""How far graphdyn, Pinocchio and MuJoCo are from exact values, quantity by quantity."""

from crosscheck.comparing.accuracy.results import (
    PINOCCHIO,
    CodeErrors,
    ErrorRatio,
    QuantityErrors,
    TrueErrors,
    over_robots,
)
from crosscheck.comparing.accuracy.true_errors import COMPILED_FROM, true_errors

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
