"""Which inertials cannot be right, and which change alone makes each right.

Every change that one slip explains is tried. What it leaves is measured against the shape of the link, the other links
of the robot, its neighbors and its twins (evidence.py, twins.py). A change is sure if the inertial is far from all that
is usual, the change brings it there, and no other does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from lxml import etree

from urdf.document.elements import name_of
from urdf.document.inertial_numbers import FEW_DIGITS, InertialNumbers, inertial_numbers
from urdf.document.source import Source
from urdf.document.tree import carriers
from urdf.errors import listed
from urdf.geometry.mass_properties import filled_links
from urdf.reading.corrections.changes import Correction, changes
from urdf.reading.corrections.evidence import CLEARLY_POSITIVE, LinkSurroundings, Usual, measures, usual_among, worst
from urdf.reading.corrections.evidence import strangeness as squares
from urdf.reading.corrections.surroundings import surroundings
from urdf.reading.corrections.twins import Twin, same, twins

DOUBTFUL, WRONG = 10.0, 25.0
"""Sum of squared measures, each over its spread, from which an inertial is suspect, and from which it is corrected."""

FITTING, CLEAR = 9.0, 6.5
"""The same up to which an inertial fits, and by which a change is clearly better than another."""

FITTING_SHARE = 0.25
"""Part of the strangeness of an inertial up to which its twin, which may be strange itself, fits."""

FAR_SHARE = 0.04
"""The same for a power of ten, which takes an inertial from far away."""

WHOLE_ROBOT = 0.05
"""Part of the mass of all other links up to which that of one is the mass of the whole robot, written into a link: no
factor tells its own."""

MAX_PRODUCT_SHARE = 0.4
"""Largest product of inertia as a part of the smallest moment in a tensor that is corrected because it is impossible.
Four of five published links have less; a published tensor that is impossible for another reason becomes possible with
0.49."""


@dataclass(frozen=True)
class SuspectInertial:
    """An inertial that cannot be right, or hardly, and why, in words.

    ways: the changes that make it right, best first; unique: the one that is sure
    gain: by how much less strange the best of them makes it; twins: links that are like it afterwards
    """

    link: str
    inertial: etree._Element
    reason: str
    ways: tuple[Correction, ...]
    unique: Correction | None
    gain: float
    twins: tuple[str, ...] = ()


def numbers_of_body(inertial: etree._Element) -> InertialNumbers | None:
    """None without a mass or a tensor, and where squares are infinite."""
    found = inertial_numbers(inertial)
    if found is None or found.mass == 0 or not found.tensor.any():
        return None
    with np.errstate(all="ignore"):
        return found if np.isfinite([*(found.tensor @ found.tensor).flat, found.center @ found.center]).all() else None


@dataclass(frozen=True, eq=False)
class _Way:
    change: Correction
    numbers: InertialNumbers
    strangeness: float


def suspect_inertials(source: Source) -> list[SuspectInertial]:
    """The inertials of moving links that some change would make right, the surest first."""
    moving = carriers(source)
    elements = {
        name_of(link): inertial
        for link in source.links
        if (inertial := link.find("inertial")) is not None and moving.get(name_of(link)) is not None
    }
    read = {link: numbers_of_body(element) for link, element in elements.items()}
    numbers = {link: found for link, found in read.items() if found is not None}
    filled, _ = filled_links(source, list(numbers))
    around = surroundings(source, numbers, filled)
    measured = {link: measures(each, around[link]) for link, each in numbers.items()}
    related = twins(source, numbers, filled)
    found = list[SuspectInertial]()
    for link, given in numbers.items():
        usual = usual_among([measured[other] for other in numbers if other != link])
        rest = sum(numbers[other].mass for other in numbers if other != link)
        suspect = _Link(link, elements[link], given, around[link], usual, related.get(link, ()), rest).suspect()
        found += [suspect] if suspect is not None else []
    return sorted(found, key=lambda suspect: -suspect.gain)


@dataclass(frozen=True, eq=False)
class _Link:
    """rest: mass of all other links [kg]"""

    name: str
    element: etree._Element
    given: InertialNumbers
    around: LinkSurroundings
    usual: Mapping[str, Usual]
    twins: Sequence[Twin]
    rest: float

    def suspect(self) -> SuspectInertial | None:
        now = self._strangeness(self.given, -FEW_DIGITS)
        alike = [twin for twin in self.twins if twin.has(self.given)]
        unlike = [twin for twin in self.twins if twin not in alike and twin.views[0].is_possible(-FEW_DIGITS)]
        if now < inf and (alike or (now < DOUBTFUL and not unlike)):
            return None
        ways = sorted(self._ways(), key=lambda way: way.strangeness)
        found = self._of_twins(now, ways, unlike) if unlike else None
        return found or (self._alone(now, ways) if now >= DOUBTFUL else None)

    def _strangeness(self, numbers: InertialNumbers, least: float) -> float:
        return squares(measures(numbers, self.around), self.usual) if numbers.is_possible(least) else inf

    def _ways(self) -> Iterator[_Way]:
        for change in changes(self.element):
            new = numbers_of_body(change.applied(self.element))
            if new is not None and not same(new, self.given):
                yield _Way(change, new, self._strangeness(new, CLEARLY_POSITIVE))

    def _of_twins(self, now: float, ways: Sequence[_Way], unlike: Sequence[Twin]) -> SuspectInertial | None:
        """The change that makes the link like its twins, where these agree; those whose axes are known decide."""
        voting = [twin for twin in unlike if twin.sure_axes] or unlike
        reaching = [way for way in ways if all(twin.has(way.numbers) for twin in voting)]
        if not reaching:
            return None
        way = reaching[0]
        like = self._strangeness(way.numbers, -FEW_DIGITS)
        known = all(same(way.numbers, other.numbers) for other in reaching)
        others = [twin for twin in unlike if twin.has(way.numbers)]
        turns = way.change.turns
        several = len(others) > 1 and (not turns or (like <= now + CLEAR and sum(twin.near for twin in others) > 1))
        apart = now - like >= (WRONG - FITTING if turns else CLEAR) and like <= max(FITTING, FITTING_SHARE * now)
        better = apart and not way.change.enlarges and not way.change.of_center
        sure = known and like < inf and (several or now == inf or better)
        names = tuple(twin.link for twin in others)
        reason = f"{listed(names)} {'has' if len(names) == 1 else 'have'} other numbers"
        unique = way.change if sure else None
        return SuspectInertial(self.name, self.element, reason, (way.change,), unique, now - like, names)

    def _alone(self, now: float, ways: Sequence[_Way]) -> SuspectInertial | None:
        """The changes that bring the link to what is usual."""
        better = [way for way in ways if way.strangeness < now - CLEAR]
        if not better:
            return None
        best = better[0]
        close = [way for way in better if way.strangeness < best.strangeness + CLEAR]
        one = all(same(way.numbers, best.numbers) for way in close)
        simplest = min((way.change for way in close), key=lambda change: len(change.edits)) if one else best.change
        far = FAR_SHARE * now if now < inf and best.change.kind == "power of ten" else 0.0
        fits = best.strangeness <= max(FITTING, far) or self._tensor_fits(now, best)
        fits = fits or (now == inf and self._is_only_change(best))
        told_by = self.around.filled is not None or not self.given.is_placeholder
        whole = abs(self.given.mass - self.rest) <= WHOLE_ROBOT * self.rest and best.numbers.mass != self.given.mass
        sure = one and now >= WRONG and fits and told_by and not simplest.guessed and not whole
        reason = "no body has this tensor" if now == inf else worst(self.given, self.around, self.usual)
        told = (simplest,) if one else tuple(way.change for way in close)
        unique = simplest if sure else None
        return SuspectInertial(self.name, self.element, reason, told, unique, now - best.strangeness)

    def _tensor_fits(self, now: float, way: _Way) -> bool:
        """Whether a change of the tensor's axes makes it that of the shape, whatever mass and center of mass are."""
        found = measures(way.numbers, self.around)
        of_tensor: dict[str, float] = {name: found[name] for name in ("form", "scale") if name in found}
        turned = way.change.turns and not way.change.of_center
        clearly = now < inf and now - way.strangeness >= WRONG - FITTING
        return bool(of_tensor) and turned and clearly and squares(of_tensor, self.usual) <= FITTING

    def _is_only_change(self, way: _Way) -> bool:
        only = only_change(self.element)
        new = None if only is None else numbers_of_body(only.applied(self.element))
        return new is not None and same(new, way.numbers)


def only_change(inertial: etree._Element) -> Correction | None:
    """The only exchange of two entries, or sign of a moment, that makes an impossible tensor possible, if it leaves
    small products."""
    given = numbers_of_body(inertial)
    if given is None or given.is_possible(-FEW_DIGITS):
        return None
    tried = (
        (change, numbers_of_body(change.applied(inertial))) for change in changes(inertial) if change.mends_tensors
    )
    possible = [(change, new) for change, new in tried if new is not None and new.is_possible(CLEARLY_POSITIVE)]
    if not possible or not all(same(possible[0][1], new) for _, new in possible):
        return None
    change, new = possible[0]
    small = np.abs(np.triu(new.tensor, 1)).max() <= MAX_PRODUCT_SHARE * np.diagonal(new.tensor).min()
    return change if small else None
