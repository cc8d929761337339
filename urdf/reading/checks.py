"""The strict pass over one file, before yourdfpy parses it.

yourdfpy fills in missing values silently (1 for ixx, 0 for a mass), takes the first of several elements and has no line
numbers. Everything it would guess is refused here.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

from lxml import etree

from urdf.document.elements import line_said, name_of
from urdf.document.numbers import MAX_NUMBER, MIN_AXIS_LENGTH, BadNumber, numbers
from urdf.document.source import Source
from urdf.document.vocabulary import ATTRIBUTES, NUMBERS
from urdf.errors import (
    DuplicateEntry,
    InvalidNumber,
    InvalidRobot,
    MissingEntry,
    UnsupportedJoint,
    URDFError,
    shortened,
)
from urdf.reading.repairing import crossed_limits

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed")

_REQUIRED_CHILDREN = {"inertial": ("mass", "inertia"), "joint": ("parent", "child")}
_REQUIRED_ATTRIBUTES = {tag: ATTRIBUTES[tag] for tag in ("mass", "inertia", "axis", "parent", "child")}

_COMPUTED = ("origin", "mass", "inertia", "axis")
"""Elements that dynamics are computed from, held to MAX_NUMBER; a limit may be the largest double."""


def faults(source: Source) -> Iterator[URDFError]:
    """Every fault of the file: MissingEntry, DuplicateEntry, InvalidNumber, InvalidRobot or UnsupportedJoint."""
    yield from _name_faults(source, source.robot)
    if not source.links:
        problem, remedy = "there is no <link>", "expand the file with xacro if it is a xacro file"
        yield source.error(MissingEntry, "no-links", source.robot, problem, remedy)
    for elements in (source.links, source.joints):
        yield from _repeated_names(source, elements)
    for link in source.links:
        yield from _part_faults(source, link)
    for joint in source.joints:
        yield from _type_faults(source, joint)
        yield from _limit_faults(source, joint)
        yield from _part_faults(source, joint)


def _name_faults(source: Source, element: etree._Element) -> Iterator[URDFError]:
    if not name_of(element):
        yield source.error(
            MissingEntry, "missing-name", element, "attribute 'name' is missing or empty", "give it a name"
        )


def _repeated_names(source: Source, elements: list[etree._Element]) -> Iterator[URDFError]:
    lines: dict[str, str] = {}
    for element in elements:
        yield from _name_faults(source, element)
        name = name_of(element)
        if name and name in lines:
            problem = f"the name is already used in {lines[name]}"
            yield source.error(DuplicateEntry, "duplicate-name", element, problem, "rename one of the two")
        lines.setdefault(name, line_said(element))


def _type_faults(source: Source, joint: etree._Element) -> Iterator[URDFError]:
    kind = joint.get("type")
    if kind is None:
        yield source.error(
            MissingEntry, "missing-type", joint, "attribute 'type' is missing", f"use one of {', '.join(JOINT_TYPES)}"
        )
    elif kind not in JOINT_TYPES:
        problem = f"type '{shortened(kind)}' is not supported"
        remedy = f"use one of {', '.join(JOINT_TYPES)}, or replace it by several of them"
        yield source.error(UnsupportedJoint, "unsupported-joint", joint, problem, remedy)


def _limit_faults(source: Source, joint: etree._Element) -> Iterator[URDFError]:
    crossed, limit = crossed_limits(joint), joint.find("limit")
    if crossed is not None and limit is not None:
        problem = f"lower limit {crossed[0]:g} is above upper limit {crossed[1]:g}"
        remedy = "swap them, or load the file with repair=['limits'] (--repair limits)"
        yield source.error(InvalidRobot, "limits-crossed", limit, problem, remedy)


def _part_faults(source: Source, element: etree._Element) -> Iterator[URDFError]:
    """Faults of the elements within a link or a joint: missing, repeated, or without valid numbers."""
    tags = Counter(child.tag for child in element)
    for tag in _REQUIRED_CHILDREN.get(element.tag, ()):
        if tag not in tags:
            yield source.error(
                MissingEntry, f"missing-{tag}", element, f"<{tag}> is missing", "write it; nothing is assumed for it"
            )
    for child in element:
        number = tags.pop(child.tag, 1)  # so that each is reported once
        if number > 1:
            problem = f"{number} elements <{child.tag}>"
            yield source.error(DuplicateEntry, "duplicate-element", element, problem, "keep the one that is meant")
        yield from _attribute_faults(source, child)
        yield from _part_faults(source, child)


def _attribute_faults(source: Source, element: etree._Element) -> Iterator[URDFError]:
    for name in _REQUIRED_ATTRIBUTES.get(element.tag, ()):
        if element.get(name) is None:
            problem = f"attribute '{name}' is missing"
            remedy = "write it; nothing is assumed for it"
            yield source.error(MissingEntry, f"missing-{element.tag}", element, problem, remedy)
    if element.get("quat_xyzw") is not None and element.tag == "origin":
        problem, remedy = "attribute 'quat_xyzw' is not read", "give the rotation as rpy"
        yield source.error(InvalidRobot, "quaternion-origin", element, problem, remedy)
    for name, count in NUMBERS.get(element.tag, {}).items():
        text = element.get(name)
        found = None if text is None else numbers(text, count, f'{name}="{shortened(text)}"')
        if found is None:
            continue
        if isinstance(found, BadNumber):
            yield source.error(InvalidNumber, found.code, element, found.problem, found.remedy)
        elif element.tag in _COMPUTED and max(map(abs, found)) > MAX_NUMBER:
            problem = f'{name}="{shortened(text or "")}" is too large for a robot: results would overflow'
            yield source.error(InvalidNumber, "number-too-large", element, problem, "give kg, m and rad")
        elif element.tag == "mass" and found[0] < 0:
            problem = f"mass {found[0]} kg is negative"
            yield source.error(InvalidNumber, "negative-mass", element, problem, "give a mass of at least 0")
        elif element.tag == "axis" and math.hypot(*found) < MIN_AXIS_LENGTH:
            problem = f"the axis has length {math.hypot(*found):.3g}, too short to normalize"
            problem = problem if any(found) else "the axis is zero"
            yield source.error(InvalidNumber, "zero-axis", element, problem, "give a direction")
