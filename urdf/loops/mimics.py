"""Joints that others drive: mimic joints (multiplier × the position of another + offset) and couplings of sums."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

from graphdyn import Coupling
from urdf.document.connections.loops import Closure, SourceLocation
from urdf.document.elements import describe, line_of, name_of
from urdf.document.source import Source
from urdf.errors import InvalidLock, InvalidMimic, URDFError, listed, shortened
from urdf.loops.couplings import Relation, relations

if TYPE_CHECKING:
    import yourdfpy

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
            raise relation.place.error(
                InvalidMimic,
                f"it mimics joint '{shortened(unknown[0])}', which the robot lacks or the chain leaves out",
                "correct the name, take a longer chain, lock it, or load with mimic='independent' (--mimic "
                "independent)",
            )
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
            place = SourceLocation(source.path, line_of(element), describe(element))
            cause = f"it mimics joint '{shortened(joint.mimic.joint)}'"
            instead = "load with mimic='independent' (--mimic independent)"
            found[joint.name] = Relation(joint.name, {joint.mimic.joint: ratio}, offset, cause, instead, place)
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
