"""The pairs of links between which an SRDF file switches collisions off."""

from __future__ import annotations

from collections.abc import Callable, Collection
from itertools import combinations
from pathlib import Path

from lxml import etree

from graphdyn import InvalidInput

MAX_SRDF_BYTES = 10_000_000
"""[bytes]"""


def disabled_pairs(path: Path, links: Collection[str]) -> Callable[[str, str], bool]:
    """Whether two links are disabled: by <disable_collisions>, or by default and not enabled.

    links: of the robot

    Raises InvalidInput for a file that is no SRDF, or of another robot; OSError.
    """
    robot = _robot(path)
    named = {tag: _pairs(robot, tag, path) for tag in ("disable_collisions", "enable_collisions")}
    by_default = {_attribute(element, "link", path) for element in robot.iterfind("disable_default_collisions")}
    mentioned = by_default.union(*named["disable_collisions"])
    if mentioned and mentioned.isdisjoint(links):
        raise InvalidInput(f"{path}: names none of the robot's links; give the SRDF of this robot")
    off = {
        frozenset(pair)
        for pair in combinations(sorted(links), 2)
        if frozenset(pair) in named["disable_collisions"]
        or (by_default.intersection(pair) and frozenset(pair) not in named["enable_collisions"])
    }
    return lambda one, other: frozenset((one, other)) in off


def _robot(path: Path) -> etree._Element:
    content = path.read_bytes()
    if len(content) > MAX_SRDF_BYTES:
        raise InvalidInput(f"{path}: is larger than {MAX_SRDF_BYTES // 1_000_000} MB; give an SRDF file")
    try:
        robot = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False))
    except etree.XMLSyntaxError as error:
        problem = " ".join(str(error.msg).split())
        raise InvalidInput(f"{path}: not well-formed XML: {problem}; give an SRDF file") from error
    if robot.tag != "robot":
        raise InvalidInput(f"{path}: the root element is <{robot.tag}>, not <robot>; give an SRDF file")
    return robot


def _pairs(robot: etree._Element, tag: str, path: Path) -> set[frozenset[str]]:
    return {
        frozenset((_attribute(element, "link1", path), _attribute(element, "link2", path)))
        for element in robot.iterfind(tag)
    }


def _attribute(element: etree._Element, name: str, path: Path) -> str:
    text = element.get(name)
    if not text:
        raise InvalidInput(f"{path}, line {element.sourceline}: <{element.tag}> has no {name}; name a link")
    return text
