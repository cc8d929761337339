"""Positions, velocities or accelerations that a function clips before it uses them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.judgment import FittedNumber
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.special_states import position_limits
from crosscheck.judging.states import JudgedStates
from graphdyn.errors import first_of
from graphdyn.layout import Array

MAX_FITTED_STATES = 40
"""Number of deviating states to which the limits are fitted."""

BELOW = (0.9, 0.3)
"""Least parts of the largest number at states that agree that a limit may be, tried in turn: at some of them it
changes nothing."""

LEVEL_STEP = 1e-6
"""Relative step of the slopes in the limits."""

MAX_LISTED_LEVELS = 6

SAME_SHARE = 1e-6
"""Relative distance of limits that are one part of the model's, or one number."""

CLIPPED_ARGUMENTS = {"v": ("velocities", "rad/s or m/s"), "a": ("accelerations", "rad/s² or m/s²")}
"""Arguments whose limits are fitted: in words, and their unit."""

NO_MOTION_SHARE = 1e-3
"""Limits below this part of the largest numbers are none: the argument is ignored."""

MOTION_REMEDY = "the dynamics hold beyond limits: take them away for the comparison"


def clipped_motion(given: Answered, deviating: NDArray[np.bool_]) -> FoundFault | None:
    """Arguments that are clipped, joint by joint. deviating: states (N,)"""
    if found := _positions(given):
        return found
    for name in CLIPPED_ARGUMENTS:
        if name in given.function.arguments and (found := _fitted(given, deviating, name)):
            return found
    return None


def _positions(given: Answered) -> FoundFault | None:
    q, joints = given.states.q, given.states.model.joints
    if given.known.shows:
        return None  # the catalog of dynamics codes has these, joint by joint
    bounds = np.transpose([position_limits(joint) for joint in joints])
    turn = np.where([joint.is_prismatic for joint in joints], np.inf, np.pi)
    for said, lower, upper in (("their limits", *bounds), ("±π", -turn, turn)):
        changed = np.clip(q, lower, upper)
        if np.array_equal(changed, q) or "q" not in given.function.arguments:
            continue
        left = float(given.errors(given.known.of_graphdyn(given.states.but(q=changed), given.chosen)).max())
        if left <= given.bound:
            return FoundFault(
                FaultDescription("clipped", f"positions are clipped at {said}", MOTION_REMEDY), left, given.chosen
            )
    return None


def _fitted(given: Answered, deviating: NDArray[np.bool_], name: str) -> FoundFault | None:
    """Limits ±x of an argument, fitted to the answers of deviating states; states that agree are within them."""
    from scipy.optimize import least_squares  # imported where first used

    size = np.abs(getattr(given.states, name))
    least, most = size[~deviating].max(axis=0, initial=0.0), size.max(axis=0)
    fitted = np.flatnonzero(most > least * (1 + SAME_SHARE))
    moved: NDArray[np.bool_] = (size[:, fitted] > least[fitted]).any(axis=1)
    if not len(fitted) or not least.any() or (deviating & ~moved).any():
        return None
    rows = np.flatnonzero(deviating)[:MAX_FITTED_STATES]
    states, answer = given.states.rows(rows), given.answer[rows]
    scale = np.maximum(np.abs(given.ours[rows].reshape(len(rows), -1)).max(axis=1), np.finfo(float).tiny)
    scale = scale.reshape(-1, *[1] * (answer.ndim - 1))

    def residuals(levels: Array) -> Array:
        """(K, D) of levels (K, m)."""
        many = states.rows(np.tile(np.arange(len(rows)), len(levels)))
        limits = np.full((len(levels), len(least)), np.inf)
        limits[:, fitted] = levels
        expected = _of_clipped(given, many, name, np.repeat(limits, len(rows), axis=0))
        off = (expected.reshape(len(levels), *answer.shape) - answer) / scale
        flat: Array = off.reshape(len(levels), -1)
        return flat

    def slopes(levels: Array) -> Array:
        steps = LEVEL_STEP * levels
        here, *there = residuals(np.concatenate([levels[None], levels + np.diag(steps)]))
        found: Array = ((np.array(there) - here) / steps[:, None]).T
        return found

    start, upper = np.maximum(least[fitted], SAME_SHARE * most[fitted]), most[fitted] * (1 + SAME_SHARE)
    for below in BELOW:
        found = least_squares(
            lambda x: residuals(x[None])[0],
            start,
            slopes,
            bounds=(below * start, upper),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
            max_nfev=40,
        ).x
        limits = np.full(len(least), np.inf)
        limits[fitted] = np.where(found < most[fitted], found, np.inf)
        left = float(given.errors(_of_clipped(given, given.states, name, limits)).max())
        if left <= given.bound:
            break
    else:
        return None
    if (found < NO_MOTION_SHARE * most[fitted]).any():
        return None
    what, unit = CLIPPED_ARGUMENTS[name]
    names = given.states.model.joint_names
    which = np.flatnonzero(np.isfinite(limits))
    numbers = tuple(FittedNumber(f"largest {name}, {names[k]}", float(limits[k]), np.inf, unit) for k in which)
    message = f"{what} are clipped, at a limit: {_said(given, name, limits, which, unit)}"
    return FoundFault(FaultDescription("clipped", message, MOTION_REMEDY, numbers=numbers), left, given.chosen)


def _of_clipped(given: Answered, states: JudgedStates, name: str, limits: Array) -> Array:
    clipped = states.but(**{name: np.clip(getattr(states, name), -limits, limits)})
    return given.known.of_graphdyn(clipped, given.chosen)


def _said(given: Answered, name: str, limits: Array, which: NDArray[np.intp], unit: str) -> str:
    joints = given.states.model.joints
    speed = np.array([joints[k].limits.velocity or np.nan for k in which])
    share = limits[which] / speed if name == "v" else np.full(len(which), np.nan)
    if np.ptp(share) <= SAME_SHARE:
        part = f" × {share[0]:.4g}" if abs(share[0] - 1) > SAME_SHARE else ""
        who = [repr(joints[k].name) for k in which]
        return f"that of the model{part}, of {first_of(who, MAX_LISTED_LEVELS)}"
    if np.ptp(limits[which]) <= SAME_SHARE * limits[which].max() and len(which) > 1:
        return f"every one at {limits[which[0]]:.6g} {unit}"
    return f"{first_of([f'{joints[k].name!r} at {limits[k]:.6g}' for k in which], MAX_LISTED_LEVELS)} {unit}"
