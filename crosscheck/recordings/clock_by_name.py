"""The column of the time, or the two columns of a ROS stamp, by their names."""

from __future__ import annotations

from crosscheck.recordings.column_families import Family, Named, known_unit_of
from crosscheck.recordings.column_names import NANOSECONDS_PART, RECEIVED, SECONDS_PART
from crosscheck.recordings.errors import AmbiguousColumns, BadMapping
from crosscheck.recordings.findings import RecordingFinding, noted
from crosscheck.recordings.mapping import TimeColumn
from crosscheck.recordings.table import RecordedTable, in_words


def clocks(
    table: RecordedTable, found: dict[str, dict[str, Family]], findings: list[RecordingFinding]
) -> dict[str, Family]:
    """The candidates for the time, without those of other messages than the positions, and without stamps never set.

    Beside the stamps of the positions' message, PlotJuggler's own time is not one.
    """
    candidates = {family: columns[""] for family, columns in found["time"].items()}
    paths = [column.path for family in found["q"].values() for column in family.values()]
    of_positions = (paths[0] if paths else None) or ""
    own = {
        name: clock for name, clock in candidates.items() if clock.path is None or of_positions.startswith(clock.path)
    }
    candidates = own or candidates
    running = {name: clock for name, clock in candidates.items() if table.values[:, clock.number - 1].any()}
    candidates = running or candidates
    stamps = {name: clock for name, clock in candidates.items() if clock.path is not None}
    if len(stamps) == 1 and set(candidates) - set(stamps) == {RECEIVED}:
        message = f"two clocks: {in_words(candidates)}"
        findings.append(noted(str(table.path), "two-clocks", message, f"{in_words(stamps)} is taken"))
        candidates = stamps
    return {name: {"": clock} for name, clock in candidates.items()}


def time_column(
    table: RecordedTable, families: dict[str, Family], rate: float | None, findings: list[RecordingFinding]
) -> TimeColumn | None:
    """The column of the time; None where the rate is given instead. Raises BadMapping, AmbiguousColumns."""
    where = str(table.path)
    if "time" not in families:
        parts = _two_parts(table)
        if parts:
            families["time"] = {part.name: part for part in parts}
            return TimeColumn(parts[0].number, nanoseconds=parts[1].number)
        if rate is None:
            raise BadMapping(f"{where}: no column of time (t, time_s, stamp, …); give the rate, or a mapping")
        return None
    column = families["time"][""]
    if not column.unit and column.number - 1 not in table.seconds and not table.in_si:
        message = f"time in a column without unit ({in_words([column.name])})"
        findings.append(noted(where, "assumed-unit", message, "s is assumed; give the unit in the header"))
    return TimeColumn(column.number, known_unit_of(where, "time", column).factor)


def _two_parts(table: RecordedTable) -> tuple[Named, Named] | None:
    """The columns of seconds and of nanoseconds, where there is one pair. Raises AmbiguousColumns for several."""
    found = []
    for number, name in enumerate(table.names, start=1):
        part = SECONDS_PART.fullmatch(name)
        for other, beside in enumerate(table.names, start=1):
            if part and beside.startswith(part[1]) and NANOSECONDS_PART.fullmatch(beside[len(part[1]) :]):
                found.append((Named(number, name, "s", part[1]), Named(other, beside, "ns", part[1])))
    if len(found) > 1:
        listed = "; ".join(in_words(column.name for column in pair) for pair in found)
        raise AmbiguousColumns(
            f"{table.path}: {len(found)} candidates for time: {listed}; say in a mapping (docs/recordings.md) which"
        )
    return found[0] if found else None
