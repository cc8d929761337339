"""What tells two explanations apart that fit the same answers: other states, another gravity, or nothing."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, State, torques_of
from crosscheck.judging.searching.explanation import Explanation
from crosscheck.judging.searching.search import Search
from graphdyn.layout import Array

COMPARED_STATES = 20

TILTED_GRAVITIES = np.array([[9.81, 0.0, 0.0], [0.0, 9.81, 0.0], [3.0, 4.0, -5.0]])
"""Further gravity vectors [m/s²]."""


EQUAL_NUMBER_TOLERANCE = 1e-9
"""Relative difference of two numbers that are the same."""


def same_code(first: DynamicsCode, second: DynamicsCode) -> bool:
    """Whether both have the same numbers and treat arguments and answers alike: one fault in two ways to say it."""
    pairs = zip(dataclasses.astuple(first.numbers), dataclasses.astuple(second.numbers), strict=True)
    alike = all(
        np.allclose(x, y, rtol=EQUAL_NUMBER_TOLERANCE, atol=EQUAL_NUMBER_TOLERANCE * float(np.abs(x).max()))
        for x, y in pairs
    )
    return alike and all(getattr(first, x) == getattr(second, x) for x in ("arguments", "answers", "recursion"))


def same_everywhere(first: Explanation, second: Explanation, search: Search) -> bool:
    """Whether both are one code for this robot: the same torques at any state and with any gravity."""
    return not _differ(first.code, second.code, _far(search), search) and not _tilt(first, second, search)


def what_distinguishes(first: Explanation, others: Sequence[Explanation], search: Search) -> str:
    """An experiment in which the first differs from the others."""
    if all(same_code(first.code, x.code) for x in others):
        return "nothing: they are the same change of the numbers"
    state = _far(search)
    if all(_differ(first.code, x.code, state, search) for x in others):
        return "states beyond the limits of the joints"
    if all(_tilt(first, x, search) or _differ(first.code, x.code, state, search) for x in others):
        return "states beyond the limits of the joints, or gravity in another direction (a tilted base)"
    return "nothing: these faults give identical torques; check each place in the code"


def _far(search: Search) -> State:
    rng = np.random.default_rng(1)
    shape = COMPARED_STATES, search.model.n_bodies
    return tuple(width * rng.uniform(-1, 1, shape) for width in (3 * np.pi, 10.0, 30.0))  # type: ignore[return-value]


def _tilt(first: Explanation, second: Explanation, search: Search) -> bool:
    """Whether another gravity makes them differ; not where one of them is a fault of gravity."""
    own = search.own.numbers.gravity
    if not all(np.array_equal(x.code.numbers.gravity, own) for x in (first, second)):
        return False
    state = _far(search)
    return any(_differ(first.code.but(gravity=g), second.code.but(gravity=g), state, search) for g in TILTED_GRAVITIES)


def _differ(first: DynamicsCode, second: DynamicsCode, state: State, search: Search) -> bool:
    one: Array
    one, other = torques_of([first], state)[0], torques_of([second], state)[0]
    size = np.abs(one).max(axis=1, keepdims=True)
    return bool((np.abs(one - other) > 10 * search.bound * np.where(size > 0, size, 1.0)).any())
