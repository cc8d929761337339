"""The columns of time: by their names, otherwise by their equal steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from shlex import quote

import numpy as np

from crosscheck.recordings.mapping.column_names import NANOSECONDS_PART, SECONDS_PART, meaning
from crosscheck.recordings.mapping.units import TIME_UNITS
from crosscheck.recordings.recognizing.recognized import OpenChoice, RecognizedBlock, RecognizedClock
from crosscheck.recordings.recognizing.together import alike, counts_rows, likely_units, rate_factor, steps_evenly
from crosscheck.recordings.recognizing.work import LogWork, column_of
from crosscheck.recordings.table import RecordedTable, in_words
from graphdyn import InvalidInput
from graphdyn.layout import Array

COUNTS_ROWS = "counts the rows"
"""Reason against a column that increases by one in every row."""


def clocks_of(work: LogWork) -> list[RecognizedClock]:
    """The columns of time; those that agree with the one that is taken are no choice.

    A column without a name that counts the rows may be a clock whose period is its unit; it is taken only if asked for.
    """
    found = [clock for table in work.tables for clock in _named_clocks(work, table)]
    if not found:
        found = [clock for table in work.tables for clock in _unnamed_clocks(work, table)]
        found = [replace(clock, why=COUNTS_ROWS) if counts_rows(clock.values) else clock for clock in found]
    wanted = work.untold.take.get("time")
    chosen = [
        clock for clock in found
        if (clock.why != COUNTS_ROWS if wanted is None else wanted in map(str, clock.columns))
    ]  # fmt: skip
    if wanted is not None and not chosen:
        raise InvalidInput(f"no clock has the column {wanted!r}; there are {in_words(_names(found))}")
    if not chosen:
        return found
    first = max(chosen, key=lambda clock: "stamp" in str(clock.columns[0]).lower())
    others = [clock for clock in chosen if clock is not first]
    if any(not alike(first.values, clock.values) for clock in others):
        options = tuple(f"--take {quote(f'time={clock.columns[0]}')}" for clock in chosen)
        lines = tuple(f'[time] column = "{clock.columns[0]}", unit = "{clock.unit}"' for clock in chosen)
        question = f"{len(chosen)} clocks differ: {in_words(_names(chosen))}"
        work.open.append(OpenChoice("time", question, options, lines))
        return found
    if others:
        first = replace(first, why=f"{first.why}; {in_words(_names(others))} agrees with it in every row")
    return [replace(first, taken=True), *(clock for clock in found if clock.columns != first.columns)]


def rate_choice(
    clocks: Sequence[RecognizedClock], q: RecognizedBlock | None, velocities: Sequence[RecognizedBlock]
) -> OpenChoice:
    """The choice where no column is a clock: of a counter that may be one, or of the rate that velocities suggest."""
    question, options, lines = "no column is a clock, and nothing tells the rate", ["--rate HZ"], list[str]()
    for clock in clocks:
        question = f"column {clock.columns[0]} counts the rows; it is no clock, or one in {clock.unit}"
        options.append(f"--take {quote(f'time={clock.columns[0]}')}")
        lines.append(f'[time] column = {clock.columns[0]}, unit = "{clock.unit}"')
    for block in velocities:
        factor = None if q is None else rate_factor(q.values, block.values)
        if factor is not None and factor > 0:
            lines.append(f"rate = {factor:.4g}  # if {block.label} are the rates of the positions per second")
    return OpenChoice("time", question, tuple(options), tuple(lines) or ("rate = 1000  # samples per second",))


def _named_clocks(work: LogWork, table: RecordedTable) -> Iterator[RecognizedClock]:
    for number, name in enumerate(table.names):
        said = meaning(name, work.model.independent_joints)
        part = SECONDS_PART.fullmatch(name)
        beside = [k for k, other in enumerate(table.names) if part and other.startswith(part[1])
                  and NANOSECONDS_PART.fullmatch(other[len(part[1]) :])]  # fmt: skip
        if beside:
            values = table.doubles(number) + 1e-9 * table.doubles(beside[0])
            yield from _clock(work, table, (number, beside[0]), values, "s", "seconds and nanoseconds by their names")
        elif said is not None and said.quantity == "time":
            unit = (said.unit if said else "") or ("s" if table.in_si else "")
            yield from _clock(work, table, (number,), table.values[:, number], unit, "by its name")


def _unnamed_clocks(work: LogWork, table: RecordedTable) -> Iterator[RecognizedClock]:
    for number in range(len(table.names)):
        values = table.values[:, number]
        if steps_evenly(values):
            yield from _clock(work, table, (number,), values, "", "increases by equal steps from row to row")


def _clock(
    work: LogWork, table: RecordedTable, numbers: tuple[int, ...], values: Array, unit: str, why: str
) -> Iterator[RecognizedClock]:
    """A clock, unless it stands still; the unit is that with which it has a likely rate."""
    steps = np.diff(values[np.isfinite(values)])
    period = float(np.median(steps)) if steps.size else 0.0
    if period <= 0:
        return
    if numbers[0] in table.seconds:
        size, unit = table.seconds[numbers[0]], "s"
    else:
        likely = likely_units(period)
        unit = unit or work.untold.units.get("time", "") or (likely[0] if likely else "s")
        size = TIME_UNITS.get(unit, 1.0)
    rate = 1 / (period * size)
    yield RecognizedClock(
        tuple(column_of(table, k) for k in numbers), table.path.name, unit, rate, False,
        f"{why}; a row every {period:.6g} {unit}, {rate:.6g} Hz", values,
    )  # fmt: skip


def _names(clocks: Sequence[RecognizedClock]) -> list[str]:
    return [str(clock.columns[0]) for clock in clocks]
