"""One URDF file, reduced to the elements that describe dynamics."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from lxml import etree

from urdf.document.connections.loops import place_of
from urdf.document.document import Document
from urdf.document.elements import Drawings, children, drawings, tag_of
from urdf.document.extensions import Extensions, extensions
from urdf.document.vocabulary import FIXED_JOINT_CHILDREN, READ_CHILDREN
from urdf.errors import TooLarge, URDFError

MAX_LINKS = 2000
"""Largest number of links, and of joints: dense matrices of more bodies fill gigabytes; the largest published robots
have some 200 links."""


@dataclass(frozen=True)
class Source:
    """A file and its <robot> element, without namespaces, comments and everything that is not read.

    extensions: what of the rest affects dynamics; drawings: what of the rest draws the robot
    from_geoms: bodies of an MJCF file whose inertia is computed from geoms; None for other files
    """

    path: Path
    robot: etree._Element
    extensions: Extensions
    drawings: Drawings
    from_geoms: tuple[str, ...] | None = None

    @property
    def links(self) -> list[etree._Element]:
        return self.robot.findall("link")

    @property
    def joints(self) -> list[etree._Element]:
        return self.robot.findall("joint")

    def error(self, kind: type[URDFError], code: str, element: etree._Element, problem: str, remedy: str) -> URDFError:
        """An error of this kind, with file, line and element."""
        place = place_of(element, self.path)
        return kind(problem, remedy, code=code, path=place.path, line=place.line, element=place.element)


def reduced(document: Document) -> Source:
    """The document without the elements that are not read; its own tree is modified. Raises TooLarge."""
    robot = document.robot
    for what in ("link", "joint"):
        number = sum(1 for _ in children(robot, what))
        if number > MAX_LINKS:
            problem = f"the robot has {number} {what}s, more than {MAX_LINKS}"
            raise TooLarge(problem, "give a smaller robot", path=document.path)
    beside, drawn = extensions(robot, document.path), drawings(robot)
    if document.beyond is not None:
        beside = replace(beside, unread=(*beside.unread, *document.beyond.unread))
    _reduce(robot)
    etree.cleanup_namespaces(robot)
    return Source(document.path, robot, beside, drawn, None if document.beyond is None else document.beyond.computed)


def _reduce(element: etree._Element) -> None:
    """Drop the children that are not read and the namespaces of the others."""
    element.tag = tag_of(element)
    fixed = element.tag == "joint" and element.get("type") == "fixed"
    kept = FIXED_JOINT_CHILDREN if fixed else READ_CHILDREN.get(element.tag, ())
    for child in list(element):
        if tag_of(child) in kept:
            _reduce(child)
        else:
            element.remove(child)
