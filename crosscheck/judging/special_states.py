"""States at which codes are wrong though they are right elsewhere: at rest, at small angles, at limits, asked again.

A code may have a shortcut there, divide by zero, or take what it kept from the call before.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

from graphdyn import Joint, RobotModel
from graphdyn.layout import Array
from graphdyn.model import rotation_about

SMALL_ANGLES = (1e-8, 9e-7, 5e-6, 1e-4, 2e-2)
"""All positions of a state [rad or m]: below and above the thresholds below which codes take series or limits."""

ORDINARY = ""
"""The label of a state that is not special."""

NEAREST_TO_ZERO = "every position is the one nearest to zero"
OTHER_STATES = "another state with these positions"
ONE_JOINT = "one joint moves alone"
AT_LIMITS = "every joint is at a limit of its positions"
ONE_AT_LIMIT = "a joint is at a limit of its positions"
WHOLE_TURNS = "every angle is a whole turn"
PARALLEL = "axes of neighboring joints are as parallel as they can be"
FULL_SPEED = "every joint is at the limit of its velocity"

LIMIT_DIGITS = 1e-6
"""Relative error of limits in files, which may be whole turns of seven digits."""

N_SPECIAL_STATES = 18
"""Number of the states that special_states gives."""

SpecialStates = tuple[NDArray[np.str_], Array, Array, Array]
"""A label of each state, then q, v, a (N, n)."""


def special_states(model: RobotModel, seed: int, largest_acceleration: float) -> SpecialStates:
    """The special states of a robot, in the order in which they are asked: the first six have the same positions."""
    rng = np.random.default_rng([seed, len(SMALL_ANGLES)])
    q, v = model.random_state(rng, 3)
    a = rng.uniform(-largest_acceleration, largest_acceleration, q.shape)
    rest = np.zeros(model.n_bodies)
    first, last = np.eye(model.n_bodies)[[0, -1]]
    near_zero = np.array([nearest_to_zero(joint) for joint in model.joints])
    states = [
        (OTHER_STATES, q[0], v[0], a[0]),
        (OTHER_STATES, q[0], rest, a[0]),
        (OTHER_STATES, q[0], v[0], rest),
        (OTHER_STATES, q[0], rest, rest),
        (OTHER_STATES, q[0], v[1], a[0]),
        (OTHER_STATES, q[0], v[0], a[1]),
        *((ONE_JOINT, q[1], v[0] * joint, a[0] * joint) for joint in (first, last)),
        *((_below(x), _within(model, near_zero + x), v[0], a[0]) for x in SMALL_ANGLES),
        *((AT_LIMITS, _at_limit(model, upper), v[0], a[0]) for upper in (False, True)),
        (WHOLE_TURNS, np.array([_turned(joint) for joint in model.joints]), v[0], a[0]),
        (PARALLEL, _parallel(model, q[2]), v[0], a[0]),
        (FULL_SPEED, q[2], _at_full_speed(model, v[2]), a[2]),
    ]
    labels, *arrays = zip(*states, strict=True)
    return np.array(labels), *(np.array(x) for x in arrays)  # type: ignore[return-value]


def _below(angle: float) -> str:
    return f"every position is within {angle:g} of the one nearest to zero"


def position_limits(joint: Joint) -> tuple[float, float]:
    """Lower and upper limit of a joint that has both; infinite ones for all others."""
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.kind == "continuous" or lower is None or upper is None:
        return -np.inf, np.inf
    return lower, upper


def nearest_to_zero(joint: Joint) -> float:
    """The position within the limits that is nearest to zero."""
    lower, upper = joint.limits.lower or 0.0, joint.limits.upper or 0.0
    return 0.0 if joint.kind == "continuous" else max(lower, 0.0) + min(upper, 0.0)


def _within(model: RobotModel, q: Array) -> Array:
    lower, upper = np.transpose([position_limits(joint) for joint in model.joints])
    clipped: Array = np.clip(q, lower, upper)
    return clipped


def _at_limit(model: RobotModel, upper: bool) -> Array:
    """The limits of all joints; half a turn, or a meter, where there is none."""
    found = [position_limits(joint)[upper] for joint in model.joints]
    free = [(1.0 if joint.is_prismatic else np.pi) * (1 if upper else -1) for joint in model.joints]
    return np.where(np.isfinite(found), found, free)


def _turned(joint: Joint) -> float:
    """One turn from zero, as far as the limits allow it."""
    lower, upper = position_limits(joint)
    turns = [x for x in (2 * np.pi, -2 * np.pi, 0.0) if lower <= x <= upper and not joint.is_prismatic]
    return turns[0] if turns else nearest_to_zero(joint)


def _parallel(model: RobotModel, start: Array) -> Array:
    """Positions at which the axes before and behind each turning joint are as parallel as they can be. start: of the
    other joints.

    Their product is c + x cos q + y sin q, with the axis before it u, behind it w: largest at the angle of (x, y), or
    half a turn from it.
    """
    q = start.copy()
    for k, joint in enumerate(model.joints):
        behind = [other for other in model.joints if other.inside == k + 1]
        if joint.is_prismatic or joint.inside == 0 or not behind:
            continue
        p = joint.axis
        u = joint.placement.rotation.T @ model.joints[joint.inside - 1].axis
        w = behind[0].placement.rotation @ behind[0].axis
        angle = np.arctan2(u @ np.cross(p, w), u @ (w - p * (p @ w)))
        lower, upper = position_limits(joint)
        turned = [x for x in (angle, angle - np.pi, angle + np.pi) if lower <= x <= upper]
        q[k] = max(turned, key=lambda x: abs(u @ rotation_about(p, x) @ w), default=q[k])
    return q


def _at_full_speed(model: RobotModel, v: Array) -> Array:
    """Limits of the velocities, with alternating signs; v where there is none."""
    limits = np.array([joint.limits.velocity or np.nan for joint in model.joints])
    return np.where(np.isfinite(limits), limits * (-1.0) ** np.arange(len(v)), v)


def earlier_calls(*arguments: Array) -> NDArray[np.intp]:
    """The first state with the same numbers in these arguments, for each state (N,); its own number where there is
    none."""
    rows = np.concatenate([x.reshape(len(x), -1) for x in arguments], axis=1)
    _, first, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    found: NDArray[np.intp] = first[which.ravel()]
    return found


def in_a_row(*arguments: Array) -> NDArray[np.intp]:
    """The first of the states in a row that have the same numbers in these arguments, for each state (N,)."""
    kept = earlier_calls(*arguments)
    rows = np.arange(len(kept))
    starts = np.concatenate([[True], kept[1:] != kept[:-1]])
    found: NDArray[np.intp] = np.maximum.accumulate(np.where(starts, rows, 0))
    return found


def conditions(
    labels: NDArray[np.str_], states: dict[str, Array], arguments: Collection[str]
) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """What sets states apart, in words, and which ones have it (N,). states: arrays (N, n) by the name of the argument;
    arguments: of the function."""
    known = [name for name in ("v", "a", "tau") if name in arguments]
    zero: dict[str, NDArray[np.bool_]] = {name: np.logical_not(states[name].any(axis=1)) for name in known}
    if len(known) > 1:
        still: NDArray[np.bool_] = np.logical_and.reduce([*zero.values()])
        yield " and ".join(f"{name} = 0" for name in known), still
    for name in known:
        yield f"{name} = 0", zero[name]
    for label in dict.fromkeys(labels.tolist()):
        if label not in (ORDINARY, OTHER_STATES):
            yield str(label), np.isin(labels, [label])
    limits = states["q"][labels == AT_LIMITS]
    yield ONE_AT_LIMIT, np.isclose(states["q"][:, None], limits, rtol=LIMIT_DIGITS, atol=0).any(axis=(1, 2))
    near = [NEAREST_TO_ZERO, *map(_below, SMALL_ANGLES)]
    yield from ((near[k], np.isin(labels, near[: k + 1])) for k in range(1, len(near)))
    if known:
        yield "q is that of an earlier call", earlier_calls(states["q"]) < np.arange(len(labels))


def only_where(deviating: NDArray[np.bool_], found: Iterator[tuple[str, NDArray[np.bool_]]]) -> str | None:
    """The narrowest condition that all deviating states have, in words; None where they have none in common."""
    fitting = [(words, where) for words, where in found if (where >= deviating).all()]
    if not fitting:
        return None
    words, where = min(fitting, key=lambda x: int(x[1].sum()))
    all_of_them = int(where.sum())
    if all_of_them == int(deviating.sum()):
        return f"wherever {words}"
    return f"only where {words}, at {int(deviating.sum())} of {all_of_them} such states"
