"""Fitted numbers: which of them are round, and so a step of a code rather than a value."""

from __future__ import annotations

import numpy as np

ROUND = 1e-6
"""Relative distance from a round number within which a fitted factor is that number."""


def rounded(x: float) -> float:
    """The integer or power of ten next to x, or x."""
    x = float(x)
    if abs(x - round(x)) < ROUND * max(1.0, abs(x)):
        return float(round(x))
    power = np.log10(abs(x))
    return float(np.sign(x) * 10.0 ** round(power)) if abs(power - round(power)) < ROUND else x


def is_round(x: float) -> bool:
    """0, ±1, ±2, powers of ten."""
    return x in (0.0, 1.0, -1.0, 2.0) or (x != 0 and float(np.log10(abs(x))).is_integer())
