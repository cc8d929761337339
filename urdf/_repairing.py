"""Repairs that the caller asks for by name; everything else stays as the file says."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from lxml import etree

from urdf._elements import describe, line_of
from urdf._errors import InvalidRepair
from urdf._limits import ENDLESS
from urdf._numerals import UNIT_LENGTH, values
from urdf._source import Source

ROUNDED = 1e-3
"""Difference from 1 below which the length of an axis is 1, written with few digits."""


def repair(source: Source, wanted: Iterable[str]) -> list[str]:
    """Repair the elements of the source; return every change, in words. Raises InvalidRepair for unknown names.

    "axis": axes whose length differs from 1 by less than ROUNDED get unit length
    "limits": lower and upper limits of position that are reversed are exchanged
    """
    if isinstance(wanted, str):
        raise InvalidRepair(f"repair is the string '{wanted}'", f"give a tuple: ('{wanted}',)", path=source.path)
    names = tuple(wanted)
    unknown = [name for name in names if name not in REPAIRS]
    if unknown:
        raise InvalidRepair(f"no repair is called {unknown[0]!r}", f"known: {', '.join(REPAIRS)}", path=source.path)
    return [change for name in REPAIRS if name in names for change in REPAIRS[name](source)]


def crossed_limits(joint: etree._Element) -> tuple[float, float] | None:
    """Lower and upper limit of position where they are reversed; None where they are in order, infinite or missing."""
    limit = joint.find("limit")
    lower, upper = values(limit, "lower", 1), values(limit, "upper", 1)
    if joint.get("type") not in ("revolute", "prismatic") or lower is None or upper is None:
        return None
    finite = abs(lower[0]) < ENDLESS and abs(upper[0]) < ENDLESS
    return (lower[0], upper[0]) if finite and lower[0] > upper[0] else None


def _axes(source: Source) -> Iterator[str]:
    for joint in source.joints:
        element = joint.find("axis")
        axis = values(element, "xyz", 3)
        if element is None or axis is None:
            continue
        length = math.hypot(*axis)
        if UNIT_LENGTH < abs(length - 1) < ROUNDED:
            element.set("xyz", " ".join(repr(x / length) for x in axis))
            yield f"line {line_of(element)}: {describe(element)}: length {length:.9g} made 1"


def _limits(source: Source) -> Iterator[str]:
    for joint in source.joints:
        crossed, limit = crossed_limits(joint), joint.find("limit")
        if crossed is not None and limit is not None:
            lower, upper = limit.get("lower", ""), limit.get("upper", "")
            limit.set("lower", upper)
            limit.set("upper", lower)
            yield f"line {line_of(limit)}: {describe(limit)}: lower {lower} and upper {upper} exchanged"


REPAIRS: dict[str, Callable[[Source], Iterator[str]]] = {"axis": _axes, "limits": _limits}
"""The repairs, by the names that urdf.load takes."""
