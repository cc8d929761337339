"""Connections that close loops, between links by name, as files and callers state them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike

from graphdyn import Chord, InvalidModel, Placement
from graphdyn.display import short_repr
from graphdyn.model import ChordKind
from urdf.document.elements import describe, file_of, line_of
from urdf.errors import URDFError


@dataclass(frozen=True, eq=False)
@short_repr
class Loop:
    """A connection that closes a loop: what graphdyn.Chord is between bodies, between links.

    kind: "hinge", "ball", "slide", "weld" or "distance", as in graphdyn.Chord
    link_i, link_j: names of the links; the name of a joint stands for the link that it carries
    placement_i, placement_j: the frames that meet, in these links
    axis: of a hinge or slide, in both frames               (3,)
    length: of a distance                                   [m]

    Raises InvalidModel for what graphdyn.Chord refuses, and for links that are not given by name.
    """

    name: str
    kind: ChordKind
    link_i: str
    link_j: str
    placement_i: Placement = field(default_factory=Placement)
    placement_j: Placement = field(default_factory=Placement)
    axis: ArrayLike = (0.0, 0.0, 1.0)
    length: float | None = None

    def __post_init__(self) -> None:
        if not all(isinstance(name, str) for name in (self.name, self.link_i, self.link_j)):
            raise InvalidModel(f"loop {self.name!r}: its name and those of its links must be strings")
        self.chord((0, Placement()), (1, Placement()))

    def chord(self, on_i: tuple[int, Placement], on_j: tuple[int, Placement]) -> Chord:
        """This loop between two bodies: per link, its body and its placement in the link frame of that body."""
        for placement in (self.placement_i, self.placement_j):
            if not isinstance(placement, Placement):
                raise InvalidModel(f"loop '{self.name}': a placement is of type {type(placement).__name__}")
        at_i, at_j = on_i[1] @ self.placement_i, on_j[1] @ self.placement_j
        return Chord(self.name, self.kind, on_i[0], at_i, on_j[0], at_j, np.asarray(self.axis), self.length)


@dataclass(frozen=True)
class CoupledSums:
    """Two sums of joint positions, each from the nearest common ancestor of two links down to one of them:

    that of the successor is ratio times that of the predecessor (<coupling> of URDF+).
    """

    name: str
    predecessor: str
    successor: str
    ratio: float


@dataclass(frozen=True)
class SourceLocation:
    """Place of a statement; element: as messages call it."""

    path: Path
    line: int | None
    element: str | None

    def error(self, kind: type[URDFError], problem: str, remedy: str) -> URDFError:
        return kind(problem, remedy, path=self.path, line=self.line, element=self.element)


def place_of(element: etree._Element, path: Path) -> SourceLocation:
    """Place of an element of the document at path."""
    file = file_of(element)
    return SourceLocation(path if file is None else Path(file), line_of(element), describe(element))


@dataclass(frozen=True, eq=False)
class Closure:
    """Something that closes a loop, couples joints or joins links.

    problem: what it does; links: those that it names
    says: what of it is read; an error where it is malformed, None where nothing of its kind is read
    """

    place: SourceLocation
    problem: str
    links: frozenset[str]
    says: Loop | CoupledSums | URDFError | None


@dataclass(frozen=True)
class Motor:
    """A joint that a file says is driven by a motor."""

    joint: str
    place: SourceLocation


@dataclass(frozen=True)
class Unread:
    """Something that is not read, at one or more places; element, line, file: the first.

    file: where the line is, if not in the file that is read
    """

    problem: str
    element: str = ""
    line: int | None = None
    file: str | None = None
    code: str = "unread-dynamics"
    places: int = 1


@dataclass(frozen=True, eq=False)
class CompanionFiles:
    """What is stated beside a file: loops, by links or joints, motors, and what is not read."""

    loops: tuple[tuple[Loop, SourceLocation], ...] = ()
    motors: tuple[Motor, ...] = ()
    unread: tuple[Unread, ...] = ()
