"""Joints that others drive: mimic joints, and <coupling> of URDF+ as sums of joints; which joints have motors."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from lxml import etree

from graphdyn import Coupling, RobotModel
from urdf.document.connections.loops import (
    Closure,
    CompanionFiles,
    CoupledSums,
    Motor,
    SourceLocation,
    Unread,
    place_of,
)
from urdf.document.elements import name_of
from urdf.document.source import Source
from urdf.document.tree import joint_into, path_up
from urdf.errors import InvalidLock, InvalidLoop, InvalidMimic, URDFError, listed, shortened

if TYPE_CHECKING:
    import yourdfpy


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

    Raises InvalidLoop where no joint is left to drive, and for sums of angles and lengths.
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
    texts = {joint: joint.get("independent") for joint in joints}
    marks = {joint: None if text is None else INDEPENDENT_VALUES[text.lower()] for joint, text in texts.items()}
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


def unbound_dependents(source: Source, model: RobotModel) -> list[str]:
    """Joints marked independent="false" that move by themselves: no coupling drives them, and neither they nor what
    they drive are in a loop. Mimic joints are left out, whose loading as joints of their own is a choice."""
    marked = {
        name_of(joint)
        for joint in source.joints
        if not INDEPENDENT_VALUES[joint.get("independent", "true").lower()] and joint.find("mimic") is None
    }
    paths = model.loops.paths
    in_loop = np.zeros(model.n_bodies, dtype=bool)
    for chord in model.chords:
        in_loop |= paths[chord.body_i] != paths[chord.body_j]
    bound = (model.degrees_of_freedom.matrix[in_loop] != 0).any(axis=0)
    return [name for name, held in zip(model.independent_joints, bound, strict=True) if name in marked and not held]


def check_marks(source: Source) -> None:
    """Raises InvalidLoop for a joint whose independent= is neither true nor false; source: all of the file."""
    for joint in source.joints:
        text = joint.get("independent")
        if text is not None and text.lower() not in INDEPENDENT_VALUES:
            place = place_of(joint, source.path)
            raise place.error(InvalidLoop, f'it has independent="{shortened(text)}"', 'write "true" or "false"')


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
            yield Unread(problem, motor.place.element or "", motor.place.line, str(motor.place.path))


Mimic = Literal["coupled", "independent", "locked"]


@dataclass(frozen=True)
class Mimics:
    """couplings of the joints that free ones drive; locked: value per joint held still, driven joints included."""

    couplings: tuple[Coupling, ...]
    locked: Mapping[str, float]


def resolve(
    source: Source,
    robot: yourdfpy.urdf.Robot,
    order: Sequence[str],
    closures: Sequence[Closure],
    mimic: Mimic,
    locked: Mapping[str, float],
    stated: Container[str],
) -> Mimics:
    """What becomes of the joints that others drive; couplings in the order of these joints.

    order: of the joints, by name
    locked: joints held still by the caller or by a chain; stated: those of them that the caller named. A driven joint
    beside a chain is held still only if all that drive it are.

    Raises InvalidMimic for another choice, joints that mimic one that the robot lacks, or drive each other in a circle;
    InvalidLock for a locked joint that does not stand where those that drive it want it; InvalidLoop for a coupling
    that cannot be read.
    """
    if mimic not in get_args(Mimic):
        choices = ", ".join(map(repr, get_args(Mimic)))
        raise InvalidMimic(f"mimic is {mimic!r}", f"give one of {choices}", path=source.path)
    fixed = {joint.name for joint in robot.joints if joint.type == "fixed"}
    movable = [name for name in order if name not in fixed]
    mimicking = _mimic_relations(source, robot)
    if mimic == "locked":
        locked = {**dict.fromkeys(mimicking, 0.0), **locked}
    followed = mimicking if mimic == "coupled" else {}
    by_joint = followed | {
        relation.joint: relation
        for relation in relations(source, closures, mimicking if mimic != "independent" else ())
    }

    def value(name: str, on_the_way: tuple[str, ...]) -> float | None:
        """The position of a joint; None if it is free or a free one drives it."""
        if name in on_the_way:
            raise _circle(by_joint[name], (*on_the_way[on_the_way.index(name) :], name))
        if name not in by_joint:
            return 0.0 if name in fixed else locked.get(name)
        relation = by_joint[name]
        unknown = [other for other in relation.ratios if other not in fixed and other not in movable]
        if unknown and name in stated:
            return locked[name]
        if unknown:
            if unknown[0]:
                problem = f"it mimics joint '{shortened(unknown[0])}', which the robot lacks or the chain leaves out"
                remedy = f"correct the name, take a longer chain, lock it, or {relation.instead}"
            else:
                problem, remedy = "its <mimic> names no joint", f"state joint=, lock it, or {relation.instead}"
            raise relation.place.error(InvalidMimic, problem, remedy)
        terms = [(ratio, value(other, (*on_the_way, name))) for other, ratio in relation.ratios.items()]
        if any(at is None and ratio != 0 for ratio, at in terms):
            return None
        return sum(ratio * at for ratio, at in terms if at is not None and ratio != 0) + relation.offset

    couplings, held = [], dict(locked)
    for name in (name for name in movable if name in by_joint):
        at, relation = value(name, ()), by_joint[name]
        if at is None:
            known = {other: value(other, (name,)) for other in relation.ratios}
            free = {other: ratio for other, ratio in relation.ratios.items() if known[other] is None}
            if name in stated:
                raise _cannot_lock(source, name, relation, list(free))
            held.pop(name, None)
            offset = relation.offset + sum(relation.ratios[other] * at for other, at in known.items() if at is not None)
            couplings.append(Coupling(name, free, offset))
        else:
            if name in stated and locked[name] != at:
                problem = f"cannot lock '{name}' at {locked[name]:.9g}: {relation.cause}, and stands at {at:.9g}"
                remedy = f"leave it out of lock= (--lock), or {relation.instead}"
                raise InvalidLock(problem, remedy, path=source.path)
            held[name] = at
    return Mimics(tuple(couplings), held)


def _mimic_relations(source: Source, robot: yourdfpy.urdf.Robot) -> dict[str, Relation]:
    """Mimic relations of the mimic joints of a file, by joint."""
    elements = {name_of(joint): joint for joint in source.joints}
    found = {}
    for joint in robot.joints:
        if joint.mimic is not None and joint.type != "fixed":
            ratio = 1.0 if joint.mimic.multiplier is None else float(joint.mimic.multiplier)
            offset = float(joint.mimic.offset or 0.0)
            element = elements[joint.name]
            place = place_of(element, source.path)
            driver = joint.mimic.joint or ""
            cause = f"it mimics joint '{shortened(driver)}'"
            instead = "load with mimic='independent' (--mimic independent)"
            found[joint.name] = Relation(joint.name, {driver: ratio}, offset, cause, instead, place)
    return found


def _circle(relation: Relation, names: tuple[str, ...]) -> URDFError:
    circle = " → ".join(map(shortened, names))
    return relation.place.error(
        InvalidMimic, f"joints drive each other in a circle: {circle}", "remove a <mimic> or <coupling>"
    )


def _cannot_lock(source: Source, name: str, relation: Relation, free: list[str]) -> URDFError:
    problem = f"cannot lock '{name}': {relation.cause}, and {listed(free)} {'is' if len(free) == 1 else 'are'} free"
    remedy = f"lock {listed(free)} instead, or {relation.instead}"
    return InvalidLock(problem, remedy, path=source.path)
