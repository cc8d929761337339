"""Numbers that are clipped: answers, or arguments before the function uses them, and answers scaled down to a limit.

A level counts only where the right number lies beyond it at every state that deviates: equal maxima alone are no clip.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.calls.clipped_motions import clipped_motion
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.judgment import FittedNumber
from crosscheck.judging.searching.found_fault import FoundFault
from graphdyn import RobotModel, inverse_dynamics
from graphdyn.errors import first_of
from graphdyn.layout import Array
from graphdyn.model import unit_of

SAME_LEVEL = 1e-6
"""Relative distance of answers that are one level: those that are solved for have the rounding of the solution."""

MIN_REPETITIONS = 2
"""Number of clipped numbers beyond the first at each level, over all levels."""

MAX_LISTED_LEVELS = 6

CLIP_REMEDY = "take the limits away for the comparison"

ANSWER_NAMES = {"inverse_dynamics": "torques", "gravity_torque": "torques", "bias_torque": "torques"} | {
    "static_torque": "torques",
    "forward_dynamics": "accelerations",
}


@dataclass(frozen=True, eq=False)
class Levels:
    """The limits of numbers (N, m): at most upper, at least lower (m,); infinite where they are not."""

    lower: Array
    upper: Array

    def clip(self, x: Array) -> Array:
        clipped: Array = np.clip(x.reshape(len(x), -1), self.lower, self.upper).reshape(x.shape)
        return clipped

    def said(self, name: Callable[[int], str]) -> Iterator[str]:
        """Such as "'elbow' at 12", "'elbow' between -1 and 12", "'elbow' above 12"."""
        for k, (low, high) in enumerate(zip(self.lower, self.upper, strict=True)):
            if np.isfinite(high) and abs(low + high) <= SAME_LEVEL * abs(high):
                yield f"{name(k)} at {high:.6g}"
            elif np.isfinite(low) and np.isfinite(high):
                yield f"{name(k)} between {low:.6g} and {high:.6g}"
            elif np.isfinite(high):
                yield f"{name(k)} above {high:.6g}"
            elif np.isfinite(low):
                yield f"{name(k)} below {low:.6g}"


def clipped(given: Answered) -> FoundFault | None:
    """Answers or torques that are clipped, or answers that are scaled down."""
    deviating = _deviating(given)
    if deviating is None:
        return None
    return _answers(given) or _torques(given) or _scaled_down(given, deviating)


def clipped_arguments(given: Answered) -> FoundFault | None:
    """Motions that are clipped: fits, which take longer than all single faults together."""
    deviating = _deviating(given)
    return None if deviating is None else clipped_motion(given, deviating)


def _deviating(given: Answered) -> NDArray[np.bool_] | None:
    """The states that deviate (N,); None where all do: numbers at rest are within limits."""
    if not np.isfinite(given.answer).all():
        return None
    deviating = given.errors(given.ours) > given.bound
    return None if deviating.all() and len(deviating) > 1 else deviating


def _answers(given: Answered) -> FoundFault | None:
    if given.name == "base_regressor":
        return None
    numbers = [np.abs(x.reshape(len(x), -1)).max(axis=1) for x in (given.answer, given.ours)]
    levels = _levels(given.answer, given.ours, given.bound * np.maximum(*numbers))
    if levels is None:
        return None
    left = float(given.errors(levels.clip(given.ours)).max())
    if left > given.bound:
        return None
    shape = given.answer.shape[1:]
    what = ANSWER_NAMES.get(given.name, "answers")

    def name(k: int) -> str:
        return _place(given.states.model, given.known.shape, shape, k)

    return _fault(what, levels, name, given.known.ours.unit, left, given)


def _torques(given: Answered) -> FoundFault | None:
    """Torques that forward dynamics are given."""
    if given.name != "forward_dynamics":
        return None
    states = given.states
    found = inverse_dynamics(states.model, states.q, states.v, given.answer, states.loads)
    used = found.tau
    solved = (np.abs(states.mass) @ np.abs(given.answer)[..., None]).max(axis=(1, 2))
    levels = _levels(used, states.tau, given.bound * np.maximum(solved, np.abs(found.joint_wrenches).max(axis=(1, 2))))
    if levels is None:
        return None
    expected = given.known.of_graphdyn(states.but(tau=levels.clip(states.tau)), given.chosen)
    left = float(given.errors(expected).max())
    if left > given.bound:
        return None
    what, unit = "the given torques", unit_of(states.model.joints, "N m", "N")
    return _fault(what, levels, lambda k: repr(states.model.joint_names[k]), unit, left, given)


def _levels(answer: Array, ours: Array, room_of_state: Array) -> Levels | None:
    """The levels of answers (N, …); None where other numbers deviate, or too few show it.

    room_of_state: by how much they may be off (N,)
    """
    x, y = (z.reshape(len(answer), -1) for z in (answer, ours))
    off = np.abs(x - y) > room_of_state[:, None]
    lower, upper = np.full(x.shape[1], -np.inf), np.full(x.shape[1], np.inf)
    clipped_numbers, values = 0, set[float]()
    for k in np.flatnonzero(off.any(axis=0)):
        column, right = x[:, k], y[:, k]
        room = SAME_LEVEL * float(np.abs(column).max())
        for levels, beyond, sign in (
            (upper, off[:, k] & (right > column), 1),
            (lower, off[:, k] & (right < column), -1),
        ):
            if not beyond.any():
                continue
            level = float(np.median(column[beyond]))
            if np.abs(column[beyond] - level).max() > room or (sign * (column - level)).max() > room:
                return None
            levels[k] = level
            clipped_numbers += int(beyond.sum())
            values.add(float(f"{abs(level):.5g}"))
    if not values or clipped_numbers < len(values) + MIN_REPETITIONS or (upper <= lower).any():
        return None
    return Levels(lower, upper)


def _fault(
    what: str, levels: Levels, name: Callable[[int], str], unit: str, left: float, given: Answered
) -> FoundFault:
    numbers = tuple(
        FittedNumber(f"limit, {name(k)}", float(x), np.inf, unit)
        for bounds in (levels.upper, -levels.lower)
        for k, x in enumerate(bounds)
        if np.isfinite(x)
    )
    every = {f"{x:.6g}" for x in [*levels.upper, *-levels.lower]}
    said = next(levels.said(lambda _: "every one")) if len(every) == 1 else ""
    said = said or first_of(list(levels.said(name)), MAX_LISTED_LEVELS)
    message = f"{what} are clipped, at a limit: {said} {unit}"
    return FoundFault(FaultDescription("clipped", message, CLIP_REMEDY, numbers=numbers), left, given.chosen)


def _place(model: RobotModel, kinds: tuple[int | str, ...], shape: tuple[int, ...], k: int) -> str:
    """The joint of an entry, or its numbers from 1."""
    place = np.unravel_index(k, shape) if shape else ()
    if kinds == ("n",):
        return repr(model.joint_names[k])
    return f"entry ({', '.join(str(int(x) + 1) for x in place)})" if place else "the number"


def _scaled_down(given: Answered, deviating: NDArray[np.bool_]) -> FoundFault | None:
    """All numbers of an answer by one factor, so that the largest, or their norm, is a limit."""
    x, y = (z.reshape(len(given.answer), -1) for z in (given.answer, given.ours))
    size = (y**2).sum(axis=1)
    factor = np.where(size > 0, (x * y).sum(axis=1) / np.where(size > 0, size, 1.0), 1.0)
    if x.shape[1] == 1 or deviating.sum() <= MIN_REPETITIONS or not (factor[deviating] < 1).all():
        return None
    shape = (-1, *[1] * (given.ours.ndim - 1))
    for what, norm in (("largest entry", np.abs(y).max(axis=1)), ("norm", np.sqrt(size))):
        level = float(np.median(factor[deviating] * norm[deviating]))
        scale = np.minimum(1.0, level / np.where(norm > 0, norm, np.inf).clip(min=level))
        left = float(given.errors(given.ours * scale.reshape(shape)).max())
        if left <= given.bound:
            message = f"the answers are scaled down to a {what} of {level:.6g}"
            return FoundFault(FaultDescription("clipped", message, CLIP_REMEDY), left, given.chosen)
    return None
