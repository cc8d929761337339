"""Columns of motor currents by their names, for commands that find gains: current_1, actual_current_0, elbow.i."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from crosscheck.recordings.errors import AmbiguousColumns
from crosscheck.recordings.mapping.mapping import Channel
from crosscheck.recordings.table import RecordedTable, in_words

BEFORE = re.compile(
    r"(?i)(.*[/.])?((?:actual|motor|measured|joint|target)_)?(current|currents|i|amps)[ _./]?[\[(]?(.+?)[\])]?"
)
AFTER = re.compile(r"(?i)(.*[/.])?([^/.]+)[/._]((?:actual|motor|measured|joint|target)_)?(current|currents|i|amps)")
"""Names with the joint after, and before the word for a current."""

UNIT = re.compile(r"\s*[\[(][^\[\]()]*[^\[\]()\d][^\[\]()]*[\])]$")
"""Unit in brackets at the end of a name."""


def current_columns(table: RecordedTable, joints: Sequence[str]) -> list[int] | None:
    """Numbers of the columns of the joints' currents, from 1; None if there are none.

    joints: their names, or numbers in ascending order. Targets of the controller are taken only where nothing else is.

    Raises AmbiguousColumns for several currents of the joints.
    """
    families: dict[tuple[str, str], dict[str, int]] = defaultdict(dict)
    for number, name in enumerate(table.names, start=1):
        label = UNIT.sub("", name.strip())
        if (found := BEFORE.fullmatch(label)) and (found[4].isdigit() or found[4] in joints):
            families[found[1] or "", f"{found[2] or ''}{found[3]}".lower()][found[4]] = number
        elif (found := AFTER.fullmatch(label)) and found[2] in joints:
            families[found[1] or "", f"{found[3] or ''}{found[4]}".lower()][found[2]] = number
    complete = {words: family for words, family in families.items() if _ordered(family, joints)}
    measured = {words: family for words, family in complete.items() if not words[1].startswith("target")}
    chosen = list((measured or complete).values())
    if len(chosen) > 1:
        listed = "; ".join(in_words(table.names[number - 1] for number in family.values()) for family in chosen)
        raise AmbiguousColumns(
            f"{table.path}: {len(chosen)} candidates for currents: {listed}; say in a mapping (docs/recordings.md) "
            "which"
        )
    return _ordered(chosen[0], joints) if chosen else None


def current_channel(columns: Sequence[int]) -> Channel:
    """The channel of these columns, as recorded."""
    one, zero = np.ones(len(columns)), np.zeros(len(columns))
    return Channel(tuple(columns), one, zero, (None,) * len(columns), signs=one, delays=zero)


def _ordered(family: dict[str, int], joints: Sequence[str]) -> list[int]:
    """The columns in the order of the joints; empty unless there is one for each."""
    if all(joint in family for joint in joints):
        return [family[joint] for joint in joints]
    numbered = all(name.isdigit() for name in family) and len(family) == len(joints)
    return [family[name] for name in sorted(family, key=int)] if numbered else []
