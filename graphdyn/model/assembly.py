"""Joint positions, velocities and accelerations that keep loops closed."""

from __future__ import annotations

import logging

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InconsistentState, in_row
from graphdyn.layout import Array
from graphdyn.model.loops import CLOSED_TOLERANCE, Loops
from graphdyn.model.spatial import apply

log = logging.getLogger(__name__)

MAX_ASSEMBLY_STEPS = 200
"""Newton steps before an assembly gives up; those that succeed need 5 to 40."""

TOLD_STEPS = 4
"""Newton steps from one message of an assembly to the next: what takes fewer is quick."""

WALK_STEPS = 12
"""Steps of a walk from one closed pose to another: a turn by π in steps of 15°."""

GAP_ROUNDING = 1e-13
"""Gaps [rad, m in the unit of their loop] at which steps no longer help an arm of a few meters."""

SHAKE = 1e-2
"""Length of the step [rad, m in the unit of its loop] along a motion that is tried: far above what a gap of
CLOSED_TOLERANCE leaves open, 1e-4, where it is of second order."""

SHAKES = 20
"""Random directions of such steps: those right between two branches lead back too."""

HELD_SHARE = 1e-10
"""A joint whose part in all closed motions is below this, of their length, stands still: far above rounding, and so low
that nearly all joints near a dead point move."""

MOVED_SHARE = 0.1
"""Part of such a step that is left of it where the loops are closed again and the motion is one."""


def infinitesimal_motions(loops: Loops, q: Array) -> Array:
    """Joint motions (nv, k) that keep loops closed near a closed pose q (nv,) to first order alone: steps along them
    lead back. Orthonormal in the sizes of the loops.

    None in a pose where branches of motions meet, although only steps along these lead on.
    """
    loops = loops.in_sizes
    here, _ = assembled(loops, q)
    shaky = loops.shaky_motions(here)
    if not shaky.shape[1]:
        return shaky
    amounts = np.random.default_rng(0).normal(size=(SHAKES, shaky.shape[1]))
    steps = SHAKE * (amounts / np.linalg.norm(amounts, axis=1, keepdims=True)) @ shaky.T
    there, _ = assembled(loops, here + steps)
    moved = ((there - here) / loops.column_units) @ (shaky / loops.column_units[:, None])
    return shaky if np.abs(moved).max() < MOVED_SHARE * SHAKE else shaky[:, :0]


def infinitesimal_refusal(who: str, loops: Loops, q: Array) -> InconsistentState | None:
    """The error that names the joints, where loops close at q (nv,) only when stretched or folded."""
    motions = infinitesimal_motions(loops, q)
    if not motions.shape[1]:
        return None
    parts = np.abs(motions / loops.in_sizes.column_units[:, None]).max(axis=1)
    joints = [joint.name for joint, part in zip(loops.free_joints, parts, strict=True) if part > SHAKE]
    return InconsistentState(
        f"{who}: its loops close only stretched or folded: motions of {', '.join(joints)} keep them closed to first "
        f"order only (infinitesimal mobility {motions.shape[1]}), so that torques determine no accelerations and "
        "reactions; change lengths, or lock these joints"
    )


def refuse_infinitesimal(who: str, loops: Loops, q: Array) -> None:
    """Refuse loops that close only when stretched: raises infinitesimal_refusal."""
    refusal = infinitesimal_refusal(who, loops, q)
    if refusal is not None:
        raise refusal


def assembled(loops: Loops, q: Array, held: NDArray[np.intp] | None = None) -> tuple[Array, Array]:
    """Positions (…, n) near q that close the loops as far as they could be, and their gaps (…, m).

    Levenberg-Marquardt steps with damping ∝ ‖gap‖² (Fan and Yuan, "On the quadratic convergence of the
    Levenberg-Marquardt method without nonsingularity assumption", Computing 74, 2005), which passes singular poses and
    does not mind redundant rows. held: indices of joints that stay where they are
    """
    batch = q.shape[:-1]
    x = q.reshape(-1, q.shape[-1]).astype(float)
    moving = np.ones(x.shape[-1])
    if held is not None:
        moving[held] = 0.0
    links, damping = loops.links(x), np.full(len(x), 1.0)
    gaps = loops.gaps_of(links) / loops.row_units
    best = np.linalg.norm(gaps, axis=-1)
    for number in range(MAX_ASSEMBLY_STEPS):
        if number % TOLD_STEPS == TOLD_STEPS - 1:
            log.info("closing the loops, step %d", number + 1)
        todo = np.flatnonzero((np.abs(gaps).max(axis=-1, initial=0.0) > GAP_ROUNDING) & (damping < 1e12))
        if not todo.size:
            break
        jacobian = loops.in_units(loops.jacobian(links.rows(todo))) * moving
        left, values, right = np.linalg.svd(jacobian, full_matrices=False)
        mu = (damping[todo] * best[todo] ** 2)[:, None]
        kept = values > 1e-12 * values.max(axis=-1, keepdims=True, initial=0.0)
        weights = np.where(kept, values / np.where(kept, values**2 + mu, 1.0), 0.0)
        step = -apply(np.swapaxes(right, -1, -2), weights * apply(np.swapaxes(left, -1, -2), gaps[todo]))
        longest = np.abs(step).max(axis=-1, initial=0.0, keepdims=True)
        shorter = np.minimum(1.0, 1.0 / np.where(longest > 0, longest, 1.0))  # at most 1 rad or a unit of length
        tried = x[todo] + step * shorter * loops.column_units
        there = loops.links(tried)
        new = loops.gaps_of(there) / loops.row_units
        size = np.linalg.norm(new, axis=-1)
        better = size < best[todo]
        accepted = todo[better]
        x[accepted], gaps[accepted], best[accepted] = tried[better], new[better], size[better]
        links.replace_rows(accepted, there.rows(better))
        damping[todo] = np.where(better, np.maximum(damping[todo] / 4, 1e-8), damping[todo] * 8)
        damping[todo[~better & (size < CLOSED_TOLERANCE)]] = np.inf  # rounding
    return x.reshape(q.shape), gaps.reshape(*batch, loops.n_rows) * loops.row_units


def refuse_open(who: str, loops: Loops, gaps: Array, remedy: str) -> None:
    """Raises InconsistentState, naming the loop, its gap and the row, where gaps (…, m) exceed CLOSED."""
    if np.nanmax(loops.widest(gaps), initial=0.0) > CLOSED_TOLERANCE:
        raise open_loop(who, loops, gaps, remedy)


def open_loop(who: str, loops: Loops, gaps: Array, remedy: str) -> InconsistentState:
    """The error that names the widest of gaps (…, m)."""
    index, chord, where = worst_row(loops, np.abs(gaps) / loops.row_units)
    gap, unit = abs(float(gaps[index])), float(loops.row_units[index[-1]])
    return InconsistentState(
        f"{who}: the loop of chord '{chord}' is open by {gap:.2g} m or rad{where}; "
        f"closed is {CLOSED_TOLERANCE * unit:.3g}. {remedy}"
    )


def refuse_moving_apart(
    who: str, loops: Loops, jacobian: Array, rate: Array, wanted: Array, what: str, summed: Array | float = 0.0
) -> None:
    """Raises InconsistentState where J rate (…, m) is not as wanted: loops would open. what: "velocity", …"""
    relative = moving_apart(loops, jacobian, rate, wanted, summed)
    if not relative.size or np.nanmax(relative) <= CLOSED_TOLERANCE:
        return
    index, chord, where = worst_row(loops, relative)
    raise InconsistentState(
        f"{who}: the {what} opens the loop of chord '{chord}'{where} "
        f"(by {relative[index]:.2g} of its terms, at most {CLOSED_TOLERANCE:g}); "
        "graphdyn.assemble(model, q, v, a) gives the nearest that does not"
    )


def moving_apart(loops: Loops, jacobian: Array, rate: Array, wanted: Array, summed: Array | float = 0.0) -> Array:
    """How far J rate (…, m) is from wanted, relative to the largest of the terms that are summed.

    summed: size of those of which wanted is the sum (…)
    """
    error = np.abs(apply(jacobian, rate) - wanted) / loops.row_units
    size = (apply(np.abs(jacobian), np.abs(rate)) + np.abs(wanted)) / loops.row_units
    scale = np.maximum(size.max(axis=-1, initial=0.0), summed)[..., None]
    relative: Array = error / np.where(scale > 0, scale, 1.0)
    return relative


def centripetal_size(loops: Loops, jacobian: Array, v: Array) -> Array:
    """Size of the terms that γ sums (…), squares of velocities of all joints, in the units of the rows."""
    return np.asarray(
        np.abs(loops.in_units(jacobian)).max(axis=(-2, -1)) * np.square(v / loops.column_units).max(axis=-1)
    )


def completed_rate(
    loops: Loops, jacobian: Array, rate: Array, wanted: Array, held: NDArray[np.intp] | None = None
) -> Array:
    """The rate (…, n) nearest to the given one with J rate = wanted (…, m), of joints that are not held.

    Joints that the loops hold take exactly what is wanted of them: none of the rounding of what they cannot do.
    """
    moving = np.ones(rate.shape[-1])
    if held is not None:
        moving[held] = 0.0
    spaces = loops.spaces(jacobian * moving)
    motions = np.where(spaces.free[..., None, :], spaces.right, 0.0) / loops.column_units[:, None]
    free = np.linalg.norm(motions, axis=-1) > HELD_SHARE
    rate = np.where(free, rate, 0.0)
    return rate + spaces.least_motion(wanted - apply(jacobian, rate))


def worst_row(loops: Loops, errors: Array) -> tuple[tuple[int, ...], str, str]:
    """The place of the largest of errors (…, m), the chord it belongs to, and in words its row among the states."""
    *row, worst = (int(k) for k in np.unravel_index(int(np.nanargmax(errors)), errors.shape))
    chords = [chord.name for chord in loops.chords for _ in chord.rows]
    return (*row, worst), chords[worst], in_row(row)


def walked(loops: Loops, start: Array, target: Array) -> tuple[Array, Array]:
    """Walk from a closed pose (n,) in WALK_STEPS steps towards poses (…, n), closing the loops at each: positions and
    gaps.

    So linkages stay in the branch of the start, as a moved one does.
    """
    x, gaps = np.broadcast_to(start, target.shape), np.zeros((*target.shape[:-1], loops.n_rows))
    for _ in range(WALK_STEPS):
        x, gaps = assembled(loops, x + (target - start) / WALK_STEPS)
    return x, gaps
