"""Checks of a recording: cells, values, channels and time stamps. A check returns its findings and changes nothing.

A number beyond the limits of values comes from a corrupted line, not from a joint. The limits are generous on purpose,
by a factor of ten or more: they separate 1e157 from a measurement, not good robots from bad ones. Time is counted from
the first row, and checked for order, gaps, missing samples and jitter.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.errors import RecordingFinding, quoted
from crosscheck.recordings.mapping.conversion import RecordedColumn
from crosscheck.recordings.mapping.units import TIME_UNITS
from crosscheck.recordings.table import MAX_EXACT_INTEGER
from graphdyn.layout import Array


class Limit(NamedTuple):
    value: float
    why: str


TIME_LIMIT = Limit(1e10, "300 years after 1970")

TURNING_LIMITS = {
    "q": Limit(1e4, "1600 turns in one direction"),
    "v": Limit(1e3, "ten times the fastest direct drive, 9500 turns a minute behind the gears"),
    "a": Limit(1e6, "standstill to 1000 rad/s in a millisecond"),
    "tau": Limit(1e6, "ten times what the main axes of the largest industrial arms hold"),
    "temperature": Limit(1e3, "copper melts"),
}
SLIDING_LIMITS = {
    "q": Limit(1e3, "a kilometer of rail"),
    "v": Limit(1e2, "ten times the fastest linear axis"),
    "a": Limit(1e5, "ten thousand times gravity"),
    "tau": Limit(1e7, "the weight of a thousand tonnes"),
    "temperature": TURNING_LIMITS["temperature"],
}

MAX_RADIANS = 40.0
"""Position beyond which an angle may be in degrees [rad]: few joints turn more than six times."""


MIN_SATURATED_ROWS = 5
"""Consecutive rows at exactly the largest or smallest torque that count as saturation: noise would change them."""

TRAVEL_TOLERANCE = 0.1
"""Allowed relative error of the distance traveled by v against that by q; wrong units or joints give far more."""
MIN_TRAVEL, N_WINDOWS = 0.05, 20
"""Distance traveled below which v and q are not compared [rad or m]; number of intervals in which they are."""


Findings = Iterator[RecordingFinding]


def cell_findings(columns: Iterable[RecordedColumn], sound: NDArray[np.bool_]) -> Findings:
    """Findings on cells that are not finite numbers, in sound rows (N,): those whose line is not wholly malformed."""
    for column in columns:
        rows = tuple(np.flatnonzero(sound & ~np.isfinite(column.values)).tolist())
        if rows:
            text = column.table.texts.get(column.number, {}).get(rows[0])
            cell = quoted(text) if text else "an empty cell" if text == "" else str(column.values[rows[0]])
            message = f"{cell} {'is not a finite number' if len(rows) == 1 else 'and others are not finite numbers'}"
            yield _of(column, "not-a-number", "error", rows, message, "repair the rows, or drop them")


def value_findings(
    file: str, joints: Iterable[str], slides: Iterable[bool], channels: Mapping[str, Array], lines: int | None
) -> Findings:
    """Findings on joint coordinates beyond a robot's reach, and on positions that look like degrees."""
    for j, (joint, sliding) in enumerate(zip(joints, slides, strict=True)):
        for name, values in channels.items():
            limit = (SLIDING_LIMITS if sliding else TURNING_LIMITS)[name]
            size = np.abs(values[:, j])
            rows = tuple(np.flatnonzero((size > limit.value) & np.isfinite(size)).tolist())
            if rows:
                largest = size[list(rows)].max()
                message = f"|{name}| of {joint!r} up to {largest:.3g}, beyond {limit.value:g} ({limit.why})"
                remedy = "check units and gains; drop the rows if lines of the file are broken"
                yield RecordingFinding("implausible-value", "error", file, None, rows, message, remedy, lines)
            sane = size[size <= limit.value]
            if name == "q" and not sliding and sane.size and sane.max() > MAX_RADIANS:
                message = f"q of {joint!r} reaches {sane.max():.4g} rad"
                remedy = "if these are degrees, or motor angles in front of the gears, say so in a mapping"
                yield RecordingFinding("many-turns", "warning", file, None, (), message, remedy)


def channel_findings(columns: Iterable[RecordedColumn], sound: NDArray[np.bool_]) -> Findings:
    """Findings on constant channels, and on torques held at their limits, among the sound rows."""
    rows = np.flatnonzero(sound)
    for column in columns:
        values = column.values[sound]
        if column.quantity == "time" or len(values) < 2:
            continue
        if not values.any():
            message, remedy = "zero in all rows", "leave the channel out of the mapping if it was not measured"
            yield _of(column, "all-zero-channel", "warning", (), message, remedy)
        elif np.ptp(values) == 0:
            message, remedy = f"{values[0]:g} in all rows", "its joint is not excited, or its sensor is stuck"
            yield _of(column, "constant-channel", "warning", (), message, remedy)
        elif column.quantity == "tau":
            held = _held(values, values.max()) | _held(values, values.min())
            if held.any():
                at = ", ".join(f"{value:g}" for value in np.unique(values[held]))
                message = f"held at {at}, the end of its range, for {MIN_SATURATED_ROWS} rows or more"
                remedy = "the drive or the sensor is saturated; drop the rows, or record slower motion"
                yield _of(column, "saturation", "warning", tuple(rows[held].tolist()), message, remedy)


def motion_findings(
    file: str, joints: Iterable[str], t: Array, block: NDArray[np.intp], q: Array, v: Array
) -> Findings:
    """Findings on velocities that do not fit the positions: other units, signs or joints. block: of each row (N,)"""
    inside = np.diff(block) == 0
    steps = np.diff(t)[inside, None]
    edges = np.unique(np.linspace(0, max(len(steps) - 1, 0), N_WINDOWS, dtype=int))
    if not len(steps):
        return
    from_q = np.add.reduceat(np.diff(q, axis=0)[inside], edges)
    from_v = np.add.reduceat((v[1:] + v[:-1])[inside] / 2 * steps, edges)
    for j, joint in enumerate(joints):
        way = float(np.linalg.norm(from_q[:, j]))
        error = float(np.linalg.norm(from_v[:, j] - from_q[:, j]))
        if max(way, float(np.linalg.norm(from_v[:, j]))) > MIN_TRAVEL and error > TRAVEL_TOLERANCE * way:
            message = f"v of {joint!r} is not the rate of its q: its integral is off by {error / (way or 1):.0%}"
            remedy = "check units, signs and order of the columns, or leave v out of the mapping and derive it"
            yield RecordingFinding("velocity-mismatch", "warning", file, None, (), message, remedy)


def _held(values: Array, limit: float) -> NDArray[np.bool_]:
    """Rows in runs of at least MIN_SATURATED_ROWS rows with exactly this value."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], values == limit, [0]]).astype(int)))
    held = np.zeros(len(values), dtype=bool)
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        held[start:stop] = stop - start >= MIN_SATURATED_ROWS
    return held


def _of(
    column: RecordedColumn, code: str, severity: str, rows: tuple[int, ...], message: str, remedy: str
) -> RecordingFinding:
    table = column.table
    return RecordingFinding(code, severity, str(table.path), column.name, rows, message, remedy, table.lines)  # type: ignore[arg-type]


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


def stamp_findings(file: str, t: Array, sound: NDArray[np.bool_], lines: int | None, origin: float = 0.0) -> Findings:
    """Findings on stamps that do not increase, or are too large for any clock, among the sound rows (N,).

    origin: the stamp at t = 0 [s]
    """

    def found(code: str, where: NDArray[np.bool_], message: str, remedy: str) -> Findings:
        if where.any():
            rows = tuple(np.flatnonzero(where).tolist())
            yield RecordingFinding(code, "error", file, None, rows, message, remedy, lines)

    stamps = t + origin
    wild = sound & (np.abs(stamps) > TIME_LIMIT.value)
    remedy = "check the unit of time; drop the rows if lines of the file are broken"
    units = [unit for unit in ("ms", "us", "ns") if wild.any() and _recent(stamps[wild] * TIME_UNITS[unit])]
    if units:
        unit = units[0]
        remedy = f"as {unit} they are dates of this century: say so in the column's name (time_{unit}) or mapping"
    yield from found("implausible-value", wild, f"time beyond {TIME_LIMIT.value:g} s ({TIME_LIMIT.why})", remedy)
    rows = np.flatnonzero(sound & ~wild)
    if rows.size:
        kept = increasing(t[rows])
        out = np.zeros(len(t), dtype=bool)
        out[rows[~kept]] = True
        repeated = out & np.isin(t, t[rows[kept]])
        yield from found("repeated-stamp", repeated, "a repeated stamp", "drop the rows: the first of each stays")
        message, remedy = "a stamp out of order", "drop the rows, or split the file where its clock was set back"
        yield from found("backward-stamp", out & ~repeated, message, remedy)


def _recent(seconds: Array) -> bool:
    return bool(np.all((seconds > PLAUSIBLE_TIMES[0]) & (seconds < PLAUSIBLE_TIMES[1])))


def step_findings(file: str, t: Array, rows: NDArray[np.intp], rate: float | None, lines: int | None) -> Findings:
    """Findings on gaps, missing samples and jitter of increasing stamps (N,); rows: their rows in the file."""
    if len(t) < 3:
        return
    steps = np.diff(t)
    period = float(np.median(steps))

    def found(code: str, where: NDArray[np.bool_], message: str, remedy: str) -> Findings:
        if where.any():
            before = tuple(rows[1:][where].tolist())
            yield RecordingFinding(code, "warning", file, None, before, message, remedy, lines)

    gap = steps > MIN_GAP_PERIODS * period
    message = f"a gap before it, up to {steps.max():.4g} s, where the period is {period:.4g} s"
    yield from found("gap", gap, message, "the recording is divided there into blocks")
    missing = (steps > MIN_MISSING_PERIODS * period) & ~gap & (np.diff(rows) == 1)  # others are faulty rows
    yield from found("missing-samples", missing, "samples are missing before it", "resampling interpolates there")
    uneven = (np.abs(steps - period) > MIN_JITTER * period) & (steps <= MIN_MISSING_PERIODS * period)
    worst = np.abs(steps[uneven] - period).max() / period if uneven.any() else 0.0
    message = f"steps differ from the period of {period:.4g} s by up to {worst:.0%}"
    remedy = "resampling makes them even; if only the stamps jitter, give a rate instead"
    yield from found("jitter", uneven, message, remedy)
    if rate is not None and abs(rate * period - 1) > RATE_MISMATCH:
        message = f"the rate of the stamps is {1 / period:.5g} Hz, that of the mapping {rate:.5g} Hz"
        remedy = "the stamps are used; correct the rate"
        yield RecordingFinding("other-rate", "warning", file, None, (), message, remedy)


def blocks_of(t: Array) -> NDArray[np.intp]:
    """The block number (N,) of each of the increasing stamps."""
    steps = np.diff(t)
    period = np.median(steps) if steps.size else np.inf
    return np.concatenate([[0], np.cumsum(steps > MIN_GAP_PERIODS * period)]).astype(np.intp)
