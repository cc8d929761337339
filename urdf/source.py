"""One URDF file as XML: read strictly, reduced to the elements that describe dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from lxml import etree

from urdf.errors import MalformedXML, URDFError

_RIGID = ("origin", "parent", "child")
_READ = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": (*_RIGID, "axis", "limit", "dynamics", "mimic"),
}
"""The children that are read. The rest (visuals, transmissions, xacro leftovers, …) says nothing of dynamics."""


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

    def error(self, kind: type[URDFError], element: etree._Element, problem: str, remedy: str) -> URDFError:
        """The refusal of this kind, with file, line and element."""
        return kind(problem, remedy, path=self.path, line=line_of(element), element=_describe(element))


def read(path: Path) -> Source:
    """The file at path. Raises MalformedXML where yourdfpy would fall back on a parser that guesses."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    try:
        robot = etree.fromstring(path.read_bytes(), parser)
    except etree.XMLSyntaxError as error:
        raise MalformedXML(
            f"not well-formed XML: {error.msg}", "repair the file with an XML editor", path=path, line=error.lineno
        ) from error
    name = etree.QName(robot)
    if name.localname != "robot":
        raise MalformedXML(
            f"the root element is <{name.localname}>, not <robot>", "give a URDF file", path=path, line=line_of(robot)
        )
    grammar: Any = robot.getroottree().docinfo.internalDTD
    if grammar is not None and grammar.entities():
        raise MalformedXML("the document declares XML entities", "write their text instead", path=path)
    _reduce(robot, "" if name.namespace is None else f"{{{name.namespace}}}")
    etree.cleanup_namespaces(robot)
    return Source(path, robot)


def name_of(element: etree._Element) -> str:
    """Its attribute "name", empty where it has none."""
    return element.get("name", "")


def line_of(element: etree._Element) -> int | None:
    return cast("int | None", element.sourceline)


def _reduce(element: etree._Element, namespace: str) -> None:
    """Drop the children that are not read and the namespace (of the root) from the names of the others."""
    element.tag = element.tag.removeprefix(namespace)
    fixed = element.tag == "joint" and element.get("type") == "fixed"
    kept = {namespace + tag for tag in (_RIGID if fixed else _READ.get(element.tag, ()))}
    for child in list(element):
        if child.tag in kept:
            _reduce(child, namespace)
        else:
            element.remove(child)


def _describe(element: etree._Element) -> str:
    """The element by name: "link 'wrist'", "<mass> of link 'wrist'"."""
    owner = next((e for e in (element, *element.iterancestors()) if e.tag in ("robot", "link", "joint")), element)
    named = f"{owner.tag} '{name_of(owner)}'" if name_of(owner) else f"<{owner.tag}>"
    return named if owner is element else f"<{element.tag}> of {named}"
