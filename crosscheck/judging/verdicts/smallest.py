"""The smallest example of a fault: the fewest numbers other than zero, and round ones, at which it still shows."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

import graphdyn
from crosscheck.judging.judgment import WorstCall
from crosscheck.judging.observing.function_under_test import FunctionFailure
from crosscheck.judging.observing.references import backward_errors, relative_errors
from crosscheck.judging.special_states import position_limits
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.regions import roundest
from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities import LOADS, argument_at
from graphdyn import Joint
from graphdyn.layout import Array

MIN_ERROR_SHARE = 1e-6
"""Part of the largest error from which on a state shows the fault, and not the noise of the function."""

LARGE_ERROR_SHARE = 0.1
"""Part of the largest error of examples of one size: the first one with it is chosen."""

MAX_PAIRS = 1000
"""Number of pairs of entries that are tried; with more, the worst state is shrunk."""

MAX_ROUNDS = 12
"""Number of times that entries of the worst state are put at zero."""

MAX_EXAMPLE_DIGITS = 6
"""Number of digits after the point to which entries are rounded at most."""

UNITS = (1.0, -1.0, 0.5, -0.5, 0.1, -0.1, 0.01, -0.01)
"""Distances from the base state [rad, m, …/s, …/s², N m or N], the first that the limits allow."""

Errors = Callable[[Array], Array]
"""Points (K, D) → errors (K,), zero where the function has no answer."""


def smallest_call(found: Judged) -> WorstCall | None:
    """A call with as few numbers other than zero as can be found, at which the function deviates.

    Positions whose limits leave out zero are counted from a round number within them. None where no single call shows
    the fault: the function agrees, keeps something between calls, or is judged by all states together.
    """
    verdict, function = found.verdict, found.function
    if not verdict.repeats or function.name == "base_regressor" or not (verdict.largest_errors > verdict.bound).any():
        return None
    errors = verdict.largest_errors
    worst = int(np.nanargmax(np.where(np.isfinite(errors), errors, -1.0)))
    if not verdict.bound < errors[worst]:
        worst = int(errors.argmax())
    threshold = max(verdict.bound, MIN_ERROR_SHARE * errors[worst] if np.isfinite(errors[worst]) else 0.0)
    row = found.states.rows(np.array([worst]))
    names = function.arguments
    joints = found.states.model.joints
    start = np.concatenate([argument_at(row, name).ravel() for name in names])
    base, unit = (np.concatenate(x) for x in zip(*(_grid(name, joints) for name in names), strict=True))

    def asked(points: Array) -> Array:
        return _errors(found, row, points)

    point = _few_entries(asked, base, unit, threshold)
    if point is None:
        point = _rounded(asked, _shrunk(asked, start, base, threshold), base, threshold)
    return _call(found, _states(found, row, point[None]))


def _grid(name: str, joints: tuple[Joint, ...]) -> tuple[Array, Array]:
    """The base state of an argument, and a step from it, both round and within the limits."""
    if name == LOADS:
        return np.zeros(6 * len(joints)), np.ones(6 * len(joints))
    if name != "q":
        speeds = np.array([joint.limits.velocity or np.inf for joint in joints])
        slow = [speed if name == "v" and speed < 1 else 1.0 for speed in speeds]
        return np.zeros(len(joints)), np.array([x if x == 1 else roundest(x / 2, x) for x in slow])
    base, unit = [], []
    for joint in joints:
        lower, upper = position_limits(joint)
        base.append(0.0 if lower <= 0 <= upper else roundest(lower, upper))
        steps = [x for x in UNITS if lower <= base[-1] + x <= upper]
        unit.append(steps[0] if steps else 0.0)
    return np.array(base), np.array(unit)


def _states(found: Judged, row: JudgedStates, points: Array) -> JudgedStates:
    """The states of points (K, D): the arguments of the function one after the other."""
    many, names, n = row.rows(np.zeros(len(points), dtype=np.intp)), found.function.arguments, row.q.shape[1]
    ends = np.cumsum([6 * n if name == LOADS else n for name in names])[:-1]
    arrays = dict(zip(names, np.split(points, ends, axis=1), strict=True))
    if LOADS in arrays:
        arrays["loads"] = arrays.pop(LOADS).reshape(-1, n, 6)
    return many.but(**arrays)


def _errors(found: Judged, row: JudgedStates, points: Array) -> Array:
    """The errors of the function; the worst state is asked as well, which tells the usual size of an answer."""
    function, known, chosen = found.function, found.function.known, found.conventions.chosen
    worst = np.concatenate([argument_at(row, name).ravel() for name in function.arguments])
    states = _states(found, row, np.concatenate([points, worst[None]]))
    errors = np.zeros(len(points) + 1)
    try:
        answers = function.ask(*(argument_at(states, name) for name in function.arguments))
    except FunctionFailure:
        return errors[:-1]
    states, answered = states.rows(answers.answered), answers.answered
    with np.errstate(all="ignore"):
        there = relative_errors(known, answers.values, known.of_graphdyn(states, chosen), states, chosen)
        if known.name == "forward_dynamics":

            def required(a: Array) -> Array:
                return graphdyn.inverse_dynamics(states.model, states.q, states.v, a, states.loads).tau

            there = np.maximum(there, backward_errors(answers.values, required, states))
    errors[answered] = there
    return errors[:-1]


def _few_entries(errors: Errors, base: Array, unit: Array, threshold: float) -> Array | None:
    """The base state, or one with one or two entries other than its own; None where none of these deviates."""
    steps = np.diag(unit)[unit != 0]
    rounds = [base[None], base + steps]
    pairs = list(combinations(steps, 2))
    if 0 < len(pairs) <= MAX_PAIRS:
        rounds.append(base + np.array([x + y for x, y in pairs]))
    for points in rounds:
        found = errors(points)
        if (found > threshold).any():
            return np.asarray(points[_first_large(found, threshold)])
    return None


def _first_large(found: Array, threshold: float) -> int:
    """The first of those that deviate by nearly as much as the one that deviates most."""
    finite = found[np.isfinite(found)]
    enough = max(threshold, LARGE_ERROR_SHARE * float(finite.max(initial=0.0)))
    large = found > enough
    return int((large if large.any() else found > threshold).argmax())


def _shrunk(errors: Errors, start: Array, base: Array, threshold: float) -> Array:
    """A state with as many entries at the base as can be, from one that deviates."""
    point = start.copy()
    for _ in range(MAX_ROUNDS):
        left = np.flatnonzero(point != base)
        if not len(left):
            break
        found = errors(np.array([_with(point, np.array([k]), base) for k in left]))
        order = left[np.argsort(-found, kind="stable")]
        several = np.array([_with(point, order[: k + 1], base) for k in range(len(order))])
        fitting = np.flatnonzero(errors(several) > threshold)
        if not len(fitting):
            break
        point = several[fitting[-1]]
    return point


def _with(point: Array, entries: NDArray[np.intp], base: Array) -> Array:
    changed = point.copy()
    changed[entries] = base[entries]
    return changed


def _rounded(errors: Errors, point: Array, base: Array, threshold: float) -> Array:
    """The same state with its entries rounded to as few digits as still deviate."""
    shorter = np.array(
        [np.where(point == base, base, np.round(point, digits)) for digits in range(MAX_EXAMPLE_DIGITS + 1)]
    )
    fitting = np.flatnonzero(errors(shorter) > threshold)
    return np.asarray(shorter[fitting[0]] if len(fitting) else point)


def _call(found: Judged, state: JudgedStates) -> WorstCall | None:
    function, known = found.function, found.function.known
    row = [argument_at(state, name)[0] for name in function.arguments]
    try:
        answer = function.ask(*(x[None] for x in row)).values[0]
    except FunctionFailure:
        return None
    expected = known.of_graphdyn(state, found.conventions.chosen)[0]
    return WorstCall(
        {name: tuple(x.ravel().tolist()) for name, x in function.function_arguments(row).items()},
        tuple(np.ravel(expected).tolist()),
        tuple(np.ravel(answer).tolist()),
    )
