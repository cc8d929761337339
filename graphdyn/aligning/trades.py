"""The zeros of the first and the last joint, which trade with base and tool.

The motion of the flange is the same for all of them. Taken is what leaves the fewest differences, then the fewest
changes and other limits.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from graphdyn.aligning.axes import matrix, moved_by, placement_of, turned_about, twist_about
from graphdyn.aligning.fields import joint_differences, link_differences
from graphdyn.aligning.inertias import LinkInertias
from graphdyn.aligning.joint_map import JointMap
from graphdyn.aligning.reexpressed import mapped_limits, reexpressed
from graphdyn.aligning.walk import PARALLEL_ANGLE, Walk
from graphdyn.layout import Array
from graphdyn.model import cross
from graphdyn.model.parts import JointLimits
from graphdyn.model.robot_model import RobotModel

EQUAL_LIMITS = 1e-5
"""Difference of limits [rad or m] that does not count when zeros are chosen by them: that of rounded angles."""


@dataclass(frozen=True, eq=False)
class LaidRobot:
    """A map, B written like A with it, and where it stands among others.

    order: the smallest is the best
    """

    map: JointMap
    model: RobotModel
    order: tuple[float, ...]


def laid_robot(
    robots: tuple[RobotModel, RobotModel], walk: Walk, zeros: Array, places: Array, inertias: LinkInertias
) -> LaidRobot:
    """B laid over A, with the senses of a walk.

    zeros: positions of B's joints where those of A are zero                                   (n,)  [rad or m]
    places: what moves ground and links of B, where they are at q = 0, over those of A         (n + 1, 4, 4)
    """
    ends = _ends(walk, robots)
    base, tool = np.linalg.inv(ends[0]) @ places[[0, -1]] @ ends[1]
    zeros = _by_limits(walk, zeros, robots)
    joint_map = JointMap(walk.signs, zeros, placement_of(base), placement_of(tool))
    model = reexpressed(*robots, joint_map, places, walk)
    joints = joint_differences(robots[0], model, inertias.tolerance)
    links = link_differences(robots[0], model, inertias.tolerance)
    changes = joint_map.n_changes(inertias.tolerance, inertias.length)
    limits = sum(_limits_differ(a.limits, b.limits) for a, b in zip(robots[0].joints, model.joints, strict=True))
    order = (len(joints) + len(links), changes + limits, float(np.abs(zeros).sum()))
    return LaidRobot(joint_map, model, order)


def traded(
    robots: tuple[RobotModel, RobotModel], walk: Walk, zeros: Array, places: Array, inertias: LinkInertias
) -> LaidRobot:
    """The best trade of the zero of the last joint with the tool, then of that of the first with the base.

    Arguments as in laid_robot.
    """
    about = walk.signs[:, None] * walk.first.directions
    ends, turning = _ends(walk, robots), next((k for k, slides in enumerate(walk.first.slides) if not slides), 0)

    @cache
    def laid(from_base: float, to_tool: float, turned: float = 0.0) -> LaidRobot:
        moved, added = places.copy(), zeros.copy()
        if turned:
            moved[: turning + 1] = _motion(walk, turning, -turned) @ moved[: turning + 1]
            added[turning] += turned
        moved[0] = _motion(walk, 0, -from_base) @ moved[0]
        moved[-1] = _motion(walk, -1, to_tool) @ moved[-1]
        added[0] += from_base
        added[-1] += to_tool
        return laid_robot(robots, walk, added, moved, inertias)

    tool = np.linalg.inv(ends[0, 1]) @ places[-1] @ ends[1, 1]
    fits = inertias.fits(len(about) - 1, places[-1], about[-1], walk.first.points[-1], 0.0)
    of_inertia = [shift if walk.first.slides[-1] else angle for angle, shift in fits]
    to_tool = [0.0, -_along(walk, -1, tool, ends[0, 1]), *_zeros_of_limits(-1, walk, zeros, robots), *of_inertia]
    base = np.linalg.inv(ends[0, 0]) @ places[0] @ ends[1, 0]
    from_base = [0.0, _along(walk, 0, base, ends[0, 0]), *_zeros_of_limits(0, walk, zeros, robots)]
    chosen = min(dict.fromkeys(to_tool), key=lambda position: laid(0.0, position).order)
    best = min(dict.fromkeys(from_base), key=lambda position: laid(position, chosen).order)
    angles = dict.fromkeys([0.0, *_turns_after_slides(walk, turning, zeros, places, robots, inertias)])
    return min((laid(best, chosen, angle) for angle in angles), key=lambda each: each.order)


def _turns_after_slides(
    walk: Walk,
    turning: int,
    zeros: Array,
    places: Array,
    robots: tuple[RobotModel, RobotModel],
    inertias: LinkInertias,
) -> list[float]:
    """What may be added to the zero of the first joint that turns, if all before it slide along its axis: ground and
    these links may be turned about it as well. The inertia of the last of them, or limits, tell by how much."""
    about = walk.signs[turning] * walk.first.directions[turning]
    if turning == 0 or any(
        np.linalg.norm(cross(about, each)) > PARALLEL_ANGLE for each in walk.first.directions[:turning]
    ):
        return []
    fits = inertias.fits(turning - 1, places[turning], about, walk.first.points[turning], 0.0)
    return [*(-angle for angle, _ in fits), *_zeros_of_limits(turning, walk, zeros, robots)]


def _ends(walk: Walk, robots: tuple[RobotModel, RobotModel]) -> Array:
    """Ground frame and last link frame of A, and of B, in the world (2, 2, 4, 4)."""
    axes = walk.first, walk.second
    return np.array([[matrix(robot.base), lines.links[-1]] for robot, lines in zip(robots, axes, strict=True)])


def _motion(walk: Walk, joint: int, position: float) -> Array:
    """What a joint of A does to the links outside of it, as a homogeneous matrix (4, 4) in the world."""
    direction = walk.signs[joint] * walk.first.directions[joint]
    if walk.first.slides[joint]:
        return moved_by(position * direction)
    return turned_about(direction, walk.first.points[joint], position)


def _along(walk: Walk, joint: int, frame: Array, inside: Array) -> float:
    """The angle or length by which a frame (4, 4), seen in `inside`, is turned about a joint axis or moved along it."""
    direction = inside[:3, :3].T @ (walk.signs[joint] * walk.first.directions[joint])
    return float(direction @ frame[:3, 3]) if walk.first.slides[joint] else twist_about(direction, frame[:3, :3])


def _zeros_of_limits(joint: int, walk: Walk, zeros: Array, robots: tuple[RobotModel, RobotModel]) -> list[float]:
    """What must be added to the zero of an end joint so that both its limits agree; empty where nothing does."""
    one, other = (robot.joints[joint].limits for robot in robots)
    ends = (other.lower, other.upper) if walk.signs[joint] > 0 else (other.upper, other.lower)
    if one.lower is None or one.upper is None or ends[0] is None or ends[1] is None:
        return []
    found = [float(b - walk.signs[joint] * a) for a, b in zip((one.lower, one.upper), ends, strict=True)]
    return [found[0] - float(zeros[joint])] if abs(found[0] - found[1]) < EQUAL_LIMITS else []


def _by_limits(walk: Walk, zeros: Array, robots: tuple[RobotModel, RobotModel]) -> Array:
    """Zeros from -π to π, or a turn away where the limits agree then."""
    wrapped = np.where(walk.first.slides, zeros, _wrapped(zeros))
    for k, (one, other) in enumerate(zip(robots[0].joints, robots[1].joints, strict=True)):
        now = mapped_limits(other.limits, float(walk.signs[k]), wrapped[k])
        if not one.is_prismatic and _limits_differ(one.limits, now):
            turns = (wrapped[k], wrapped[k] - 2 * np.pi, wrapped[k] + 2 * np.pi)
            mapped = [mapped_limits(other.limits, float(walk.signs[k]), zero) for zero in turns]
            differing = [_limits_differ(one.limits, limits) for limits in mapped]
            wrapped[k] = turns[differing.index(min(differing))]
    return wrapped


def _limits_differ(one: JointLimits, other: JointLimits) -> int:
    """How many of the limits of position differ."""
    pairs = (one.lower, other.lower), (one.upper, other.upper)
    return sum(a is not b if a is None or b is None else abs(a - b) > EQUAL_LIMITS for a, b in pairs)


def _wrapped(angles: Array) -> Array:
    """Angles from -π to π, and π rather than -π."""
    turned = np.remainder(angles + np.pi, 2 * np.pi) - np.pi
    return np.where(turned < -np.pi + EQUAL_LIMITS, turned + 2 * np.pi, turned)
