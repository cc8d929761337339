"""The map that lays one serial robot over another: senses and zeros of the joints, base and tool.

Where a wrist can be flipped, or the zero of an end joint trades with base or tool, several maps give one motion of the
flange. Of these, the one is taken with which most links have equal inertias, then the one with the fewest changes, then
the one with which most limits agree.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from graphdyn.aligning.axes import JointAxes
from graphdyn.aligning.causes import explanations
from graphdyn.aligning.inertias import LinkInertias
from graphdyn.aligning.joint_map import JointMap
from graphdyn.aligning.trades import LaidRobot, traded
from graphdyn.aligning.walk import SNAP_ANGLE, Walk
from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model

COUNTED_FROM = 1e-5
"""Differences that do not count, as parts of the size of what is compared, and in radians: files that write 1.5708 for
π/2 err by 3.7e-6."""

MOST_JOINTS = 12
"""Joints of the longest robot that is aligned: every further one doubles the number of choices of senses."""

COST_RATIO, COST_MARGIN = 3.0, 1e-3
"""Misfits [rad, parts of the reach] of a choice of senses, as a multiple of the smallest and above it, with which it is
looked at: where axes are displaced, the right one need not have the smallest; what differs then decides."""

MOST_CHOICES = 16
"""Choices of senses that are looked at: those of one robot are eight at most, two for each end and the wrist."""


@dataclass(frozen=True, eq=False)
@short_repr
class Alignment:
    """Robot B laid over robot A.

    first, second: A and B
    map: how joint positions, base and tool relate
    model: B in the link frames, joint names and joint positions of A: the same robot, to rounding, written like A
    others: maps that move the flange in the same way, with less of the links equal or more changes
    """

    first: RobotModel
    second: RobotModel
    map: JointMap
    model: RobotModel
    others: tuple[JointMap, ...]


BY_INERTIAS = 1
"""Number of the walk by axes and inertias, from which single changes are looked for."""


def align(first: RobotModel, second: RobotModel, *, tolerance: float = COUNTED_FROM) -> Alignment:
    """Lay a serial robot over another with as many joints of the same kinds.

    tolerance: what does not count as a difference, as a part of reach, mass and tensor, and in radians

    Joints correspond in their order from the base. Raises InvalidInput for robots that are not serial, that have
    couplings or chords, more than 12 joints, or other numbers or kinds of joints.

    >>> import graphdyn
    >>> from graphdyn.aligning import align
    >>> arm = graphdyn.kr500()
    >>> align(arm, arm).map.signs
    array([1., 1., 1., 1., 1., 1.])
    """
    check_comparable(first, second)
    (tolerance,) = as_floats("tolerance", [tolerance])
    if not tolerance > 0:
        raise InvalidInput(f"tolerance is {tolerance:g}; give a number above zero")
    axes = JointAxes.of(first), JointAxes.of(second)
    inertias = LinkInertias.of((first, second), axes, tolerance)
    robots = first, second
    choices = list(_class_of_senses(*axes))
    best = min((_best_laid(robots, axes, signs, inertias) for signs in choices), key=lambda laid: laid.order)
    others = _others(best, second, [signs for signs in choices if (signs != best.map.signs).any()], inertias)
    return Alignment(first, second, best.map, best.model, tuple(others))


def check_comparable(first: RobotModel, second: RobotModel) -> None:
    """Raise InvalidInput where one is not serial, or where numbers and kinds of joints differ."""
    for model in (first, second):
        check_model(model)
        who = f"robot '{model.name}'"
        if model.couplings or model.chords:
            raise InvalidInput(f"{who} has couplings or loops; choose the chain to one tip (--tip)")
        for number, joint in enumerate(model.joints):
            if joint.inside != number:
                where = "the ground" if joint.inside == 0 else f"link '{model.body_names[joint.inside - 1]}'"
                raise InvalidInput(
                    f"{who} branches at {where}, before joint '{joint.name}'; choose the chain to one tip (--tip)"
                )
        if model.n_bodies > MOST_JOINTS:
            raise InvalidInput(
                f"{who} has {model.n_bodies} joints; {MOST_JOINTS} can be aligned: choose a shorter chain (--tip)"
            )
    if first.n_bodies != second.n_bodies:
        raise InvalidInput(
            f"robot '{first.name}' has {first.n_bodies} joints ({', '.join(first.joint_names)}), robot '{second.name}' "
            f"has {second.n_bodies} ({', '.join(second.joint_names)}); choose the chain to one tip (--tip)"
        )
    for one, other in zip(first.joints, second.joints, strict=True):
        if one.is_prismatic != other.is_prismatic:
            slides = one if one.is_prismatic else other
            turns = other if one.is_prismatic else one
            raise InvalidInput(f"joint '{slides.name}' slides, and joint '{turns.name}' in its place turns")


def _class_of_senses(first: JointAxes, second: JointAxes) -> Iterator[Array]:
    """The choices of senses (n,) with the smallest misfits."""
    choices = [np.array(signs) for signs in product((1.0, -1.0), repeat=len(first.directions))]
    costs = np.array([Walk(first, second, signs).cost for signs in choices])
    for chosen in np.argsort(costs, kind="stable")[:MOST_CHOICES]:
        if costs[chosen] <= COST_RATIO * costs.min() + COST_MARGIN:
            yield choices[chosen]


def _best_laid(
    robots: tuple[RobotModel, RobotModel], axes: tuple[JointAxes, JointAxes], signs: Array, inertias: LinkInertias
) -> LaidRobot:
    """B laid over A with these senses, so that least differs: one thing alone where that is possible."""
    laid: list[LaidRobot] = []
    for number, walk in enumerate(_walks(*axes, signs, inertias)):
        laid.append(traded(robots, walk, walk.zeros, walk.places, inertias))
        if not laid[-1].order[0]:
            return laid[-1]  # nothing can leave less
        if number == BY_INERTIAS and (explained := _explained(robots, walk, laid, inertias)):
            return min(explained, key=lambda each: each.order)
    return min(laid, key=lambda each: each.order)


def _explained(
    robots: tuple[RobotModel, RobotModel], walk: Walk, laid: list[LaidRobot], inertias: LinkInertias
) -> list[LaidRobot]:
    """B laid over A so that one thing alone differs, for everything that may; with whole right angles, if it can."""
    start = min(laid, key=lambda each: each.order).map
    whole = np.round(start.zeros / (np.pi / 2)) * np.pi / 2
    near = (np.abs(whole - start.zeros) < SNAP_ANGLE) & ~np.array(walk.first.slides)
    snapped, none = replace(start, zeros=np.where(near, whole, start.zeros)), np.zeros_like(near)
    axes = walk.first, walk.second
    found = [
        traded(robots, walk, each.zeros, each.places, inertias)
        for joint_map, kept in ((snapped, near), (start, none))
        for each in explanations(robots, axes, joint_map, inertias.tolerance, kept).values()
    ]
    return [each for each in found if each.order[0] <= 1]


def _others(best: LaidRobot, second: RobotModel, choices: list[Array], inertias: LinkInertias) -> list[JointMap]:
    """Other maps that move B's flange as the best one does, one for each of these choices of senses that has some."""
    robots = best.model, second
    axes = JointAxes.of(best.model), JointAxes.of(second)
    walks = (Walk(*axes, signs) for signs in choices)
    known = LinkInertias.of(robots, axes, inertias.tolerance)
    laid = [traded(robots, walk, walk.zeros, walk.places, known) for walk in walks if walk.cost <= inertias.tolerance]
    return [each.map for each in sorted(laid, key=lambda each: each.order)]


def _walks(first: JointAxes, second: JointAxes, signs: Array, inertias: LinkInertias) -> Iterator[Walk]:
    """B laid over A by its axes; by its inertias too; with whole right angles; by all axes but the first.

    Axes that are nearly parallel leave a translation along them open until others determine it; a second walk begins
    where the first has put the base, so that the small angles between them do no harm.
    """
    for given in (None, inertias):
        start = Walk(first, second, signs, given).places[0]
        yield Walk(first, second, signs, given, start)
    yield Walk(first, second, signs, inertias, snapped=True)
    if len(signs) > 1:
        outer = Walk(first.outer, second.outer, signs[1:])
        start = Walk(first.outer, second.outer, signs[1:], start=outer.places[0]).places[0]
        yield Walk(first, second, signs, inertias, start, held=True)
