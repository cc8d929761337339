"""Values that are held exactly although the robot moves: dead channels, clipped positions, and repeated rows.

A measured value of a moving joint changes from row to row, and a joint that comes to rest slows down before. A value
that stays exactly the same between two steps of the usual size was not measured. No model of the robot is needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.layout import Array

MIN_HELD_ROWS = 10
"""Rows in a row with exactly the same value, at least, from which a channel is held."""

MIN_HELD_SHARE = 0.01
"""Share of the rows that a held value lasts, at least."""

ABRUPT_STEP = 0.1
"""Step beside a held position, relative to the usual step of a fast motion, from which it did not slow down before."""

FAST_QUANTILE = 0.9
"""Quantile of the steps from row to row that is usual in a fast motion."""

MIN_RESOLVED_STEP = 5.0
"""Usual step of a fast motion in units of the smallest one, from which a position is resolved finely enough."""

MIN_JUMP = 3.0
"""Step beside a held position at an end of its range, relative to the usual step of a fast motion, from which it jumps
back to what is measured."""

MIN_TORQUE_GAP = 1.0
"""Distance of a torque held at an end of its range from all others, in units of the usual largest step, from which it
is no limit: a torque that is cut off comes close to where it is cut."""

MAX_FEW_VALUES = 50
"""Number of values of a torque up to which it was recorded in coarse steps, more than 2 % of its range: it keeps every
value for a while."""

GAP_NEIGHBORS, MIN_GAP_STEP, MIN_GAP_JOINTS = 5, 3.0, 2
"""Rows on both sides of a step, the size of a step relative to the largest of them, and the number of joints with such
a step from which rows are missing there: a joint alone may be a sensor, all of them are not."""

MIN_MOVED_SHARE = 0.02
"""Way of a joint while its torque is held, relative to its range, from which a measured torque would change."""

MIN_COPIED_ROWS = 10
"""Rows in a row that are the same as rows elsewhere, from which they are copies."""


@dataclass(frozen=True, eq=False)
@short_repr
class HeldValues:
    """Rows of a recording with n joints that hold a value.

    dead_torques, dead_positions: of a torque or a position (N, n)
    clipped_positions: of a position at an end of its range (N, n)
    repeated: that repeat the row before, or are copies of a part (N,)
    gaps: rows behind which others are missing: the positions jump (k,)
    """

    dead_torques: NDArray[np.bool_]
    dead_positions: NDArray[np.bool_]
    clipped_positions: NDArray[np.bool_]
    repeated: NDArray[np.bool_]
    gaps: NDArray[np.intp]

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Rows that hold no value of another one (N,)."""
        return ~(self.repeated | (self.dead_torques | self.dead_positions | self.clipped_positions).any(axis=1))


def held_values(q: Array, tau: Array, v: Array | None = None) -> HeldValues:
    """Held values of one uninterrupted recording, of rows as they were recorded.

    q, tau: positions and torques (N, n); v: measured velocities (N, n), if there are any
    """
    rows = len(q)
    dead_torques, dead_positions, clipped = (np.zeros(q.shape, dtype=bool) for _ in range(3))
    usual = np.quantile(np.abs(np.diff(q, axis=0)), FAST_QUANTILE, axis=0) if rows > 1 else np.zeros(q.shape[1])
    same = np.all(np.diff(np.column_stack([q, tau]), axis=0) == 0, axis=1)
    repeated = np.zeros(rows, dtype=bool)
    for start, stop in _runs(same):
        if _abrupt(q, start, stop, usual).any():
            repeated[start + 1 : stop] = True
    least = max(MIN_HELD_ROWS, int(MIN_HELD_SHARE * rows))
    for j in range(q.shape[1]):
        dead_positions[:, j], clipped[:, j] = _held_position(q, v, j, usual, least, repeated)
        dead_torques[:, j] = _held_torque(q[:, j], tau[:, j], least, repeated)
    repeated |= _copied(np.column_stack([q, tau]), q, usual)
    held = repeated | (dead_positions | clipped).any(axis=1)
    return HeldValues(dead_torques, dead_positions, clipped, repeated, _gaps(q, held))


def _runs(same: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First and last + 1 row of every run of equal rows (k, 2). same: whether a row equals the one before (N - 1,)."""
    edges = np.diff(np.concatenate([[0], same.astype(int), [0]]))
    return np.column_stack([np.flatnonzero(edges > 0), np.flatnonzero(edges < 0) + 1])


def _abrupt(q: Array, start: int, stop: int, usual: Array) -> NDArray[np.bool_]:
    """Whether the steps before and after a run are those of a fast motion, for each joint (n,)."""
    found = np.zeros(q.shape[1], dtype=bool)
    for here, there in ((start - 1, start), (stop - 1, stop)):
        if here >= 0 and there < len(q):
            found |= (np.abs(q[there] - q[here]) > ABRUPT_STEP * usual) & (usual > 0)
    return found


def _held_position(
    q: Array, v: Array | None, j: int, usual: Array, least: int, repeated: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Rows in which a position is held, and those in which the end of its range holds it (N,).

    A position leaves the end of its range with a step of the usual size, and one that is measured again jumps.
    """
    steps = np.abs(np.diff(q[:, j]))
    dead, clipped = np.zeros(len(q), dtype=bool), np.zeros(len(q), dtype=bool)
    smallest = steps[steps > 0].min(initial=np.inf)
    if not usual[j] > MIN_RESOLVED_STEP * smallest:
        return dead, clipped
    ends = (q[:, j].min(), q[:, j].max())
    for start, stop in _runs(steps == 0):
        if stop - start < least or repeated[start + 1 : stop].any():
            continue
        on = v is not None and np.quantile(np.abs(v[start:stop, j]), 0.5) > _slow(v[:, j])
        if not (on or _abrupt(q, start, stop, usual)[j]):
            continue
        jumps = steps[max(0, start - 1) : stop][[0, -1]].max() > MIN_JUMP * usual[j]
        (clipped if q[start, j] in ends and not jumps else dead)[start:stop] = True
    return dead, clipped


def _gaps(q: Array, held: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Rows behind which several positions jump at once (k,), but at rows that hold a value."""
    steps = np.abs(np.diff(q, axis=0))
    if len(steps) <= 2 * GAP_NEIGHBORS:
        return np.zeros(0, dtype=np.intp)
    largest = sliding_window_view(steps, GAP_NEIGHBORS, axis=0).max(axis=-1)
    inner = slice(GAP_NEIGHBORS, len(steps) - GAP_NEIGHBORS)
    beside = np.maximum(largest[: -GAP_NEIGHBORS - 1], largest[GAP_NEIGHBORS + 1 :])
    least = np.maximum(MIN_GAP_STEP * beside, np.quantile(steps, FAST_QUANTILE, axis=0))
    jumps = np.sum(steps[inner] > least, axis=1) >= MIN_GAP_JOINTS
    return np.flatnonzero(jumps & ~(held[1:] | held[:-1])[inner]) + GAP_NEIGHBORS


def _slow(v: Array) -> float:
    """A speed that is none of a joint at rest: a twentieth of its fast motion."""
    return 0.05 * float(np.quantile(np.abs(v), FAST_QUANTILE))


def _held_torque(q: Array, tau: Array, least: int, repeated: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows in which a torque is held while its joint moves (N,); torques at an end of the range are clipped."""
    steps = np.abs(np.diff(tau))
    dead = np.zeros(len(tau), dtype=bool)
    if len(np.unique(tau)) <= MAX_FEW_VALUES:
        return dead
    moved = np.ptp(q)
    ends = (tau.min(), tau.max())
    usual = np.quantile(steps[steps > 0], FAST_QUANTILE) if np.any(steps > 0) else 0.0
    for start, stop in _runs(steps == 0):
        if stop - start < least or repeated[start + 1 : stop].any() or np.ptp(q[start:stop]) < MIN_MOVED_SHARE * moved:
            continue
        gap = np.abs(tau[tau != tau[start]] - tau[start]).min(initial=np.inf)
        if tau[start] in ends and gap < MIN_TORQUE_GAP * usual:
            continue
        dead[start:stop] = True
    return dead


def _copied(rows: Array, q: Array, usual: Array) -> NDArray[np.bool_]:
    """Rows of a moving robot that are the same as rows farther away, many in a row (N,)."""
    found = np.zeros(len(rows), dtype=bool)
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    twin = first[number.ravel()]
    here = np.arange(len(rows))
    is_copy = here - twin > MIN_COPIED_ROWS
    follows = np.zeros(len(rows), dtype=bool)
    follows[1:] = is_copy[1:] & is_copy[:-1] & (np.diff(twin) == 1)
    for start, stop in _runs(follows[1:]):
        moving = np.any(np.abs(np.diff(q[start:stop], axis=0)) > ABRUPT_STEP * usual)
        if stop - start >= MIN_COPIED_ROWS and moving:
            found[start:stop] = True
    return found
