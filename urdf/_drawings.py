"""The elements that draw a robot: <visual> and <collision> of its links, and the materials that they name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from lxml import etree

from urdf._elements import line_of, name_of, tag_of

Geometry = Literal["visual", "collision"]
GEOMETRIES: tuple[Geometry, ...] = ("visual", "collision")


@dataclass(frozen=True)
class Drawing:
    """A <visual> or <collision>, and the name of its link."""

    link: str
    geometry: Geometry
    element: etree._Element

    @property
    def line(self) -> int | None:
        """Of the file, if known."""
        return line_of(self.element) or None

    @property
    def mesh(self) -> bool:
        """Whether it names a mesh file."""
        return any(tag_of(shape) == "mesh" for inside in children(self.element, "geometry") for shape in inside)


@dataclass(frozen=True)
class Drawings:
    """All of a file. materials: those defined in <robot>, by name; the first of each."""

    drawings: tuple[Drawing, ...] = ()
    materials: Mapping[str, etree._Element] = field(default_factory=dict)


def drawings(robot: etree._Element) -> Drawings:
    """Of a document that still has all its elements."""
    found = [
        Drawing(name_of(link), geometry, element)
        for link in children(robot, "link")
        for geometry in GEOMETRIES
        for element in children(link, geometry)
    ]
    materials: dict[str, etree._Element] = {}
    for material in children(robot, "material"):
        materials.setdefault(name_of(material), material)
    return Drawings(tuple(found), materials)


def children(parent: etree._Element, tag: str) -> Iterator[etree._Element]:
    """The children with this tag, comments and other namespaces left out."""
    return (child for child in parent if tag_of(child) == tag)
