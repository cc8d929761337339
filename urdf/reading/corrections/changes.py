"""Changes of the numbers of one <inertial>: slips of those who write files, undone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from decimal import Decimal, DecimalException
from itertools import combinations, permutations
from typing import Literal

from lxml import etree

from graphdyn.model import parallel_axis
from urdf.document.inertial_numbers import inertial_numbers
from urdf.document.numbers import rotation_from_rpy, rpy_from_rotation, text, values
from urdf.document.vocabulary import NUMBERS

MOMENTS, PRODUCTS = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")

MASS_POWERS = (-3, -2, -1, 1, 2, 3)
"""Powers of ten that a mass is wrong by: a shifted point, grams for kilograms."""

TENSOR_POWERS = (-9, -7, -6, -4, -3, -2, -1, 1, 2, 3, 4, 6, 7, 9)
"""Powers of ten that a tensor is wrong by: a shifted point, g mm², g cm², kg mm², kg cm², g m²."""

CENTER_POWERS = (-3, -2, -1, 1, 2, 3)
"""Powers of ten that a center of mass is wrong by: a shifted point, cm, mm."""

INCHES = 1 / 0.0254
"""The inches in a meter. Nothing tells of pounds and newtons for kilograms: 2.2 is near 2.7, and 9.81 near 10."""

DENSITIES: Mapping[float, str] = {
    7.85: "steel for water",
    2.7: "aluminum for water",
    2.907: "steel for aluminum",
}
"""Densities over one another, and what was taken for what."""

Edits = Mapping[tuple[str, str], str]
"""New texts by tag and attribute."""

Kind = Literal["power of ten", "exchange", "sign", "axes", "rotation", "density", "inches", "point"]


@dataclass(frozen=True)
class Correction:
    """A change of the numbers of an <inertial>. what: in words; factor: of all that change, where they are scaled"""

    kind: Kind
    what: str
    edits: Edits
    factor: float = 1.0

    @property
    def turns(self) -> bool:
        """Whether it gives another tensor, not only of another size."""
        return self.kind in ("sign", "exchange", "axes", "rotation")

    @property
    def mends_tensors(self) -> bool:
        """Whether it is one of the two slips that make tensors impossible."""
        of_moment = any(("inertia", name) in self.edits for name in MOMENTS)
        return self.kind == "exchange" or (self.kind == "sign" and of_moment)

    @property
    def enlarges(self) -> bool:
        """Whether the mass becomes larger."""
        return ("mass", "value") in self.edits and self.factor > 1

    @property
    def of_center(self) -> bool:
        """Whether a coordinate of the center of mass changes its sign, which shapes tell least."""
        return self.kind == "sign" and ("origin", "xyz") in self.edits

    @property
    def guessed(self) -> bool:
        """Whether it is never sure by itself: a density; a mass that is too small, as placeholders are; a factor of
        100, for which no unit is a reason; a sign of a center of mass."""
        return self.kind == "density" or self.enlarges or self.of_center or self.factor in (0.01, 100.0)

    def applied(self, inertial: etree._Element) -> etree._Element:
        """A copy of the element with the change."""
        changed = deepcopy(inertial)
        self.apply(changed)
        return changed

    def apply(self, inertial: etree._Element) -> None:
        for (tag, name), new in self.edits.items():
            part = inertial.find(tag)
            assert part is not None
            part.set(name, new)


def changes(inertial: etree._Element) -> Iterator[Correction]:
    """Every change that one slip explains. inertial: with valid numbers"""
    yield from _scaled(inertial)
    yield from _exchanged(inertial)
    yield from _signs(inertial)
    yield from _permuted(inertial)
    yield from _turned_back(inertial)


def shifted(inertial: etree._Element) -> Iterator[Correction]:
    """A tensor about the origin of the link, and one that was shifted to the center of mass twice, about the latter."""
    found = inertial_numbers(inertial)
    if found is None or not found.center.any():
        return
    term = parallel_axis(found.mass, found.rotation.T @ found.center)
    for what, tensor in (
        ("shifted from the origin of the link to the center of mass", found.tensor - term),
        ("shifted back, as it was shifted to the center of mass twice", found.tensor + term),
    ):
        edits = {("inertia", f"i{'xyz'[i]}{'xyz'[j]}"): f"{tensor[i, j]:.9g}" for i in range(3) for j in range(i, 3)}
        yield Correction("point", what, edits)


def _texts(inertial: etree._Element, tag: str, names: tuple[str, ...]) -> dict[tuple[str, str], str]:
    part = inertial.find(tag)
    return {} if part is None else {(tag, name): part.get(name, "") for name in names if part.get(name)}


def _scaled(inertial: etree._Element) -> Iterator[Correction]:
    mass = _texts(inertial, "mass", ("value",))
    tensor = _texts(inertial, "inertia", tuple(NUMBERS["inertia"]))
    center = _texts(inertial, "origin", ("xyz",))
    for what, texts, powers in (
        ("mass", mass, MASS_POWERS),
        ("tensor", tensor, TENSOR_POWERS),
        ("mass and tensor", mass | tensor, MASS_POWERS),
        ("center of mass", center, CENTER_POWERS),
    ):
        for power in powers if texts else ():
            said = f"{'times' if power > 0 else 'divided by'} {10 ** abs(power):,}"
            yield Correction("power of ten", f"{what} {said}", _times(texts, Decimal(1).scaleb(power)), 10.0**power)
    if center:
        edits = {key: " ".join(repr(float(word) / INCHES) for word in words.split()) for key, words in center.items()}
        yield Correction("inches", f"center of mass divided by {INCHES:.4g} (inches)", edits)
    for ratio, reason in DENSITIES.items():
        for what, texts in (("mass", mass), ("mass and tensor", mass | tensor)):
            edits = {key: repr(float(word) / ratio) for key, word in texts.items() if float(word)}
            yield Correction("density", f"{what} divided by {ratio} ({reason})", edits, 1 / ratio)
            edits = {key: repr(float(word) * ratio) for key, word in texts.items() if float(word)}
            yield Correction("density", f"{what} times {ratio}", edits, ratio)


def _times(texts: Edits, factor: Decimal) -> Edits:
    return {key: " ".join(_decimal(word, factor) for word in words.split()) for key, words in texts.items()}


def _decimal(word: str, factor: Decimal) -> str:
    """The decimal with its point moved: no digit changes."""
    try:
        moved = Decimal(word) * factor
    except DecimalException:
        return word
    return word if not moved else f"{moved.normalize():f}" if -7 < moved.adjusted() < 7 else str(moved.normalize())


def _exchanged(inertial: etree._Element) -> Iterator[Correction]:
    texts = _texts(inertial, "inertia", tuple(NUMBERS["inertia"]))
    for one, other in combinations(NUMBERS["inertia"], 2):
        edits = {("inertia", one): texts["inertia", other], ("inertia", other): texts["inertia", one]}
        yield Correction("exchange", f"{one} and {other} exchanged", edits)


def _signs(inertial: etree._Element) -> Iterator[Correction]:
    texts = _texts(inertial, "inertia", tuple(NUMBERS["inertia"]))
    for name in MOMENTS:
        if texts["inertia", name].strip().startswith("-"):
            yield Correction("sign", f"{name} without its sign", {("inertia", name): _opposite(texts["inertia", name])})
    for number in (1, 2, 3):
        for names in combinations(PRODUCTS, number):
            said = f"{' and '.join(names)} with the opposite sign" if number < 3 else "all products of opposite sign"
            yield Correction("sign", said, {("inertia", name): _opposite(texts["inertia", name]) for name in names})
    words = (_texts(inertial, "origin", ("xyz",)).get(("origin", "xyz")) or "").split()
    for k, word in enumerate(words):
        new = [_opposite(word) if k == j else other for j, other in enumerate(words)]
        yield Correction(
            "sign", f"{'xyz'[k]} of the center of mass with the opposite sign", {("origin", "xyz"): " ".join(new)}
        )


def _permuted(inertial: etree._Element) -> Iterator[Correction]:
    """Axes in another order, or turned by 90°: moments and products change places together."""
    texts = _texts(inertial, "inertia", tuple(NUMBERS["inertia"]))
    for order in permutations("xyz"):
        if order == ("x", "y", "z"):
            continue
        for negative in ("", *"xyz"):
            edits = {}
            for name in NUMBERS["inertia"]:
                axes = [order["xyz".index(axis)] for axis in name[1:]]
                old = texts["inertia", f"i{''.join(sorted(axes))}"]
                odd = sum(axis in negative for axis in set(axes)) == 1 and len(set(axes)) == 2
                edits["inertia", name] = _opposite(old) if odd and float(old) else old
            said = f", {negative} reversed" if negative else ""
            yield Correction("axes", f"axes in the order {''.join(order)}{said}", edits)


def _opposite(word: str) -> str:
    word = word.strip()
    return word[1:] if word.startswith("-") else f"-{word.removeprefix('+')}"


def _turned_back(inertial: etree._Element) -> Iterator[Correction]:
    origin = inertial.find("origin")
    angles = values(origin, "rpy", 3)
    if origin is None or angles is None or not any(angles):
        return
    words = str(origin.get("rpy")).split()
    if sum(map(bool, angles)) == 1:
        words = [_opposite(word) if angle else word for word, angle in zip(words, angles, strict=True)]
    else:
        words = text(rpy_from_rotation(rotation_from_rpy(*angles).T)).split()
    yield Correction("rotation", "rotation transposed", {("origin", "rpy"): " ".join(words)})
    yield Correction("rotation", "rotation left out", {("origin", "rpy"): "0 0 0"})
