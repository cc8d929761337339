"""Links that should have the same inertial up to a reflection: left and right, legs, and those drawn alike."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from graphdyn.layout import Array
from urdf.document.inertial_numbers import InertialNumbers
from urdf.document.source import Source
from urdf.geometry.mass_properties import FilledLink

TWIN_ROUNDING = 0.01
"""Relative difference up to which masses, centers and tensors are those of a twin, written with few digits."""

_WORDS = (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"))
_PAIRS = (
    ("l", "r"),
    ("L", "R"),
    *((f"{a}{left}", f"{a}{right}") for a in "fhrbFHRB" for left, right in ("lr", "LR")),
    *((f"{left}{a}", f"{right}{a}") for a in "fhrbFHRB" for left, right in ("lr", "LR")),
)

_LEGS = tuple(
    (case(f"{front}l"), case(f"{front}r"), case(f"{hind}l"), case(f"{hind}r"))
    for front, hind in ("fr", "fh")
    for case in (str, str.upper)
)
_LEGS += tuple((a[::-1], b[::-1], c[::-1], d[::-1]) for a, b, c, d in _LEGS)
"""Names of the four legs: fl, fr, rl, rr; LF, RF, LH, RH; and the like."""

CLEAR_OF_AXES = 0.02
"""Part of the largest coordinate of a center of mass from which all others tell how a twin is reflected."""

REFLECTIONS = tuple(np.diag(signs) for signs in product((1.0, -1.0), repeat=3))
"""The axes of a twin in those of a link."""


SHAPE_TOLERANCE = 0.02
"""Relative difference up to which shapes are mirror images."""


@dataclass(frozen=True, eq=False)
class Twin:
    """link: by name; views: its inertial in the axes of the link whose twin it is, for every reflection that may be

    sure_axes: the reflection is that of their shapes, or of centers of mass off all axes
    near: it is the left of a right one, or drawn with the same files: those of other legs are copied with their slips
    """

    link: str
    views: tuple[InertialNumbers, ...]
    sure_axes: bool
    near: bool

    def has(self, numbers: InertialNumbers) -> bool:
        """Whether these are its own, seen in one of the ways."""
        return any(same(numbers, view) for view in self.views)


def twins(
    source: Source, inertials: Mapping[str, InertialNumbers], filled: Mapping[str, FilledLink]
) -> dict[str, list[Twin]]:
    """Per link those that agree in two of mass, center of mass and tensor."""
    near = _near(source, inertials)
    found: dict[str, list[Twin]] = {}
    for link, own in inertials.items():
        legs = set(_other_legs(link))
        for other, its in inertials.items():
            axes = _axes_of_shapes(filled.get(link), filled.get(other))
            if other != link and (other in near[link] or other in legs or axes):
                found.setdefault(link, []).extend(_twin(own, other, its, axes, other in near[link]))
    return found


def _near(source: Source, inertials: Mapping[str, InertialNumbers]) -> dict[str, set[str]]:
    """Per link those with the name of the other side, and those drawn with the same files."""
    drawn: dict[str, list[tuple[str, ...]]] = {}
    for drawing in source.drawings.drawings:
        if drawing.geometry == "visual" and drawing.link in inertials:
            drawn.setdefault(drawing.link, []).append(drawing.shape)
    sharing: dict[tuple[tuple[str, ...], ...], set[str]] = {}
    for link, shapes in drawn.items():
        sharing.setdefault(tuple(shapes), set()).add(link)
    near = {link: sharing[tuple(drawn[link])] if link in drawn else {link} for link in inertials}
    near = {link: others.union(mirrored_names(link)) for link, others in near.items()}
    return {link: {other for other in inertials if other in near[link] or link in near[other]} for link in inertials}


def _axes_of_shapes(one: FilledLink | None, other: FilledLink | None) -> list[Array]:
    """The reflections that turn one shape into the other."""
    if one is None or other is None:
        return []
    own, its = one.filled, other.filled
    size = float((own.high - own.low).max())
    if abs(own.volume - its.volume) > SHAPE_TOLERANCE * own.volume:
        return []
    return [
        each
        for each in REFLECTIONS
        if np.abs(own.center - each @ its.center).max() < SHAPE_TOLERANCE * size
        and np.abs(own.tensor - each @ its.tensor @ each).max() < SHAPE_TOLERANCE * np.abs(own.tensor).max()
    ]


def mirrored_names(name: str) -> Iterator[str]:
    """Names of the link on the other side: of one called left, or l, fl, … between the ends and marks of words."""
    for left, right in (*_WORDS, *_PAIRS):
        pattern = left if len(left) > 2 else rf"(?<![A-Za-z]){left}(?![A-Za-z])"
        if re.search(pattern, name):
            yield re.sub(pattern, right, name)


def _other_legs(name: str) -> Iterator[str]:
    for legs in _LEGS:
        found = re.search(rf"(?<![A-Za-z])({'|'.join(legs)})(?![A-Za-z])", name)
        if found is not None:
            yield from (name[: found.start()] + leg + name[found.end() :] for leg in legs)


def _twin(own: InertialNumbers, link: str, other: InertialNumbers, axes: Sequence[Array], near: bool) -> Iterator[Twin]:
    """The other link, if it is a twin."""
    seen = [_reflected(other, each) for each in axes or REFLECTIONS]
    fits = [agreements(own, each) for each in seen]
    plain = bool(axes) and (axes[0] == np.eye(3)).all()
    if plain and not any(map(all, fits)):
        seen, fits = seen[:1], fits[:1]
    most = max(map(sum, fits))
    if most < 2:
        return
    views = list[InertialNumbers]()
    for view, agreeing in zip(seen, fits, strict=True):
        if sum(agreeing) == most and not any(same(view, each) for each in views):
            views.append(view)
    oblique = bool(np.abs(own.center).min() > CLEAR_OF_AXES * np.abs(own.center).max())
    sure = plain or (len(views) == 1 and (oblique or bool(axes)))
    yield Twin(link, tuple(views), sure, near)


def _reflected(inertial: InertialNumbers, axes: Array) -> InertialNumbers:
    return InertialNumbers(inertial.mass, axes @ inertial.center, np.eye(3), axes @ inertial.turned @ axes)


def agreements(one: InertialNumbers, other: InertialNumbers) -> tuple[bool, bool, bool]:
    """Whether mass, center of mass and tensor agree."""
    return (
        _close(np.array([one.mass]), np.array([other.mass])),
        _close(one.center, other.center),
        _close(one.turned, other.turned) or _close(one.turned / one.mass, other.turned / other.mass),
    )


def same(one: InertialNumbers, other: InertialNumbers) -> bool:
    """Whether all numbers are those of the other."""
    return all(agreements(one, other)) and _close(one.turned, other.turned)


def _close(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).max() <= TWIN_ROUNDING * max(np.abs(one).max(), np.abs(other).max()) + 1e-12)
