"""Links that should have the same inertial: left and right, and those drawn with one mesh; up to a reflection."""

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
_LETTERS = ("l", "L"), ("r", "R")
_PAIRS = (
    ("l", "r"),
    ("L", "R"),
    *((f"{a}{left}", f"{a}{right}") for a in "fhrbFHRB" for left, right in ("lr", "LR")),
    *((f"{left}{a}", f"{right}{a}") for a in "fhrbFHRB" for left, right in ("lr", "LR")),
)

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
    """

    link: str
    views: tuple[InertialNumbers, ...]
    sure_axes: bool

    def has(self, numbers: InertialNumbers) -> bool:
        """Whether these are its own, seen in one of the ways."""
        return any(same(numbers, view) for view in self.views)


def twins(
    source: Source, inertials: Mapping[str, InertialNumbers], filled: Mapping[str, FilledLink]
) -> dict[str, list[Twin]]:
    """Per link those that agree in two of mass, center of mass and tensor."""
    found: dict[str, list[Twin]] = {}
    for link, others in _related(source, inertials).items():
        for other in sorted(others):
            axes = _axes_of_shapes(filled.get(link), filled.get(other))
            twin = _twin(inertials[link], other, inertials[other], axes)
            if twin is not None:
                found.setdefault(link, []).append(twin)
    return found


def _related(source: Source, inertials: Mapping[str, InertialNumbers]) -> dict[str, set[str]]:
    """Per link those with the name of the other side, and those drawn with the same shape."""
    related: dict[str, set[str]] = {link: set() for link in inertials}
    for link in inertials:
        for other in mirrored_names(link):
            if other in inertials:
                related[link].add(other)
                related[other].add(link)
    drawn: dict[str, list[tuple[str, ...]]] = {}
    for drawing in source.drawings.drawings:
        if drawing.geometry == "visual" and drawing.link in inertials:
            drawn.setdefault(drawing.link, []).append(drawing.shape)
    sharing: dict[tuple[tuple[str, ...], ...], set[str]] = {}
    for link, shapes in drawn.items():
        sharing.setdefault(tuple(shapes), set()).add(link)
    for links in sharing.values():
        for link in links:
            related[link] |= links - {link}
    return related


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


def _twin(own: InertialNumbers, link: str, other: InertialNumbers, axes: Sequence[Array]) -> Twin | None:
    seen = [_reflected(other, each) for each in axes or REFLECTIONS]
    fits = [agreements(own, each) for each in seen]
    plain = bool(axes) and (axes[0] == np.eye(3)).all()
    if plain and not any(map(all, fits)):
        seen, fits = seen[:1], fits[:1]
    most = max(map(sum, fits))
    if most < 2:
        return None
    views = list[InertialNumbers]()
    for view, agreeing in zip(seen, fits, strict=True):
        if sum(agreeing) == most and not any(same(view, each) for each in views):
            views.append(view)
    oblique = bool(np.abs(own.center).min() > CLEAR_OF_AXES * np.abs(own.center).max())
    sure = plain or (len(views) == 1 and (oblique or bool(axes)))
    return Twin(link, tuple(views), sure)


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
