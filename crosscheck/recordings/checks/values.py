"""Checks of the numbers: cells, values, channels. Each check returns its findings and changes nothing.

A number beyond the limits of values comes from a corrupted line, not from a joint. The limits are generous on purpose,
by a factor of ten or more: they separate 1e157 from a measurement, not good robots from bad ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.errors import RecordingFinding, quoted
from crosscheck.recordings.mapping.conversion import RecordedColumn
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


def cell_findings(columns: Iterable[RecordedColumn], sound: NDArray[np.bool_]) -> list[RecordingFinding]:
    """Findings on cells that are not finite numbers, in sound rows (N,): those whose line is not malformed as a
    whole.
    """
    findings = []
    for column in columns:
        rows = tuple(np.flatnonzero(sound & ~np.isfinite(column.values)).tolist())
        if rows:
            text = column.table.texts.get(column.number, {}).get(rows[0])
            cell = quoted(text) if text else "an empty cell" if text == "" else str(column.values[rows[0]])
            message = (
                f"{cell} is not a finite number" if len(rows) == 1 else f"{cell} and others are not finite numbers"
            )
            findings.append(_of(column, "not-a-number", "error", rows, message, "repair the rows, or drop them"))
    return findings


def value_findings(
    file: str, joints: Iterable[str], slides: Iterable[bool], channels: Mapping[str, Array], lines: int | None
) -> list[RecordingFinding]:
    """Findings on joint coordinates beyond a robot's reach, and on positions that look like degrees."""
    findings = []
    for j, (joint, sliding) in enumerate(zip(joints, slides, strict=True)):
        for name, values in channels.items():
            limit = (SLIDING_LIMITS if sliding else TURNING_LIMITS)[name]
            size = np.abs(values[:, j])
            rows = tuple(np.flatnonzero((size > limit.value) & np.isfinite(size)).tolist())
            if rows:
                message = (
                    f"|{name}| of {joint!r} up to {size[list(rows)].max():.3g}, beyond {limit.value:g} ({limit.why})"
                )
                remedy = "check units and gains; drop the rows if lines of the file are broken"
                findings.append(
                    RecordingFinding("implausible-value", "error", file, None, rows, message, remedy, lines)
                )
            sane = size[size <= limit.value]
            if name == "q" and not sliding and sane.size and sane.max() > MAX_RADIANS:
                message = f"q of {joint!r} reaches {sane.max():.4g} rad"
                remedy = "if these are degrees, or motor angles in front of the gears, say so in a mapping"
                findings.append(RecordingFinding("many-turns", "warning", file, None, (), message, remedy))
    return findings


def channel_findings(columns: Iterable[RecordedColumn], sound: NDArray[np.bool_]) -> list[RecordingFinding]:
    """Findings on constant channels, and on torques held at their limits, among the sound rows."""
    findings = []
    rows = np.flatnonzero(sound)
    for column in columns:
        values = column.values[sound]
        if column.quantity == "time" or len(values) < 2:
            continue
        if not values.any():
            message, remedy = "zero in all rows", "leave the channel out of the mapping if it was not measured"
            findings.append(_of(column, "all-zero-channel", "warning", (), message, remedy))
        elif np.ptp(values) == 0:
            message, remedy = f"{values[0]:g} in all rows", "its joint is not excited, or its sensor is stuck"
            findings.append(_of(column, "constant-channel", "warning", (), message, remedy))
        elif column.quantity == "tau":
            held = _held(values, values.max()) | _held(values, values.min())
            if held.any():
                at = ", ".join(f"{value:g}" for value in np.unique(values[held]))
                message = f"held at {at}, the end of its range, for {MIN_SATURATED_ROWS} rows or more"
                remedy = "the drive or the sensor is saturated; drop the rows, or record slower motion"
                held_rows = tuple(rows[held].tolist())
                findings.append(_of(column, "saturation", "warning", held_rows, message, remedy))
    return findings


def motion_findings(
    file: str, joints: Iterable[str], t: Array, block: NDArray[np.intp], q: Array, v: Array
) -> list[RecordingFinding]:
    """Findings on velocities that do not fit the positions: other units, signs or joints.

    block: block number of each row (N,)
    """
    inside = np.diff(block) == 0
    steps = np.diff(t)[inside, None]
    edges = np.unique(np.linspace(0, max(len(steps) - 1, 0), N_WINDOWS, dtype=int))
    if not len(steps):
        return []
    from_q = np.add.reduceat(np.diff(q, axis=0)[inside], edges)
    from_v = np.add.reduceat((v[1:] + v[:-1])[inside] / 2 * steps, edges)
    findings = []
    for j, joint in enumerate(joints):
        way = float(np.linalg.norm(from_q[:, j]))
        error = float(np.linalg.norm(from_v[:, j] - from_q[:, j]))
        if max(way, float(np.linalg.norm(from_v[:, j]))) > MIN_TRAVEL and error > TRAVEL_TOLERANCE * way:
            message = f"v of {joint!r} is not the rate of its q: its integral is off by {error / (way or 1):.0%}"
            remedy = "check units, signs and order of the columns, or leave v out of the mapping and derive it"
            findings.append(RecordingFinding("velocity-mismatch", "warning", file, None, (), message, remedy))
    return findings


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
