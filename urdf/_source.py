"""One URDF file, reduced to the elements that describe dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import cast

from lxml import etree

from urdf._document import Document
from urdf._errors import TooLarge, URDFError
from urdf._wording import shortened

_RIGID = ("origin", "parent", "child")
_READ = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": (*_RIGID, "axis", "limit", "dynamics", "mimic"),
}
"""Per element, its children that are read. The others (visuals, transmissions, xacro leftovers, …) do not affect
dynamics."""

MOST_LINKS = 2000
"""Largest number of links, and of joints: dense matrices of more bodies fill gigabytes; the largest published robots
have some 200 links."""


@dataclass(frozen=True)
class Source:
    """A file and its <robot> element, without namespaces, comments and everything that is not read."""

    path: Path
    robot: etree._Element

    @property
    def links(self) -> list[etree._Element]:
        return self.robot.findall("link")

    @property
    def joints(self) -> list[etree._Element]:
        return self.robot.findall("joint")

    def error(self, kind: type[URDFError], code: str, element: etree._Element, problem: str, remedy: str) -> URDFError:
        """An error of this kind, with file, line and element."""
        return kind(problem, remedy, code=code, path=self.path, line=line_of(element), element=describe(element))


def reduced(document: Document) -> Source:
    """The document without the elements that are not read; its own tree is modified. Raises TooLarge."""
    robot = document.robot
    _reduce(robot)
    etree.cleanup_namespaces(robot)
    source = Source(document.path, robot)
    for what, number in (("links", len(source.links)), ("joints", len(source.joints))):
        if number > MOST_LINKS:
            raise TooLarge(
                f"the robot has {number} {what}, more than {MOST_LINKS}", "give a smaller robot", path=document.path
            )
    return source


def name_of(element: etree._Element) -> str:
    """Its attribute "name", empty where it has none."""
    return element.get("name", "")


def tag_of(element: etree._Element) -> str:
    """Its tag as written, whatever namespace xmlns="…" puts it into; empty for comments and for tags with a prefix.

    Pinocchio too compares tags as written, and URDF has no tags with a prefix.
    """
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) and element.prefix is None else ""


def line_of(element: etree._Element) -> int | None:
    return cast("int | None", element.sourceline)


def _reduce(element: etree._Element) -> None:
    """Drop the children that are not read and the namespaces of the others."""
    element.tag = tag_of(element)
    fixed = element.tag == "joint" and element.get("type") == "fixed"
    kept = _RIGID if fixed else _READ.get(element.tag, ())
    for child in list(element):
        if tag_of(child) in kept:
            _reduce(child)
        else:
            element.remove(child)


def describe(element: etree._Element) -> str:
    """The element by name: "link 'wrist'", "<mass> of link 'wrist'"."""
    above = (element, *element.iterancestors())
    owner = next((e for e in above if tag_of(e) in ("robot", "link", "joint")), element)
    tag = tag_of(owner)
    named = f"{tag} '{shortened(name_of(owner))}'" if name_of(owner) else f"<{tag}>"
    return named if owner is element else f"<{tag_of(element)}> of {named}"
