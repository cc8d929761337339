"""Calls from Python: of few samples, hot, the same memory every time, and cold, other memory; of the whole verbs.

Also of one state per call, as in a control loop.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import cycle

import numpy as np

import graphdyn
from crosscheck.bench.contender import Contender
from crosscheck.bench.forms.graphdyn_forms import DEFAULT_NAME, NEW_ARRAYS_NOTE
from crosscheck.bench.forms.pinocchio_forms import PINOCCHIO_PARALLEL
from crosscheck.bench.states import States
from graphdyn.compiler import aligned
from graphdyn.layout import Array


@dataclass(frozen=True)
class CallWork:
    """Inverse or forward dynamics of `samples` states per call, all of the benchmark if None.

    cold: in turn those of the whole benchmark
    whole: not torques or accelerations alone, but all that the verb answers
    """

    forward: bool
    samples: int | None
    cold: bool = False
    whole: bool = False

    @property
    def title(self) -> str:
        name = f"{'forward' if self.forward else 'inverse'} dynamics"
        if self.whole:
            return f"whole {name}, with motions and reactions"
        return f"{name}, {self.samples} states per call{', cold memory' if self.cold else ''}"


CALL_WORKS = {
    "inverse_call_100": CallWork(False, 100),
    "inverse_call_1000": CallWork(False, 1000),
    "inverse_call_1000_cold": CallWork(False, 1000, cold=True),
    "forward_call_100": CallWork(True, 100),
    "forward_call_1000": CallWork(True, 1000),
    "forward_call_1000_cold": CallWork(True, 1000, cold=True),
    "inverse_call_whole": CallWork(False, None, whole=True),
    "forward_call_whole": CallWork(True, None, whole=True),
}


def contenders(states: States, work: CallWork) -> list[Contender]:
    """graphdyn as it is called without further arguments but one thread, and Pinocchio's loop over threads with one."""
    inputs, errors = states.dynamics(work.forward)
    name = "a" if work.forward else "tau"
    bare, out = states.bare, aligned(states.q.shape)
    native, models = bare.aba_in_parallel if work.forward else bare.rnea_in_parallel, bare.pool(1)
    size = min(work.samples or len(states), len(states))
    parts = [slice(first, first + size) for first in range(0, len(states) - size + 1 if work.cold else 1, size)]

    def ours(rows: slice) -> Array:
        q, v, x = (array[rows] for array in inputs)
        if work.whole:
            whole = graphdyn.forward_dynamics if work.forward else graphdyn.inverse_dynamics
            answer: Array = getattr(whole(states.model, q, v, x, threads=1), name)
            return answer
        verb = graphdyn.joint_accelerations if work.forward else graphdyn.joint_torques
        return verb(states.model, q, v, x, threads=1)

    def theirs(rows: slice) -> Array:
        native(1, models, *(x[rows].T for x in inputs), out[rows].T)
        return out[rows]

    def contender(name: str, call: Callable[[slice], Array], included: str) -> Contender:
        turns = cycle(parts)

        def judged(_: Array) -> Array:
            return errors(call(parts[0]))

        memory = f"; the call is given {len(parts)} parts of memory in turn" if work.cold else ""
        return Contender(
            name, 1, lambda _: call(next(turns)), judged, included + memory, call is ours, least=size, most=size
        )

    return [
        contender(DEFAULT_NAME, ours, NEW_ARRAYS_NOTE),
        contender(PINOCCHIO_PARALLEL, theirs, "results written to given memory, pool of models made before"),
    ]


CALLS_PER_RUN = 1000
"""Number of calls of a run, each with another state."""

COPIED_NAME, IN_PLACE_NAME = "graphdyn.compile", "graphdyn.compile, in place"


def single_states(states: States, forward: bool) -> list[Contender]:
    """graphdyn.compile and Pinocchio, one state per call."""
    (inputs, errors), compiled, bare = states.dynamics(forward), graphdyn.compile(states.model), states.bare
    single = compiled.joint_accelerations if forward else compiled.joint_torques
    function, name = (bare.aba, "pin.aba") if forward else (bare.rnea, "pin.rnea")
    rows = [tuple(np.array(x) for x in row) for row in zip(*(array[:CALLS_PER_RUN] for array in inputs), strict=True)]
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
