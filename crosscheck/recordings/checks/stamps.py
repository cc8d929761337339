"""The time of the rows: stamps since 1970 are counted from the first row before they become doubles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crosscheck.recordings.checks.values import TIME
from crosscheck.recordings.mapping.conversion import RecordedColumn
from crosscheck.recordings.table import LARGEST_EXACT
from graphdyn.layout import Array

LARGEST_TIME = LARGEST_EXACT * 1e-9
"""Time beyond which doubles do not hold nanoseconds, 104 days [s]."""


class Origin(NamedTuple):
    """The stamp at t = 0, in numbers of its column: start + first; seconds: the same [s]."""

    start: int = 0
    first: float = 0.0
    seconds: float = 0.0


def times(columns: Sequence[RecordedColumn], factor: float, origin: Origin | None = None) -> tuple[Array, Origin]:
    """Time of the rows since the origin (N,) [s], and the origin: found unless given.

    columns: the stamps; or seconds, and nanoseconds to be added. factor: seconds per number of the first one
    """
    column = columns[0]
    factor = column.table.seconds.get(column.number, factor)
    values, start = column.table.values[:, column.number], column.table.starts.get(column.number, 0)
    origin = origin or _origin(values, start, factor)
    t = (values - origin.first + (start - origin.start)) * factor
    return np.asarray(t + columns[1].values * 1e-9 if len(columns) > 1 else t), origin


def _origin(values: Array, start: int, factor: float) -> Origin:
    """The first plausible stamp if it is beyond LARGEST_TIME, or beyond what doubles hold; else zero."""
    seconds = (start + values) * factor
    plausible = np.flatnonzero(np.abs(seconds) <= TIME.value)
    if not plausible.size or (abs(seconds[plausible[0]]) <= LARGEST_TIME and not start):
        return Origin()
    return Origin(start, float(values[plausible[0]]), float(seconds[plausible[0]]))
