"""<coupling> of URDF+ as sums of joints, and which joints of a robot with loops have motors."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

from lxml import etree

from urdf.document.connections.loops import Closure, CompanionFiles, CoupledSums, Motor, SourceLocation, Unread
from urdf.document.elements import name_of
from urdf.document.source import Source
from urdf.document.tree import joint_into, path_up
from urdf.errors import InvalidLoop, listed, shortened

INDEPENDENT_VALUES = {"true": True, "1": True, "false": False, "0": False}
"""Independent values by the lower-case text of the attribute independent= of a joint."""


@dataclass(frozen=True)
class Relation:
    """A joint that others drive: its position is Σ ratio × theirs + offset.

    cause: what says so, in words; instead: what could be done about it
    """

    joint: str
    ratios: Mapping[str, float]
    offset: float
    cause: str
    instead: str
    place: SourceLocation


def relations(source: Source, closures: Sequence[Closure], taken: Container[str]) -> Iterator[Relation]:
    """One for each coupling between links of the source, a valid tree, unless all joints on its way are fixed.

    A coupling drives the joint nearest to the successor that is marked independent="false", or where none is, the
    nearest that is not marked "true"; not one that is driven already. taken: joints that mimic others

    Raises InvalidLoop where no joint is left to drive, for sums of angles and lengths, and for an attribute
    independent= that is neither true nor false.
    """
    into, links = joint_into(source), {name_of(link) for link in source.links}
    driven: set[str] = set()
    for closure in closures:
        sums, place = closure.says, closure.place
        if not isinstance(sums, CoupledSums) or not {sums.predecessor, sums.successor} <= links:
            continue
        above, below = path_up(into, sums.predecessor), path_up(into, sums.successor)
        to_successor = [joint for joint in below if joint not in above and joint.get("type") != "fixed"]
        to_predecessor = [joint for joint in above if joint not in below and joint.get("type") != "fixed"]
        for way in (to_successor, to_predecessor):
            if len({joint.get("type") == "prismatic" for joint in way}) > 1:
                problem = f"'{shortened(sums.name)}' adds angles to lengths: joints {listed(map(name_of, way))}"
                raise place.error(InvalidLoop, problem, "couple joints of one kind")
        joints = [*to_successor, *to_predecessor]
        if not joints:
            continue
        terms = {name_of(joint): 1.0 for joint in to_successor}
        terms |= {name_of(joint): -sums.ratio for joint in to_predecessor}
        free = [joint for joint in joints if name_of(joint) not in taken and name_of(joint) not in driven]
        joint = _driven(sums, place, free, joints)
        driven.add(joint)
        ratios = {name: -term / terms[joint] for name, term in terms.items() if name != joint}
        cause = f"coupling '{shortened(sums.name)}' drives it"
        yield Relation(joint, ratios, 0.0, cause, "remove the coupling", place)


def _driven(sums: CoupledSums, place: SourceLocation, free: list[etree._Element], joints: list[etree._Element]) -> str:
    marks = {}
    for joint in joints:
        text = joint.get("independent")
        if text is not None and text.lower() not in INDEPENDENT_VALUES:
            problem = f"joint '{shortened(name_of(joint))}' has independent=\"{shortened(text)}\""
            raise place.error(InvalidLoop, problem, 'write "true" or "false"')
        marks[joint] = None if text is None else INDEPENDENT_VALUES[text.lower()]
    for wanted in (False, None):
        for joint in free:
            if marks[joint] is wanted:
                return name_of(joint)
    raise place.error(
        InvalidLoop,
        f"'{shortened(sums.name)}' has no joint to drive: {listed(map(name_of, joints))} are independent or driven "
        "already",
        'mark the one that it drives independent="false", or remove the coupling',
    )


def check_motors(source: Source, beside: CompanionFiles) -> None:
    """Raises InvalidLoop for a motor stated beside the file, at a joint that the file lacks; source: all of it."""
    joints = {name_of(joint) for joint in source.joints}
    for motor in beside.motors:
        if motor.joint not in joints:
            problem = f"there is no joint '{shortened(motor.joint)}'"
            raise motor.place.error(InvalidLoop, problem, "correct the name")


def actuated(motors: Sequence[Motor], independent: Sequence[str]) -> tuple[str, ...] | None:
    """The joints that have motors; None where none of those that are independent is said to."""
    return tuple(dict.fromkeys(motor.joint for motor in motors if motor.joint in independent)) or None


def unread_motors(motors: Sequence[Motor], driven: Container[str]) -> Iterator[Unread]:
    """Motors at joints that others drive."""
    for motor in motors:
        if motor.joint in driven:
            problem = f"a motor at joint '{shortened(motor.joint)}', which other joints drive"
            yield Unread(problem, motor.place.element or "", motor.place.line)
