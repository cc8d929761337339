"""Time stamps: counted from the first row, and checked for order, gaps, missing samples and jitter."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.checks.values import TIME_LIMIT
from crosscheck.recordings.errors import RecordingFinding
from crosscheck.recordings.mapping.conversion import RecordedColumn
from crosscheck.recordings.mapping.units import TIME_UNITS
from crosscheck.recordings.table import MAX_EXACT_INTEGER
from graphdyn.layout import Array

MAX_EXACT_TIME = MAX_EXACT_INTEGER * 1e-9
"""Time beyond which doubles do not hold nanoseconds, 104 days [s]."""


class Origin(NamedTuple):
    """The stamp at t = 0, in numbers of its column: start + first; seconds: the same [s]."""

    start: int = 0
    first: float = 0.0
    seconds: float = 0.0


def times(columns: Sequence[RecordedColumn], factor: float, origin: Origin | None = None) -> tuple[Array, Origin]:
    """Time of the rows since the origin (N,) [s], and the origin, which is searched unless given.

    columns: the stamps; or seconds, and nanoseconds to be added. factor: seconds per number of the first one
    """
    column = columns[0]
    factor = column.table.seconds.get(column.number, factor)
    values, start = column.table.values[:, column.number], column.table.starts.get(column.number, 0)
    origin = origin or _origin(values, start, factor)
    t = (values - origin.first + (start - origin.start)) * factor
    return np.asarray(t + columns[1].values * 1e-9 if len(columns) > 1 else t), origin


def _origin(values: Array, start: int, factor: float) -> Origin:
    """The first plausible stamp if it is beyond MAX_EXACT_TIME, or beyond what doubles hold; otherwise zero."""
    seconds = (start + values) * factor
    plausible = np.flatnonzero(np.abs(seconds) <= TIME_LIMIT.value)
    if not plausible.size or (abs(seconds[plausible[0]]) <= MAX_EXACT_TIME and not start):
        return Origin()
    return Origin(start, float(values[plausible[0]]), float(seconds[plausible[0]]))


MIN_JITTER = 0.05
"""Relative difference of a step from the sampling period from which it is reported as jitter."""

MIN_MISSING_PERIODS = 1.5
"""Number of periods from which a step has lost samples in between."""

MIN_GAP_PERIODS = 5.5
"""Number of periods from which a step divides a recording into blocks; resampling interpolates over shorter ones."""

RATE_MISMATCH = 0.01
"""Relative difference between a given rate and that of the stamps from which it is reported."""

PLAUSIBLE_TIMES = (946_684_800.0, 4_102_444_800.0)
"""Stamps of the years 2000 and 2100, since 1970 [s]."""


def increasing(t: Array) -> NDArray[np.bool_]:
    """The largest set of rows (N,) whose stamps increase: one stamp too late costs one row, not all rows after it.

    Longest increasing subsequence by patience sorting; of equal stamps the first.
    """
    if np.all(np.diff(t) > 0):
        return np.ones(len(t), dtype=bool)
    ends: list[float] = []
    last: list[int] = []
    before = np.full(len(t), -1)
    for row, stamp in enumerate(t.tolist()):
        place = bisect_left(ends, stamp)
        if place < len(ends) and ends[place] == stamp:
            continue
        before[row] = last[place - 1] if place else -1
        ends[place : place + 1] = [stamp]
        last[place : place + 1] = [row]
    kept = np.zeros(len(t), dtype=bool)
    row = last[-1]
    while row >= 0:
        kept[row] = True
        row = int(before[row])
    return kept


def stamp_findings(
    file: str, t: Array, sound: NDArray[np.bool_], lines: int | None, origin: float = 0.0
) -> list[RecordingFinding]:
    """Findings on stamps that do not increase, or are too large for any clock, among the sound rows (N,).

    origin: the stamp at t = 0 [s]
    """
    findings = []

    def found(code: str, where: NDArray[np.bool_], message: str, remedy: str) -> None:
        if where.any():
            rows = tuple(np.flatnonzero(where).tolist())
            findings.append(RecordingFinding(code, "error", file, None, rows, message, remedy, lines))

    stamps = t + origin
    wild = sound & (np.abs(stamps) > TIME_LIMIT.value)
    remedy = "check the unit of time; drop the rows if lines of the file are broken"
    units = [unit for unit in ("ms", "us", "ns") if wild.any() and _recent(stamps[wild] * TIME_UNITS[unit])]
    if units:
        remedy = (
            f"as {units[0]} they are dates of this century: say so in the column's name (time_{units[0]}) or mapping"
        )
    found("implausible-value", wild, f"time beyond {TIME_LIMIT.value:g} s ({TIME_LIMIT.why})", remedy)
    rows = np.flatnonzero(sound & ~wild)
    if rows.size:
        kept = increasing(t[rows])
        out = np.zeros(len(t), dtype=bool)
        out[rows[~kept]] = True
        repeated = out & np.isin(t, t[rows[kept]])
        found("repeated-stamp", repeated, "a repeated stamp", "drop the rows: the first of each stays")
        message, remedy = "a stamp out of order", "drop the rows, or split the file where its clock was set back"
        found("backward-stamp", out & ~repeated, message, remedy)
    return findings


def _recent(seconds: Array) -> bool:
    return bool(np.all((seconds > PLAUSIBLE_TIMES[0]) & (seconds < PLAUSIBLE_TIMES[1])))


def step_findings(
    file: str, t: Array, rows: NDArray[np.intp], rate: float | None, lines: int | None
) -> list[RecordingFinding]:
    """Findings on gaps, missing samples and jitter of increasing stamps (N,); rows: their rows in the file."""
    if len(t) < 3:
        return []
    steps = np.diff(t)
    period = float(np.median(steps))
    findings = []

    def found(code: str, where: NDArray[np.bool_], message: str, remedy: str) -> None:
        if where.any():
            before = tuple(rows[1:][where].tolist())
            findings.append(RecordingFinding(code, "warning", file, None, before, message, remedy, lines))

    longest = f"up to {steps.max():.4g} s, where the period is {period:.4g} s"
    missing = (
        (steps > MIN_MISSING_PERIODS * period) & (steps <= MIN_GAP_PERIODS * period) & (np.diff(rows) == 1)
    )  # others are faulty rows
    found(
        "gap",
        steps > MIN_GAP_PERIODS * period,
        f"a gap before it, {longest}",
        "the recording is divided there into blocks",
    )
    found("missing-samples", missing, "samples are missing before it", "resampling interpolates there")
    uneven = (np.abs(steps - period) > MIN_JITTER * period) & (steps <= MIN_MISSING_PERIODS * period)
    worst = np.abs(steps[uneven] - period).max() / period if uneven.any() else 0.0
    message = f"steps differ from the period of {period:.4g} s by up to {worst:.0%}"
    found("jitter", uneven, message, "resampling makes them even; if only the stamps jitter, give a rate instead")
    if rate is not None and abs(rate * period - 1) > RATE_MISMATCH:
        message = f"the rate of the stamps is {1 / period:.5g} Hz, that of the mapping {rate:.5g} Hz"
        findings.append(
            RecordingFinding("other-rate", "warning", file, None, (), message, "the stamps are used; correct the rate")
        )
    return findings


def blocks_of(t: Array) -> NDArray[np.intp]:
    """The block number (N,) of each of the increasing stamps."""
    steps = np.diff(t)
    period = np.median(steps) if steps.size else np.inf
    return np.concatenate([[0], np.cumsum(steps > MIN_GAP_PERIODS * period)]).astype(np.intp)
