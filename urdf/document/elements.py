"""Elements of an XML document: their tag, name and line, and how messages call them.

The elements that draw a robot: <visual> and <collision> of its links, and the materials that they name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, cast

from lxml import etree

from urdf.errors import shortened


def name_of(element: etree._Element) -> str:
    """Its attribute "name", empty where it has none."""
    return element.get("name", "")


def tag_of(element: etree._Element) -> str:
    """Its tag as written, whatever namespace xmlns="…" puts it into; empty for comments and for tags with a prefix.

    Pinocchio too compares tags as written, and URDF has no tags with a prefix.
    """
    tag = element.tag
    if not isinstance(tag, str):
        return ""
    if not tag.startswith("{"):
        return tag
    return tag.rpartition("}")[2] if element.prefix is None else ""


def written_tag(element: etree._Element) -> str:
    """Its tag as written, with its prefix; empty for comments."""
    tag = element.tag
    local = tag.rpartition("}")[2] if isinstance(tag, str) else ""
    return local if element.prefix is None else f"{element.prefix}:{local}"


FILE = "{graphdyn}file"
"""Attribute of an element that stands in another file than the document: an included one."""


def line_of(element: etree._Element) -> int | None:
    """The line where its tag begins, in the file where it stands; None where it is not known."""
    return cast("int | None", element.sourceline) or None


def file_of(element: etree._Element) -> str | None:
    """The file where it stands; None for that of the document."""
    return element.get(FILE)


def line_said(element: etree._Element) -> str:
    """ "line 12", "line 12 of parts/wrist.xacro"; "an unknown line"."""
    line, file = line_of(element), file_of(element)
    where = "an unknown line" if line is None else f"line {line}"
    return where if file is None else f"{where} of {file}"


def describe(element: etree._Element) -> str:
    """The element by name: "link 'wrist'", "<mass> of link 'wrist'"."""
    above = (element, *element.iterancestors())
    owner = next((e for e in above if tag_of(e) in ("robot", "link", "joint")), element)
    tag = tag_of(owner)
    named = f"{tag} '{shortened(name_of(owner))}'" if name_of(owner) else f"<{tag}>"
    return named if owner is element else f"<{shortened(written_tag(element))}> of {named}"


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
        """Line of the file, if known."""
        return line_of(self.element)

    @property
    def mesh_file(self) -> str | None:
        """The mesh file that it names, as written; None for other shapes."""
        shapes = (shape for inside in children(self.element, "geometry") for shape in inside)
        return next((shape.get("filename", "") for shape in shapes if tag_of(shape) == "mesh"), None)

    @property
    def shape(self) -> tuple[str, ...]:
        """What is drawn, as written: the kind, and its file or sizes."""
        shapes = (shape for inside in children(self.element, "geometry") for shape in inside)
        return next(((tag_of(shape), *map(str, shape.attrib.values())) for shape in shapes), ())

    @property
    def mesh(self) -> bool:
        """Whether it names a mesh file."""
        return self.mesh_file is not None


@dataclass(frozen=True)
class Drawings:
    """All of a file. materials: those defined in <robot>, by name; the first of each."""

    drawings: tuple[Drawing, ...] = ()
    materials: Mapping[str, etree._Element] = field(default_factory=dict)


def drawings(robot: etree._Element) -> Drawings:
    """Drawings of a document that still has all its elements."""
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
    return (child for child in parent.iterchildren(f"{{*}}{tag}") if child.prefix is None)
