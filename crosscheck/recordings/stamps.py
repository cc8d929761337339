"""The time of the rows: stamps since 1970 are counted from the first row before they become doubles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crosscheck.recordings.cells import LARGEST_EXACT
from crosscheck.recordings.limits import TIME
from crosscheck.recordings.table import RecordedTable
from graphdyn.layout import Array

LARGEST_TIME = LARGEST_EXACT * 1e-9
"""Time beyond which doubles do not hold nanoseconds, 104 days [s]."""


class Origin(NamedTuple):
    """The stamp at t = 0, in numbers of its column: start + first; seconds: the same [s]."""

    start: int = 0
    first: float = 0.0
    seconds: float = 0.0


def origin_of(table: RecordedTable, number: int, factor: float) -> Origin:
    """The first plausible stamp of a column if it is beyond LARGEST_TIME, else zero. factor: seconds per number."""
    factor = table.seconds.get(number, factor)
    start, values = table.starts.get(number, 0), table.values[:, number]
    seconds = (start + values) * factor
    plausible = np.flatnonzero(np.abs(seconds) <= TIME.value)
    if not plausible.size or abs(seconds[plausible[0]]) <= LARGEST_TIME:
        return Origin()
    return Origin(start, float(values[plausible[0]]), float(seconds[plausible[0]]))


def times(table: RecordedTable, number: int, factor: float, origin: Origin) -> Array:
    """Time of the rows since the origin (N,) [s]."""
    values = table.values[:, number] - origin.first
    return np.asarray((values + (table.starts.get(number, 0) - origin.start)) * table.seconds.get(number, factor))
