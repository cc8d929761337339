"""The mapping by the names of the columns, if they are unambiguous: time, or two parts of a ROS stamp, and channels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings.errors import AmbiguousColumns, BadMapping, RecordingFinding, noted
from crosscheck.recordings.mapping.column_names import (
    CURRENT_COLUMNS,
    NANOSECONDS_PART,
    RECEIVED_TIME_COLUMN,
    SECONDS_PART,
    Family,
    Named,
    candidates,
    known_unit_of,
    listed,
    meaning,
    only,
)
from crosscheck.recordings.mapping.current_columns import current_channel, current_columns
from crosscheck.recordings.mapping.mapping import MAPPED_QUANTITIES, SI_UNITS, Channel, ColumnMapping, TimeColumn
from crosscheck.recordings.table import RecordedTable, in_words
from graphdyn.errors import counted


def clocks(
    table: RecordedTable, found: dict[str, dict[str, Family]], findings: list[RecordingFinding]
) -> dict[str, Family]:
    """Candidates for the time column, without the stamps of other messages than the positions, and without all-zero
    stamps.

    If the positions' message has stamps, PlotJuggler's own time is not a candidate.
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
    if len(stamps) == 1 and set(candidates) - set(stamps) == {RECEIVED_TIME_COLUMN}:
        message = f"two clocks: {in_words(candidates)}"
        findings.append(noted(str(table.path), "two-clocks", message, f"{in_words(stamps)} is taken"))
        candidates = stamps
    return {name: {"": clock} for name, clock in candidates.items()}


def time_column(
    table: RecordedTable, families: dict[str, Family], rate: float | None, findings: list[RecordingFinding]
) -> TimeColumn | None:
    """The column of the time; None if the rate is given instead. Raises BadMapping, AmbiguousColumns."""
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
    """The columns of seconds and of nanoseconds, if there is one pair. Raises AmbiguousColumns for several."""
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


def mapping_by_name(
    table: RecordedTable, joints: Sequence[str] | None, rate: float | None, currents: bool = False
) -> tuple[ColumnMapping, list[RecordingFinding]]:
    """The mapping, and its assumptions. Raises AmbiguousColumns, BadMapping.

    currents: take those of the motors, where there are any, in place of torques
    """
    where = str(table.path)
    if not table.has_names:
        raise BadMapping(f"{where}: the columns have no names; give a mapping with their numbers")
    findings: list[RecordingFinding] = []
    found = candidates(table, joints)
    found["time"] = clocks(table, found, findings)
    families = only(table, found)
    _refuse_left_out(table, families)
    if "q" not in families:
        raise BadMapping(
            f"{where}: no columns of joint positions (q_1, position_1, q_<joint>, <joint>.q, …) among "
            f"{in_words(table.names)}; give a mapping"
        )
    order = _order(where, list(families["q"]), joints)
    channels = {
        name: _channel(table, name, families[name], order, findings) for name in MAPPED_QUANTITIES if name in families
    }
    motors = current_columns(table, order) if currents else None
    if motors is not None:
        channels["tau"] = current_channel(motors)
        message = f"currents as torques ({in_words(table.names[number - 1] for number in motors)})"
        findings.append(noted(where, "currents", message, "their gains are found, or given"))
    named = [name for name in table.names if CURRENT_COLUMNS.fullmatch(name)]
    if "tau" not in channels and named:
        message = f"currents instead of torques ({in_words(named)})"
        findings.append(noted(where, "current-without-gain", message, "give their gains in a mapping"))
    time = time_column(table, families, rate, findings)
    names = tuple(f"joint_{joint}" if joint.isdigit() else joint for joint in order)
    if joints and names != tuple(joints):
        names = tuple(joints)
        message = f"columns with numbers, joints with names ({in_words(names)})"
        remedy = "the joints are used in this order"
        if families["q"][order[0]].path is None:
            findings.append(noted(where, "numbered-joints", message, remedy))
        else:  # the order of the message, which drivers often sort by name
            remedy += "; if the message has another one, give a mapping"
            findings.append(RecordingFinding("numbered-joints", "warning", where, None, (), message, remedy))
    if any(column.path is not None for family in families.values() for column in family.values()):
        taken = "; ".join(f"{name}: {listed(family)}" for name, family in families.items())
        findings.append(noted(where, "matched-columns", f"taken by name: {taken}", "give a mapping to take others"))
    return ColumnMapping("by name", names, channels, time=time, rate=rate), findings


def _refuse_left_out(table: RecordedTable, families: dict[str, Family]) -> None:
    """Raise BadMapping for an array that is a quantity by its name, but does not contain columns of numbers."""
    for name, reason in table.left_out.items():
        said = meaning(name, None) or meaning(f"{name}_1", None)
        if said and said.quantity not in families:
            raise BadMapping(
                f"{table.path}: {name!r} is the quantity {said.quantity} by its name, but not read: {reason}"
            )


def _order(where: str, found: list[str], joints: Sequence[str] | None) -> list[str]:
    """The joints in the order of the robot, if known; otherwise numbers ascending, names as the columns."""
    if all(joint.isdigit() for joint in found):
        if joints and len(joints) != len(found):
            raise BadMapping(
                f"{where}: positions of {counted(len(found), 'joint')}, the robot has {len(joints)}; give a mapping"
            )
        return sorted(found, key=int)
    missing = [joint for joint in joints or () if joint not in found]
    if missing:
        raise BadMapping(f"{where}: no position of {missing[0]!r} (there are {in_words(found)}); give a mapping")
    return list(joints or found)


def _channel(
    table: RecordedTable, name: str, family: Family, order: list[str], findings: list[RecordingFinding]
) -> Channel:
    where = str(table.path)
    surplus = set(family) - set(order) if all(joint.isdigit() for joint in family) else set()
    if surplus or not set(order) <= set(family):
        raise BadMapping(
            f"{where}: {name} has columns for {in_words(family)}, joints are {in_words(order)}; give a mapping"
        )
    columns = [family[joint] for joint in order]
    units = [known_unit_of(where, name, column) for column in columns]
    if not table.in_si and not all(column.unit for column in columns):
        message = f"{name} in columns without units ({listed(family)})"
        remedy = f"{SI_UNITS[name]} is assumed; give units in the header"
        findings.append(noted(where, "assumed-unit", message, remedy))
    return Channel(
        tuple(column.number for column in columns),
        np.array([unit.factor for unit in units]),
        np.zeros(len(order)),
        tuple(unit.slides if column.unit else None for unit, column in zip(units, columns, strict=True)),
        signs=np.ones(len(order)),
        delays=np.zeros(len(order)),
    )
