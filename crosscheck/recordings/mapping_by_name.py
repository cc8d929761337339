"""The mapping that follows from the names of the columns, where they are unambiguous."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings.clock_by_name import clocks, time_column
from crosscheck.recordings.column_families import Family, candidates, known_unit_of, listed, only
from crosscheck.recordings.column_names import CURRENTS, meaning
from crosscheck.recordings.errors import BadMapping
from crosscheck.recordings.findings import RecordingFinding, noted
from crosscheck.recordings.mapping import QUANTITIES, SI_UNITS, Channel, ColumnMapping
from crosscheck.recordings.table import RecordedTable, in_words


def mapping_by_name(
    table: RecordedTable, joints: Sequence[str] | None, rate: float | None
) -> tuple[ColumnMapping, list[RecordingFinding]]:
    """The mapping, and what had to be assumed for it. Raises AmbiguousColumns, BadMapping."""
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
    channels = {name: _channel(table, name, families[name], order, findings) for name in QUANTITIES if name in families}
    currents = [name for name in table.names if CURRENTS.fullmatch(name)]
    if "tau" not in channels and currents:
        message = f"currents instead of torques ({in_words(currents)})"
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
    """Raise BadMapping for an array that is a quantity by its name, but holds no columns of numbers."""
    for name, reason in table.left_out.items():
        said = meaning(name, None) or meaning(f"{name}_1", None)
        if said and said.quantity not in families:
            raise BadMapping(
                f"{table.path}: {name!r} is the quantity {said.quantity} by its name, but not read: {reason}"
            )


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


def _channel(
    table: RecordedTable, name: str, family: Family, order: list[str], findings: list[RecordingFinding]
) -> Channel:
    where = str(table.path)
    if not set(order) <= set(family):
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
    )
