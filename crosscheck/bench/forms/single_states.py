"""One state per call from Python, as in a control loop."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import graphdyn
from crosscheck.bench.contender import Contender
from crosscheck.bench.states import States
from crosscheck.reference.reference_values import BareCalls
from graphdyn.layout import Array
from graphdyn.verbs import SingleState

CALLS_PER_RUN = 1000
"""Number of calls of a run, each with another state."""

COPIED_NAME, IN_PLACE_NAME = "graphdyn.compile", "graphdyn.compile, in place"


def inverse(states: States) -> list[Contender]:
    single, bare = graphdyn.compile(states.model).joint_torques, states.bare
    arguments = states.q, states.v, states.a
    return _contenders(single, bare, bare.rnea, "pin.rnea", arguments, states.torque_errors)


def forward(states: States) -> list[Contender]:
    single, bare = graphdyn.compile(states.model).joint_accelerations, states.bare
    arguments = states.q, states.v, states.tau
    return _contenders(single, bare, bare.aba, "pin.aba", arguments, states.acceleration_errors)


def _contenders(
    single: SingleState[Any],
    bare: BareCalls,
    function: Callable[..., Array],
    name: str,
    arguments: tuple[Array, ...],
    errors: Callable[[Array], Array],
) -> list[Contender]:
    rows = [
        tuple(np.array(x) for x in row) for row in zip(*(array[:CALLS_PER_RUN] for array in arguments), strict=True)
    ]
    model, data = bare.model, bare.data

    def copied(count: int) -> Array:
        for x, y, z in rows[:count]:
            single(x, y, z)
        return single.result

    def in_place(count: int) -> Array:
        for _ in rows[:count]:
            single()
        return single.result

    def theirs(count: int) -> Array:
        answer = single.result
        for x, y, z in rows[:count]:
            answer = function(model, data, x, y, z)
        return answer

    def judged(call: Callable[..., Array]) -> Callable[[Array], Array]:
        return lambda _: errors(np.array([np.array(call(*row)) for row in rows]))

    def contender(name: str, run: Callable[[int], Array], call: Callable[..., Array], included: str) -> Contender:
        return Contender(name, 1, run, judged(call), included, call is single, least=CALLS_PER_RUN, most=CALLS_PER_RUN)

    return [
        contender(COPIED_NAME, copied, single, "arguments copied after checking their lengths"),
        contender(IN_PLACE_NAME, in_place, single, "arguments are already in its memory"),
        contender(name, theirs, partial(function, model, data), "the call, with a new array for the result"),
    ]
