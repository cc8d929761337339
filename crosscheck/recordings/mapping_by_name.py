"""The mapping that follows from the names of the columns, where they are unambiguous."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crosscheck.recordings.column_names import (
    CURRENTS,
    NANOSECONDS_PART,
    RECEIVED,
    SECONDS_PART,
    WORDS,
    Meaning,
    meaning,
)
from crosscheck.recordings.errors import AmbiguousColumns, BadMapping
from crosscheck.recordings.findings import RecordingFinding
from crosscheck.recordings.mapping import QUANTITIES, SI_UNITS, Channel, ColumnMapping, TimeColumn
from crosscheck.recordings.table import RecordedTable, in_words
from crosscheck.recordings.units import Unit, unit_of


class Named(NamedTuple):
    """A column: its number from 1, its name, its unit ("" where the name has none), the path of its message."""

    number: int
    name: str
    unit: str
    path: str | None = None


Family = dict[str, Named]
"""Columns of one quantity by joint."""


def mapping_by_name(
    table: RecordedTable, joints: Sequence[str] | None, rate: float | None
) -> tuple[ColumnMapping, list[RecordingFinding]]:
    """The mapping, and what had to be assumed for it. Raises AmbiguousColumns, BadMapping."""
    where = str(table.path)
    if not table.has_names:
        raise BadMapping(f"{where}: the columns have no names; give a mapping with their numbers")
    findings: list[RecordingFinding] = []
    families = _families(table, joints, findings)
    _refuse_left_out(table, families)
    if "q" not in families:
        raise BadMapping(
            f"{where}: no columns of joint positions (q_1, position_1, q_<joint>, <joint>.q, …) among "
            f"{in_words(table.names)}; give a mapping"
        )
    order = _order(where, list(families["q"]), joints)
    channels = {name: _channel(where, name, families[name], order, findings) for name in QUANTITIES if name in families}
    currents = [name for name in table.names if CURRENTS.fullmatch(name)]
    if "tau" not in channels and currents:
        message = f"currents instead of torques ({in_words(currents)})"
        findings.append(_note(where, "current-without-gain", message, "give their gains in a mapping"))
    time = _time(table, families, rate, findings)
    names = tuple(f"joint_{joint}" if joint.isdigit() else joint for joint in order)
    if joints and names != tuple(joints):
        names = tuple(joints)
        message = f"columns with numbers, joints with names ({in_words(names)})"
        remedy = "the joints are used in this order"
        if families["q"][order[0]].path is None:
            findings.append(_note(where, "numbered-joints", message, remedy))
        else:  # the order of the message, which drivers often sort by name
            remedy += "; if the message has another one, give a mapping"
            findings.append(RecordingFinding("numbered-joints", "warning", where, None, (), message, remedy))
    if any(column.path is not None for family in families.values() for column in family.values()):
        taken = "; ".join(f"{name}: {_listed(family)}" for name, family in families.items())
        findings.append(_note(where, "matched-columns", f"taken by name: {taken}", "give a mapping to take others"))
    return ColumnMapping("by name", names, channels, time=time, rate=rate), findings


def _families(
    table: RecordedTable, joints: Sequence[str] | None, findings: list[RecordingFinding]
) -> dict[str, Family]:
    """The family of each quantity. Raises AmbiguousColumns where a quantity has several."""
    found: dict[str, dict[str, Family]] = {name: {} for name in WORDS}
    for number, name in enumerate(table.names, start=1):
        said = meaning(name, joints)
        if said is None:
            continue
        joint = _joint_of_message(table, name, said)
        family = found[said.quantity].setdefault(said.family, {})
        if joint in family:
            other = family[joint]
            raise AmbiguousColumns(
                f"{table.path}: {other.name!r} (column {other.number}) and {name!r} (column {number}) are both "
                f"{said.quantity} of {joint!r}; say in a mapping which to take"
            )
        family[joint] = Named(number, name, said.unit, said.path)
    found["time"] = _clocks(table, found, findings)
    for quantity, candidates in found.items():
        if len(candidates) > 1:
            listed = "; ".join(_listed(family) for family in candidates.values())
            raise AmbiguousColumns(
                f"{table.path}: {len(candidates)} candidates for {quantity}: {listed}; say in a mapping which to take"
            )
    return {name: next(iter(candidates.values())) for name, candidates in found.items() if candidates}


def _joint_of_message(table: RecordedTable, name: str, said: Meaning) -> str:
    """The joint of a column; of position[0] the text in the column name[0], where there is one."""
    if said.path is None or not said.joint.isdigit():
        return said.joint
    head, _, _ = said.family.partition("[*]")
    word = re.split(r"[/.]", head)[-1]
    beside = f"{head[: len(head) - len(word)]}name{name[len(head) :]}"
    if beside not in table.names:
        return said.joint
    texts = table.texts.get(table.names.index(beside), {})
    joints = {texts.get(row, "") for row in range(len(table.values))}
    if len(joints) > 1:
        raise AmbiguousColumns(
            f"{table.path}: {beside!r} names several joints ({in_words(sorted(joints))}); give every joint its columns"
        )
    return joints.pop() or said.joint


def _clocks(
    table: RecordedTable, found: dict[str, dict[str, Family]], findings: list[RecordingFinding]
) -> dict[str, Family]:
    """The candidates for the time, without those of other messages than the positions, and without stamps never set.

    Beside the stamps of the positions' message, PlotJuggler's own time is not one.
    """
    clocks = {family: columns[""] for family, columns in found["time"].items()}
    paths = [column.path for family in found["q"].values() for column in family.values()]
    of_positions = (paths[0] if paths else None) or ""
    own = {name: clock for name, clock in clocks.items() if clock.path is None or of_positions.startswith(clock.path)}
    clocks = own or clocks
    running = {name: clock for name, clock in clocks.items() if table.values[:, clock.number - 1].any()}
    clocks = running or clocks
    stamps = {name: clock for name, clock in clocks.items() if clock.path is not None}
    if len(stamps) == 1 and set(clocks) - set(stamps) == {RECEIVED}:
        message = f"two clocks: {in_words(clocks)}"
        findings.append(_note(str(table.path), "two-clocks", message, f"{in_words(stamps)} is taken"))
        clocks = stamps
    return {name: {"": clock} for name, clock in clocks.items()}


def _refuse_left_out(table: RecordedTable, families: dict[str, Family]) -> None:
    """Raise BadMapping for an array that is a quantity by its name, but holds no columns of numbers."""
    for name, reason in table.left_out.items():
        said = meaning(name, None) or meaning(f"{name}_1", None)
        if said and said.quantity not in families:
            raise BadMapping(f"{table.path}: {name!r} is {said.quantity} by its name, but not read: {reason}")


def _order(where: str, found: list[str], joints: Sequence[str] | None) -> list[str]:
    """The joints in the order of the robot, if known; else numbers ascending, names in the order of the columns."""
    if all(joint.isdigit() for joint in found):
        if joints and len(joints) != len(found):
            raise BadMapping(f"{where}: positions of {len(found)} joints, the robot has {len(joints)}; give a mapping")
        return sorted(found, key=int)
    missing = [joint for joint in joints or () if joint not in found]
    if missing:
        raise BadMapping(f"{where}: no position of {missing[0]!r} (there are {in_words(found)}); give a mapping")
    return list(joints or found)


def _channel(where: str, name: str, family: Family, order: list[str], findings: list[RecordingFinding]) -> Channel:
    if not set(order) <= set(family):
        raise BadMapping(
            f"{where}: {name} has columns for {in_words(family)}, joints are {in_words(order)}; give a mapping"
        )
    columns = [family[joint] for joint in order]
    units = [_unit(where, name, column) for column in columns]
    if not all(column.unit for column in columns):
        message = f"{name} in columns without units ({_listed(family)})"
        remedy = f"{SI_UNITS[name]} is assumed; give units in the header"
        findings.append(_note(where, "assumed-unit", message, remedy))
    return Channel(
        tuple(column.number for column in columns),
        np.array([unit.factor for unit in units]),
        np.zeros(len(order)),
        tuple(unit.slides if column.unit else None for unit, column in zip(units, columns, strict=True)),
    )


def _time(
    table: RecordedTable, families: dict[str, Family], rate: float | None, findings: list[RecordingFinding]
) -> TimeColumn | None:
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
    if not column.unit and column.number - 1 not in table.seconds:
        message = f"time in a column without unit ({in_words([column.name])})"
        findings.append(_note(where, "assumed-unit", message, "s is assumed; give the unit in the header"))
    return TimeColumn(column.number, _unit(where, "time", column).factor)


def _two_parts(table: RecordedTable) -> tuple[Named, Named] | None:
    """The columns of seconds and of nanoseconds, where there is one pair. Raises AmbiguousColumns for several."""
    found = []
    for number, name in enumerate(table.names, start=1):
        part = SECONDS_PART.fullmatch(name)
        for other, beside in enumerate(table.names, start=1):
            if part and re.fullmatch(re.escape(part[1]) + NANOSECONDS_PART, beside):
                found.append((Named(number, name, "s", part[1]), Named(other, beside, "ns", part[1])))
    if len(found) > 1:
        listed = "; ".join(in_words(column.name for column in pair) for pair in found)
        raise AmbiguousColumns(f"{table.path}: {len(found)} candidates for time: {listed}; say in a mapping which")
    return found[0] if found else None


def _unit(where: str, quantity: str, column: Named) -> Unit:
    """The unit in the name, else SI. A drive's current is refused as a torque."""
    unit = unit_of(quantity, column.unit or SI_UNITS.get(quantity, "s"))
    if unit is None or unit.needs_gain:
        raise BadMapping(
            f"{where}: column {column.name!r} is in {column.unit!r}, which is not a unit of {quantity}; give a mapping"
        )
    return unit


def _listed(family: Family) -> str:
    names = [column.name for column in family.values()]
    return in_words(names) if len(names) == 1 else f"{in_words(names[:1])} … {in_words(names[-1:])}"


def _note(where: str, code: str, message: str, remedy: str) -> RecordingFinding:
    return RecordingFinding(code, "note", where, None, (), message, remedy)
