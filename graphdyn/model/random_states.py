"""Random joint states within limits; with chords closed ones, and the closed poses from which these are reached."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.errors import InconsistentState
from graphdyn.layout import Array
from graphdyn.model.assembly import (
    assembled,
    completed_rate,
    infinitesimal_motions,
    moving_apart,
    open_loop,
    refuse_infinitesimal,
    walked,
)
from graphdyn.model.loops import CLOSED_TOLERANCE, Loops
from graphdyn.model.parts import Joint

ANGLE_RANGE = np.pi

SLIDE_RANGE = 0.5
"""Ranges taken where limits are zero or missing: ±π rad, ±π rad/s; prismatic ±0.5 m, ±0.5 m/s, in the unit of
length of their loop where they are part of one."""

MAX_LIMIT = 1e6
"""A limit beyond this [rad, m, …/s] is treated as no limit."""

CLOSING_STARTS = 100
"""Random poses from which the loops are closed before that counts as impossible."""

POSES_ASSEMBLED_AT_ONCE = 20
"""Number of these poses assembled at once, so as to keep an assembly of many loops short where one of the first
closes."""

REGULAR_CANDIDATES = 20
"""Closed poses among which regular_pose chooses."""


def drawn(
    joints: Sequence[Joint], rng: np.random.Generator, shape: Sequence[int], units: Array | None = None
) -> tuple[Array, Array]:
    """q, v (*shape, n) of n joints, uniform within their limits; units: in which SLIDE_RANGE is taken (n,) [1, m]."""
    of_joints = np.ones(len(joints)) if units is None else units
    ranges = [_sampling_range(joint, unit) for joint, unit in zip(joints, of_joints, strict=True)]
    lower, upper, speed = (np.array(values) for values in zip(*ranges, strict=True))
    q = rng.uniform(lower, upper, (*shape, len(joints)))
    v = rng.uniform(-speed, speed, (*shape, len(joints)))
    return q, v


def closed_pose(who: str, loops: Loops) -> Array:
    """Joint positions (n,) that close the loops: near q = 0, or else near one of CLOSING_STARTS random poses.

    Raises InconsistentState, naming a loop, where none of them closes.
    """
    nearest = np.full(loops.n_rows, np.inf)
    for measured in dict.fromkeys((loops, _measured(loops))):
        starts, _ = drawn(loops.free_joints, np.random.default_rng(0), (CLOSING_STARTS,), measured.column_units)
        starts[0] = 0.0
        for some in (starts[:1], *np.array_split(starts[1:], CLOSING_STARTS // POSES_ASSEMBLED_AT_ONCE)):
            found, gaps = assembled(measured, some)
            widest = loops.widest(gaps)
            if widest.min() <= CLOSED_TOLERANCE:
                return np.asarray(found[np.flatnonzero(widest <= CLOSED_TOLERANCE)[0]])
            nearest = min(nearest, gaps[widest.argmin()], key=loops.widest)
    remedy = f"None of {CLOSING_STARTS} poses leads to a closed one: check where the chord stands on its bodies"
    raise open_loop(who, loops, nearest, remedy)


def _measured(loops: Loops) -> Loops:
    """The loops in their units, or where joints slide in their sizes: large ones slide far."""
    turning = np.array_equal(loops.column_units, loops.in_sizes.column_units)
    return loops if turning else loops.in_sizes


def regular_pose(who: str, loops: Loops, start: Array) -> Array:
    """Find, among some closed poses (n,), the one farthest from a singular one; start: a closed pose.

    That of the largest rank, and among these of the largest ratio of smallest to largest singular value of J.
    """
    rng = np.random.default_rng(0)
    if infinitesimal_motions(loops, start).shape[1]:
        return _most_regular_walked(loops, start, rng)
    return _most_regular(loops, closed_states(who, loops, start, rng, (REGULAR_CANDIDATES,))[0])


def _most_regular_walked(loops: Loops, start: Array, rng: np.random.Generator) -> Array:
    """That of poses to which a start that may be the only closed one leads, whatever velocities these allow."""
    measured = _measured(loops)
    q, gaps = walked(measured, start, drawn(loops.free_joints, rng, (REGULAR_CANDIDATES,), measured.column_units)[0])
    return _most_regular(loops, np.concatenate([start[None], q[loops.widest(gaps) <= CLOSED_TOLERANCE]]))


def _most_regular(loops: Loops, q: Array) -> Array:
    spaces = loops.spaces(loops.jacobian(loops.links(q)))
    return np.asarray(q[np.lexsort((spaces.distance, spaces.rank))[-1]])


def closed_states(
    who: str, loops: Loops, start: Array, rng: np.random.Generator, shape: Sequence[int]
) -> tuple[Array, Array]:
    """q, v (*shape, n) reached from a closed pose by moving towards random states.

    Drawn again where the loops stay open, or so close to a singular pose that no velocity keeps them closed.
    """
    measured = _measured(loops)
    q, v = drawn(loops.free_joints, rng, shape, measured.column_units)
    rows, rates = (array.reshape(-1, array.shape[-1]) for array in (q, v))
    todo = np.arange(len(rows))
    for _ in range(CLOSING_STARTS):
        rows[todo], gaps = walked(measured, start, rows[todo])
        jacobian = loops.jacobian(loops.links(rows[todo]))
        still = np.zeros_like(gaps)
        rates[todo] = completed_rate(loops, jacobian, rates[todo], still)
        apart = moving_apart(loops, jacobian, rates[todo], still)
        todo = todo[np.maximum(loops.widest(gaps), apart.max(axis=-1)) > CLOSED_TOLERANCE]
        if not todo.size:
            return q, v
        if infinitesimal_motions(loops, start).shape[1]:
            refuse_infinitesimal(who, loops, _most_regular_walked(loops, start, np.random.default_rng(0)))
        rows[todo], rates[todo] = drawn(loops.free_joints, rng, todo.shape, measured.column_units)
    raise InconsistentState(
        f"{who}: {len(todo)} of {len(rows)} random states did not close; give states of your own, closed by "
        "graphdyn.assemble"
    )


def _sampling_range(joint: Joint, unit: float) -> tuple[float, float, float]:
    """lower, upper and speed."""
    reach = SLIDE_RANGE * unit if joint.is_prismatic else ANGLE_RANGE
    lower, upper, speed = (
        None if limit is None or abs(limit) > MAX_LIMIT else limit
        for limit in (joint.limits.lower, joint.limits.upper, joint.limits.velocity)
    )
    speed = abs(speed or 0.0) or reach
    if joint.kind == "continuous" or not (lower or upper):  # both zero or missing
        return -reach, reach, speed
    if lower is None:
        assert upper is not None  # one of them is given
        return upper - 2 * reach, upper, speed
    return lower, lower + 2 * reach if upper is None else upper, speed
