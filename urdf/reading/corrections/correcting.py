"""The repair "inertials": unique corrections are written, all others told."""

from __future__ import annotations

from collections.abc import Iterator

from urdf.document.elements import describe, line_said
from urdf.document.source import Source
from urdf.reading.corrections.changes import Correction
from urdf.reading.corrections.choosing import SuspectInertial, suspect_inertials

MAX_WAYS = 3
"""Candidates told of one link."""


def correct_inertials(source: Source) -> Iterator[str]:
    """Write unique corrections; yields each change, in words, the surest first."""
    for suspect in suspect_inertials(source):
        if suspect.unique is not None:
            said = _said(suspect, suspect.unique)
            suspect.unique.apply(suspect.inertial)
            yield f"{_place(suspect)}: {said}, because {suspect.reason}"


def candidates(source: Source) -> Iterator[str]:
    """Inertials that several changes make right, or one that is not sure, in words, the surest first."""
    suspects = suspect_inertials(source)
    told = {suspect.link for suspect in suspects if suspect.unique is not None}
    for suspect in suspects:
        if suspect.unique is None and not told.intersection(suspect.twins):
            yield f"{_place(suspect)}: {suspect.reason}; it fits with {_ways(suspect)}"
            told.add(suspect.link)


def _ways(suspect: SuspectInertial) -> str:
    """The changes in words, with numbers where there is one."""
    if len(suspect.ways) > 1:
        more = len(suspect.ways) - MAX_WAYS
        return " or ".join(way.what for way in suspect.ways[:MAX_WAYS]) + (f" or {more} more" if more > 0 else "")
    other = ", or the other is wrong" if len(suspect.twins) == 1 else ""
    return f"{_said(suspect, suspect.ways[0])}{other}"


def _place(suspect: SuspectInertial) -> str:
    return f"{line_said(suspect.inertial)}: {describe(suspect.inertial)}"


def _said(suspect: SuspectInertial, change: Correction) -> str:
    """ "mass divided by 1,000 (value 2500 made 2.5)"."""
    numbers = []
    for (tag, name), new in change.edits.items():
        part = suspect.inertial.find(tag)
        old = "" if part is None else str(part.get(name))
        if old.split() != new.split():
            numbers.append(f"{name if name != 'value' else tag} {' '.join(old.split())} made {new}")
    return f"{change.what} ({', '.join(numbers)})"
