"""The strict pass over one file, before yourdfpy parses it.

yourdfpy fills in silently (a missing ixx becomes 1, a missing mass 0), takes the first of several elements and has no
line numbers. Everything it would guess is refused here.
"""

from __future__ import annotations

import math
import re

from lxml import etree

from urdf.errors import DuplicateEntry, InvalidNumber, MissingEntry, UnsupportedJoint
from urdf.source import Source, line_of, name_of

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed")

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_UNEXPANDED = re.compile(r"\$[{(]")

_REQUIRED_CHILDREN = {"inertial": ("mass", "inertia"), "joint": ("parent", "child")}
_REQUIRED_ATTRIBUTES = {
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "axis": ("xyz",),
    "parent": ("link",),
    "child": ("link",),
}
_NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(_REQUIRED_ATTRIBUTES["inertia"], 1),
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "velocity": 1, "effort": 1},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
}
"""How many numbers each attribute holds."""


def check(source: Source) -> None:
    """Raise MissingEntry, DuplicateEntry, InvalidNumber or UnsupportedJoint for the first fault in the file."""
    _check_name(source, source.robot)
    if not source.links:
        raise source.error(
            MissingEntry, source.robot, "there is no <link>", "expand the file with xacro if it is a xacro file"
        )
    for elements in (source.links, source.joints):
        _check_unique_names(source, elements)
    for link in source.links:
        _check_parts(source, link)
    for joint in source.joints:
        _check_type(source, joint)
        _check_parts(source, joint)


def _check_name(source: Source, element: etree._Element) -> None:
    if not name_of(element):
        raise source.error(MissingEntry, element, "attribute 'name' is missing or empty", "give it a name")


def _check_unique_names(source: Source, elements: list[etree._Element]) -> None:
    lines: dict[str, int | None] = {}
    for element in elements:
        _check_name(source, element)
        name = name_of(element)
        if name in lines:
            raise source.error(
                DuplicateEntry, element, f"the name is used already in line {lines[name]}", "rename one of the two"
            )
        lines[name] = line_of(element)


def _check_type(source: Source, joint: etree._Element) -> None:
    kind = joint.get("type")
    if kind is None:
        raise source.error(MissingEntry, joint, "attribute 'type' is missing", f"use one of {', '.join(JOINT_TYPES)}")
    if kind not in JOINT_TYPES:
        raise source.error(
            UnsupportedJoint,
            joint,
            f"type '{kind}' is not supported",
            f"use one of {', '.join(JOINT_TYPES)}, or replace it by several of them",
        )


def _check_parts(source: Source, element: etree._Element) -> None:
    """Everything below a link or a joint: presence, uniqueness, numbers."""
    tags = [child.tag for child in element]
    for tag in _REQUIRED_CHILDREN.get(element.tag, ()):
        if tag not in tags:
            raise source.error(MissingEntry, element, f"<{tag}> is missing", "write it; nothing is assumed for it")
    for child in element:
        if tags.count(child.tag) > 1:
            raise source.error(
                DuplicateEntry, element, f"{tags.count(child.tag)} elements <{child.tag}>", "keep the one that is meant"
            )
        _check_attributes(source, child)
        _check_parts(source, child)


def _check_attributes(source: Source, element: etree._Element) -> None:
    for name in _REQUIRED_ATTRIBUTES.get(element.tag, ()):
        if element.get(name) is None:
            raise source.error(
                MissingEntry, element, f"attribute '{name}' is missing", "write it; nothing is assumed for it"
            )
    for name, count in _NUMBERS.get(element.tag, {}).items():
        values = _numbers(source, element, name, count)
        if element.tag == "mass" and values[0] < 0:
            raise source.error(InvalidNumber, element, f"mass {values[0]} kg is negative", "give a mass of at least 0")
        if element.tag == "axis" and not any(values):
            raise source.error(InvalidNumber, element, "the axis is zero", "give a direction")


def _numbers(source: Source, element: etree._Element, attribute: str, count: int) -> list[float]:
    """The finite numbers of an attribute, [0] * count where it is absent."""
    text = element.get(attribute)
    if text is None:
        return [0.0] * count
    said = f'{attribute}="{text}"'
    if _UNEXPANDED.search(text):
        raise source.error(InvalidNumber, element, f"{said} is not expanded", "expand the file with xacro")
    words = text.split()
    if len(words) != count:
        raise source.error(
            InvalidNumber, element, f"{said} has {len(words)} entries, expected {count}", "separate numbers by spaces"
        )
    for word in words:
        if word.lower().lstrip("+-") in ("nan", "inf", "infinity"):
            raise source.error(
                InvalidNumber, element, f"{said} is not finite", "give a finite number, or leave it out where optional"
            )
        if not _NUMBER.fullmatch(word):
            raise source.error(InvalidNumber, element, f"{said}: '{word}' is not a number", "correct the number")
        if not math.isfinite(float(word)):
            raise source.error(InvalidNumber, element, f"{said}: '{word}' overflows", "correct the number")
    return [float(word) for word in words]
