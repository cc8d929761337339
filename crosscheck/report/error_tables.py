"""Errors and their bounds, as several reports show them: numbers, verdicts, distributions, courses over states."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from crosscheck.report.pictures.spread import SpreadRow, spread
from crosscheck.report.report import Panel, Picture, Plot, Series, Verdict
from graphdyn.layout import Array

ERROR_FORMAT: dict[str, Any] = {"kind": "number", "form": ".1e"}
"""Format of a column of errors or bounds."""

SPREAD_NOTE = (
    "All states; heights are relative to the fullest bin of the row. The upright line is the bound, ▲ the largest "
    "error; errors that are exactly zero stand at 0."
)


def error_text(x: float) -> str:
    """An error with two digits."""
    return f"{x:.1e}" if math.isfinite(x) else "∞"


def span_text(pair: tuple[float, float]) -> str:
    """Smallest and largest, once where they are equal."""
    low, high = (f"{x:.3g}" if math.isfinite(x) else "∞" for x in pair)
    return low if low == high else f"{low} … {high}"


def verdict_of(agrees: bool, decided: bool = True, reason: str = "") -> Verdict:
    """decided: the reference implementations agree among themselves"""
    if not decided:
        return Verdict("undecided", "UNDECIDED", reason)
    return Verdict("agrees", "agrees", reason) if agrees else Verdict("disagrees", "DISAGREES", reason)


def distribution(rows: Sequence[SpreadRow]) -> Picture:
    """How the errors of every row are distributed over the states."""
    return Picture(partial(spread, rows=rows), SPREAD_NOTE, title="How the errors are distributed", on=("page",))


def over_states(
    errors: Mapping[str, Array], bound: float, panel: str, x_title: str, caption: str, switched_on: int | None = None
) -> tuple[Plot, ...]:
    """Errors by name, each of any number of states (N,); nothing where none can be drawn on a logarithmic axis.

    switched_on: number of curves shown before a reader asks for the others, None for all
    """
    drawn = {name: np.where(np.isinf(values), np.nan, values) for name, values in errors.items()}
    if not any((values > 0).any() for values in drawn.values()):
        return ()
    longest = max(map(len, drawn.values()))
    series = tuple(
        Series(
            name,
            np.pad(values, (0, longest - len(values)), constant_values=np.nan),
            color=k,
            hidden=switched_on is not None and k >= switched_on,
        )
        for k, (name, values) in enumerate(drawn.items())
    )
    return (
        Plot(
            np.arange(1.0, longest + 1),
            x_title,
            (Panel(panel, series, log=True, level=bound),),
            f"{panel} over the states: {', '.join(drawn)}",
            f"{caption} The broken line is the bound. Errors that are zero or infinite are not drawn.",
            title="Errors over the states",
            on=("page",),
        ),
    )
