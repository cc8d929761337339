"""Times, and how many times as long something takes, as text."""

from __future__ import annotations

UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


ROUNDED = 0.9995
"""Part of a unit from which three digits are those of one whole unit: 1 s, not 1e+03 ms."""


def time_text(seconds: float) -> str:
    """With three digits and a unit."""
    size, unit = _unit_for(seconds)
    return f"{seconds / size:.3g} {unit}"


def span_text(spread: tuple[float, float]) -> str:
    """Both in the unit of the larger one."""
    size, unit = _unit_for(spread[1])
    low, high = (f"{x / size:.3g}" for x in spread)
    return f"{low} … {high} {unit}"


def ratio_text(ratio: float) -> str:
    return f"{ratio:.3g}×" if ratio < 999.5 else f"{ratio:.0f}×"


def ratio_span_text(spread: tuple[float, float]) -> str:
    low, high = map(ratio_text, spread)
    return f"{low[:-1]} … {high}"


def threads_text(count: int) -> str:
    return f"{count} thread{'' if count == 1 else 's'}"


def _unit_for(seconds: float) -> tuple[float, str]:
    return next(((size, unit) for size, unit in UNITS if seconds >= ROUNDED * size), UNITS[-1])
