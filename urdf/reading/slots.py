"""Tensors that no body can have because two of their entries stand in each other's place, or one has a wrong sign.

A link whose tensor is impossible is corrected only if exactly one such change makes it possible, clearly, and leaves
products of inertia that are small beside the moments, as in the axes in which nearly all links are given.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from lxml import etree

from graphdyn.layout import Array
from urdf.document.elements import describe, line_said
from urdf.document.numbers import values
from urdf.document.source import Source
from urdf.document.vocabulary import NUMBERS

MOMENTS = ("ixx", "iyy", "izz")

FEW_DIGITS = 0.02
"""Part of the largest moment by which a tensor may miss what bodies can have, because it is written with few digits."""

CLEARLY_POSITIVE = 1e-3
"""Smallest principal moment as a part of the largest from which a corrected tensor is clearly possible: thin rods have
more, and entries that change places by chance rarely leave as much."""

MAX_PRODUCT_SHARE = 0.4
"""Largest product of inertia as a part of the smallest moment in a corrected tensor. Four of five published links have
less; a published tensor that is impossible for another reason becomes possible with 0.49."""


@dataclass(frozen=True)
class Correction:
    """A change of a tensor after which it is possible.

    entries: new texts by the names of attributes; what: the change, in words
    """

    entries: dict[str, str]
    what: str


def corrections(inertia: etree._Element) -> list[Correction]:
    """Changes of one <inertia> that make it possible, whose results differ; none where it is possible already."""
    texts = {name: str(inertia.get(name)) for name in NUMBERS["inertia"]}
    given = _numbers(inertia)
    if given is None or is_possible(given, -FEW_DIGITS):
        return []
    found: dict[tuple[float, ...], Correction] = {}
    for one, other in combinations(NUMBERS["inertia"], 2):
        if one in MOMENTS and other in MOMENTS:  # moments that change places stay moments
            continue
        changed = {**given, one: given[other], other: given[one]}
        if is_possible(changed, CLEARLY_POSITIVE):
            new = {one: texts[other], other: texts[one]}
            found.setdefault(tuple(changed.values()), Correction(new, f"{one} and {other} exchanged"))
    for name in MOMENTS:
        changed = {**given, name: -given[name]}
        if given[name] < 0 and is_possible(changed, CLEARLY_POSITIVE):
            new = {name: texts[name].strip().removeprefix("-")}
            found.setdefault(tuple(changed.values()), Correction(new, f"{name} without its sign"))
    return list(found.values())


def unique_correction(inertia: etree._Element) -> Correction | None:
    """The only change that makes a tensor possible, if it leaves small products."""
    found = corrections(inertia)
    if len(found) != 1:
        return None
    given = _numbers(inertia)
    assert given is not None
    changed = {**given, **{name: float(text) for name, text in found[0].entries.items()}}
    products = max(abs(value) for name, value in changed.items() if name not in MOMENTS)
    return found[0] if products <= MAX_PRODUCT_SHARE * min(changed[name] for name in MOMENTS) else None


def exchange_slots(source: Source) -> Iterator[str]:
    """The repair "slots": write unique corrections; yields each change, in words."""
    for inertia in source.robot.iter("inertia"):
        found = unique_correction(inertia)
        if found is not None:
            for name, text in found.entries.items():
                inertia.set(name, text)
            yield f"{line_said(inertia)}: {describe(inertia)}: {found.what}, because no body has this tensor"


def candidates(source: Source) -> Iterator[str]:
    """Impossible tensors that several changes make possible, or one that is not clear enough, in words."""
    for inertia in source.robot.iter("inertia"):
        found = corrections(inertia)
        if found and unique_correction(inertia) is None:
            ways = "; or ".join(each.what for each in found)
            yield f"{line_said(inertia)}: {describe(inertia)}: no body has this tensor; it is possible with {ways}"


def is_possible(entries: dict[str, float], least: float) -> bool:
    """Whether principal moments are at least this part of the largest, and none exceeds the sum of the others by more
    than few digits explain."""
    low, middle, high = np.linalg.eigvalsh(_tensor(entries))
    return bool(low >= least * abs(high) and high - low - middle <= FEW_DIGITS * abs(high))


def _tensor(entries: dict[str, float]) -> Array:
    xx, xy, xz, yy, yz, zz = (entries[name] for name in NUMBERS["inertia"])
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _numbers(inertia: etree._Element) -> dict[str, float] | None:
    """Its six numbers by name; None where one is missing or no number."""
    found = {name: values(inertia, name, 1) for name in NUMBERS["inertia"]}
    numbers = {name: value[0] for name, value in found.items() if value is not None}
    return numbers if len(numbers) == len(found) and np.isfinite(list(numbers.values())).all() else None
