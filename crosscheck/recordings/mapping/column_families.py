"""Families of columns: columns whose names differ only in the joint."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from crosscheck.recordings.errors import AmbiguousColumns, BadMapping
from crosscheck.recordings.mapping.column_names import ALL_WORDS, QUANTITY_WORDS, Meaning, meaning
from crosscheck.recordings.mapping.mapping import SI_UNITS
from crosscheck.recordings.mapping.units import Unit, unit_of
from crosscheck.recordings.table import RecordedTable, in_words

NUMBERED_COLUMN = re.compile(rf"(?i)(|.*[/.])({ALL_WORDS})([\[(._/]?\d+[\])]?)")
"""Name of a column with a numbered joint, whose name may be in an adjacent column: position[0] and name[0]."""


class Named(NamedTuple):
    """A column: its number from 1, its name, its unit ("" if the name has none), the path of its message."""

    number: int
    name: str
    unit: str
    path: str | None = None


Family = dict[str, Named]
"""Columns of one quantity by joint."""


def candidates(table: RecordedTable, joints: Sequence[str] | None) -> dict[str, dict[str, Family]]:
    """Families of columns by quantity. Raises AmbiguousColumns for two columns of the same joint."""
    found: dict[str, dict[str, Family]] = {name: {} for name in QUANTITY_WORDS}
    for number, name in enumerate(table.names, start=1):
        said = meaning(name, joints)
        if said is None:
            continue
        joint = _joint(table, name, said)
        family = found[said.quantity].setdefault(said.family, {})
        if joint in family:
            other = family[joint]
            raise AmbiguousColumns(
                f"{table.path}: {other.name!r} (column {other.number}) and {name!r} (column {number}) are both "
                f"{said.quantity} of {joint!r}; say in a mapping (docs/recordings.md) which to take"
            )
        family[joint] = Named(number, name, said.unit, said.path)
    return found


def only(table: RecordedTable, found: dict[str, dict[str, Family]]) -> dict[str, Family]:
    """The family of every quantity that has one. Raises AmbiguousColumns if a quantity has several."""
    for quantity, families in found.items():
        if len(families) > 1:
            names = "; ".join(listed(family) for family in families.values())
            raise AmbiguousColumns(
                f"{table.path}: {len(families)} candidates for {quantity}: {names}; "
                "say in a mapping (docs/recordings.md) which to take"
            )
    return {name: next(iter(families.values())) for name, families in found.items() if families}


def _joint(table: RecordedTable, name: str, said: Meaning) -> str:
    """The joint of a column; for position[0] the text in the column name[0], if there is one."""
    element = NUMBERED_COLUMN.fullmatch(name)
    beside = f"{element[1]}name{element[3]}" if element else ""
    if not said.joint.isdigit() or beside not in table.names:
        return said.joint
    texts = table.texts.get(table.names.index(beside), {})
    joints = {text for text in texts.values() if text}  # broken lines have none
    if len(joints) > 1:
        raise AmbiguousColumns(
            f"{table.path}: {beside!r} names several joints ({in_words(sorted(joints))}); give every joint its columns"
        )
    return joints.pop() if joints else said.joint


def known_unit_of(where: str, quantity: str, column: Named) -> Unit:
    """The unit in the name, otherwise SI. A drive's current is refused as a torque."""
    unit = unit_of(quantity, column.unit or SI_UNITS.get(quantity, "s"))
    if unit is None or unit.needs_gain:
        raise BadMapping(
            f"{where}: column {column.name!r} is in {column.unit!r}, which is not a unit of {quantity}; give a mapping"
        )
    return unit


def listed(family: Family) -> str:
    """The first and the last column, for a message."""
    names = [column.name for column in family.values()]
    return in_words(names) if len(names) == 1 else f"{in_words(names[:1])} … {in_words(names[-1:])}"
