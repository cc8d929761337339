"""The mapping that follows from the names of the columns, where they are unambiguous."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crosscheck.recordings.column_names import CURRENTS, WORDS, meaning
from crosscheck.recordings.errors import AmbiguousColumns, BadMapping
from crosscheck.recordings.findings import RecordingFinding
from crosscheck.recordings.mapping import QUANTITIES, SI_UNITS, Channel, ColumnMapping, TimeColumn
from crosscheck.recordings.table import RecordedTable
from crosscheck.recordings.units import Unit, unit_of


class Named(NamedTuple):
    """A column: its number from 1, its name, its unit ("" where the name has none)."""

    number: int
    name: str
    unit: str


Family = dict[str, Named]
"""Columns of one quantity by joint."""


def mapping_by_name(
    table: RecordedTable, joints: Sequence[str] | None, rate: float | None
) -> tuple[ColumnMapping, list[RecordingFinding]]:
    """The mapping, and what had to be assumed for it. Raises AmbiguousColumns, BadMapping."""
    where = str(table.path)
    if not table.has_names:
        raise BadMapping(f"{where}: the columns have no names; give a mapping with their numbers")
    families = _families(table, joints)
    if "q" not in families:
        raise BadMapping(
            f"{where}: no columns of joint positions (q_1, position_1, q_<joint>, <joint>.q, …) among "
            f"{', '.join(table.names)}; give a mapping"
        )
    order = _order(where, list(families["q"]), joints)
    findings: list[RecordingFinding] = []
    channels = {name: _channel(where, name, families[name], order, findings) for name in QUANTITIES if name in families}
    currents = [name for name in table.names if CURRENTS.fullmatch(name)]
    if "tau" not in channels and currents:
        message = f"currents instead of torques ({', '.join(currents)})"
        findings.append(_note(where, "current-without-gain", message, "give their gains in a mapping"))
    time = _time(where, families.get("time"), rate, findings)
    names = tuple(f"joint_{joint}" if joint.isdigit() else joint for joint in order)
    if joints and names != tuple(joints):
        names = tuple(joints)
        message = f"columns with numbers, joints with names ({', '.join(names)})"
        findings.append(_note(where, "numbered-joints", message, "the joints are used in this order"))
    return ColumnMapping("by name", names, channels, time=time, rate=rate), findings


def _families(table: RecordedTable, joints: Sequence[str] | None) -> dict[str, Family]:
    """The family of each quantity. Raises AmbiguousColumns where a quantity has several."""
    found: dict[str, dict[str, Family]] = {name: {} for name in WORDS}
    for number, name in enumerate(table.names, start=1):
        said = meaning(name, joints)
        if said is None:
            continue
        family = found[said.quantity].setdefault(said.family, {})
        if said.joint in family:
            other = family[said.joint]
            raise AmbiguousColumns(
                f"{table.path}: '{other.name}' (column {other.number}) and '{name}' (column {number}) are both "
                f"{said.quantity} of '{said.joint}'; say in a mapping which to take"
            )
        family[said.joint] = Named(number, name, said.unit)
    for quantity, candidates in found.items():
        if len(candidates) > 1:
            listed = "; ".join(_listed(family) for family in candidates.values())
            raise AmbiguousColumns(
                f"{table.path}: {len(candidates)} candidates for {quantity}: {listed}; say in a mapping which to take"
            )
    return {name: next(iter(candidates.values())) for name, candidates in found.items() if candidates}


def _order(where: str, found: list[str], joints: Sequence[str] | None) -> list[str]:
    """The joints in the order of the robot, if known; else numbers ascending, names in the order of the columns."""
    if all(joint.isdigit() for joint in found):
        if joints and len(joints) != len(found):
            raise BadMapping(f"{where}: positions of {len(found)} joints, the robot has {len(joints)}; give a mapping")
        return sorted(found, key=int)
    missing = [joint for joint in joints or () if joint not in found]
    if missing:
        raise BadMapping(f"{where}: no position of '{missing[0]}' (there are {', '.join(found)}); give a mapping")
    return list(joints or found)


def _channel(where: str, name: str, family: Family, order: list[str], findings: list[RecordingFinding]) -> Channel:
    if not set(order) <= set(family):
        raise BadMapping(
            f"{where}: {name} has columns for {', '.join(family)}, joints are {', '.join(order)}; give a mapping"
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


def _time(where: str, family: Family | None, rate: float | None, findings: list[RecordingFinding]) -> TimeColumn | None:
    if family is None:
        if rate is None:
            raise BadMapping(f"{where}: no column of time (t, time_s, stamp, …); give the rate, or a mapping")
        return None
    column = family[""]
    if not column.unit:
        message = f"time in a column without unit ({column.name})"
        findings.append(_note(where, "assumed-unit", message, "s is assumed; give the unit in the header"))
    return TimeColumn(column.number, _unit(where, "time", column).factor)


def _unit(where: str, quantity: str, column: Named) -> Unit:
    """The unit in the name, else SI. A drive's current is refused as a torque."""
    unit = unit_of(quantity, column.unit or SI_UNITS.get(quantity, "s"))
    if unit is None or unit.needs_gain:
        raise BadMapping(
            f"{where}: column '{column.name}' is in '{column.unit}', which is not a unit of {quantity}; give a mapping"
        )
    return unit


def _listed(family: Family) -> str:
    names = [column.name for column in family.values()]
    return names[0] if len(names) == 1 else f"{names[0]} … {names[-1]}"


def _note(where: str, code: str, message: str, remedy: str) -> RecordingFinding:
    return RecordingFinding(code, "note", where, None, (), message, remedy)
