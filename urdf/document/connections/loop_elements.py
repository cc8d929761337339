"""Elements that close loops or couple joints, of the forms that are read; urdf.document.vocabulary has their sources.

The types "spherical" and "distance" of <loop> are additions of ours, which urdf.save writes; the type "link" of
<constraint> joins two frames rigidly. All elements state the axis in the frames that meet, with the same components in
both, and take (1, 0, 0) for a missing one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Mapping

import numpy as np
from lxml import etree

from graphdyn import Placement
from graphdyn.model import ChordKind
from urdf.document.connections.loops import CoupledSums, Loop, SourceLocation
from urdf.document.elements import name_of, written_tag
from urdf.document.numbers import MAX_NUMBER, MIN_AXIS_LENGTH, BadNumber, numbers, rotation_from_rpy
from urdf.errors import InvalidLoop, UnsupportedConstraint, URDFError, shortened

Kinds = Mapping[str, ChordKind]

LOOP_JOINT_KINDS: Kinds = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "fixed": "weld"}
LOOP_KINDS: Kinds = {**LOOP_JOINT_KINDS, "spherical": "ball", "distance": "distance"}
CONSTRAINT_KINDS: Kinds = {
    **dict.fromkeys(("revolute", "revolute_joint"), "hinge"),
    **dict.fromkeys(("prismatic", "prismatic_joint"), "slide"),
    **dict.fromkeys(("spherical", "spherical_joint"), "ball"),
    "link": "weld",
}
"""Constraint kinds by the type of an element: the kind of chord."""

DEFAULT_AXIS = (1.0, 0.0, 0.0)


def read(
    element: etree._Element, links: Container[str], place: SourceLocation
) -> Loop | CoupledSums | URDFError | None:
    """What an element of <robot> says; the error where it is malformed, None where it is of no form that is read.

    links: names of all links of the robot
    """
    form = ELEMENT_READERS.get(written_tag(element))
    if form is None:
        return None
    try:
        return form(_ElementReader(element, links, place))
    except URDFError as fault:
        return fault


class _ElementReader:
    """One element, part by part; raises InvalidLoop where a part is missing or malformed."""

    def __init__(self, element: etree._Element, links: Container[str], place: SourceLocation) -> None:
        self.element, self.links, self.place = element, links, place

    def fault(self, problem: str, remedy: str) -> URDFError:
        called = f"'{shortened(name_of(self.element))}': " if name_of(self.element) else ""
        return self.place.error(InvalidLoop, f"{called}{problem}", remedy)

    def name(self) -> str:
        if not name_of(self.element):
            raise self.fault("attribute 'name' is missing or empty", "give it a name")
        return name_of(self.element)

    def kind(self, kinds: Kinds) -> ChordKind:
        stated, known = self.element.get("type"), ", ".join(kinds)
        if stated is None:
            raise self.fault("attribute 'type' is missing", f"use one of {known}")
        if stated not in kinds:
            problem = f"'{shortened(name_of(self.element))}': type '{shortened(stated)}' is not modeled"
            remedy = f"use one of {known}, or replace it by several links and joints"
            raise self.place.error(UnsupportedConstraint, problem, remedy)
        return kinds[stated]

    def part(self, tag: str) -> etree._Element:
        found = self.optional(tag)
        if found is None:
            raise self.fault(f"<{tag}> is missing", "write it; nothing is assumed for it")
        return found

    def optional(self, tag: str, above: etree._Element | None = None) -> etree._Element | None:
        parent = self.element if above is None else above
        found = [child for child in parent.iterchildren(etree.Element) if written_tag(child) == tag]
        if len(found) > 1:
            raise self.fault(f"{len(found)} elements <{tag}>", "keep the one that is meant")
        return found[0] if found else None

    def link(self, part: etree._Element, attribute: str = "link") -> str:
        name, tag = part.get(attribute), written_tag(part)
        if not name:
            raise self.fault(f"<{tag}> names no link", f"write the attribute '{attribute}'")
        if name not in self.links:
            raise self.fault(f"link '{shortened(name)}' of <{tag}> does not exist", "correct the name or add the link")
        return name

    def numbers(self, part: etree._Element, attribute: str, count: int) -> list[float] | None:
        text = part.get(attribute)
        if text is None:
            return None
        found = numbers(text, count, f'{attribute}="{shortened(text)}" of <{written_tag(part)}>')
        if isinstance(found, BadNumber):
            raise self.fault(found.problem, found.remedy)
        if max(map(abs, found)) > MAX_NUMBER:
            raise self.fault(f'{attribute}="{shortened(text)}" is too large for a robot', "give m and rad")
        return found

    def placement(self, part: etree._Element | None) -> Placement:
        """Placement of an element with xyz and rpy; the identity where there is none."""
        if part is None:
            return Placement()
        if part.get("quat_xyzw") is not None:
            raise self.fault("attribute 'quat_xyzw' is not read", "give the rotation as rpy")
        xyz, rpy = self.numbers(part, "xyz", 3), self.numbers(part, "rpy", 3)
        return Placement(rotation_from_rpy(*rpy) if rpy else np.eye(3), np.array(xyz or (0.0, 0.0, 0.0)))

    def axis(self, tag: str, kind: ChordKind) -> tuple[float, ...]:
        part = self.optional(tag)
        if part is None:
            return DEFAULT_AXIS if kind in ("hinge", "slide") else (0.0, 0.0, 1.0)
        axis = self.stated(part, "xyz", 3)
        if math.hypot(*axis) < MIN_AXIS_LENGTH:
            raise self.fault(f"<{tag}> is zero", "give a direction")
        return tuple(axis)

    def number(self, tag: str) -> float:
        return self.stated(self.part(tag), "value", 1)[0]

    def point(self, tag: str) -> Placement:
        return Placement(translation=np.array(self.stated(self.part(tag), "value", 3)))

    def stated(self, part: etree._Element, attribute: str, count: int) -> list[float]:
        found = self.numbers(part, attribute, count)
        if found is None:
            problem = f"<{written_tag(part)}> has no attribute '{attribute}'"
            raise self.fault(problem, "write it; nothing is assumed for it")
        return found

    def joined(self, link_i: str, link_j: str) -> tuple[str, str]:
        if link_i == link_j:
            raise self.fault(f"both ends are on link '{shortened(link_i)}'", "name two links")
        return link_i, link_j


def _loop(reader: _ElementReader) -> Loop:
    name, kind = reader.name(), reader.kind(LOOP_KINDS)
    ends = (reader.part("predecessor"), reader.part("successor"))
    link_i, link_j = reader.joined(*map(reader.link, ends))
    at_i, at_j = (reader.placement(reader.optional("origin", end)) for end in ends)
    length = reader.number("length") if kind == "distance" else None
    if length is not None and length <= 0:
        raise reader.fault(f"the length is {length:g} m", "give a positive one, or use type 'spherical'")
    return Loop(name, kind, link_i, link_j, at_i, at_j, reader.axis("axis", kind), length)


def _coupling(reader: _ElementReader) -> CoupledSums:
    name = reader.name()
    predecessor, successor = reader.joined(*(reader.link(reader.part(tag)) for tag in ("predecessor", "successor")))
    ratio = reader.number("ratio")
    if ratio == 0:
        raise reader.fault("the ratio is 0", "lock the joints instead (lock=, --lock), or give the ratio")
    return CoupledSums(name, predecessor, successor, ratio)


def _loop_joint(reader: _ElementReader) -> Loop:
    name, kind = reader.name(), reader.kind(LOOP_JOINT_KINDS)
    ends = (reader.part("link1"), reader.part("link2"))
    link_i, link_j = reader.joined(*map(reader.link, ends))
    at_i, at_j = map(reader.placement, ends)
    return Loop(name, kind, link_i, link_j, at_i, at_j, reader.axis("axis", kind))


def _constraint(reader: _ElementReader) -> Loop:
    name, kind = reader.name(), reader.kind(CONSTRAINT_KINDS)
    link_i, link_j = reader.joined(*(reader.link(reader.part(tag)) for tag in ("parent", "child")))
    at_i, at_j = (reader.placement(reader.optional(tag)) for tag in ("parent_origin", "child_origin"))
    axis = reader.axis("parent_axis", kind)
    if reader.optional("child_axis") is not None and reader.axis("child_axis", kind) != axis:
        raise reader.fault(
            "<child_axis> differs from <parent_axis>", "turn <child_origin> until the axis is the same in both frames"
        )
    return Loop(name, kind, link_i, link_j, at_i, at_j, axis)


def _ball(reader: _ElementReader) -> Loop:
    body, point = "drake:ball_constraint_body_", "drake:ball_constraint_p_"
    link_i, link_j = reader.joined(*(reader.link(reader.part(body + end), "name") for end in "AB"))
    at_i, at_j = (reader.point(point + points) for points in ("AP", "BQ"))
    return Loop(name_of(reader.element) or f"{link_i}-{link_j}", "ball", link_i, link_j, at_i, at_j)


ELEMENT_READERS: Mapping[str, Callable[[_ElementReader], Loop | CoupledSums]] = {
    "loop": _loop,
    "coupling": _coupling,
    "loop_joint": _loop_joint,
    "constraint": _constraint,
    "drake:ball_constraint": _ball,
}
"""Element readers by tag, as written in <robot>."""
