"""Calls from Python: of few samples, hot, the same memory every time, and cold, other memory; of the whole verbs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import cycle

import graphdyn
from crosscheck.bench.contender import Contender
from crosscheck.bench.forms.graphdyn_forms import our_name
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
    """graphdyn as it is called without out=, and Pinocchio's loop over threads with one."""
    third = states.tau if work.forward else states.a
    errors = states.acceleration_errors if work.forward else states.torque_errors
    name = "a" if work.forward else "tau"
    bare, out = states.bare, aligned(states.q.shape)
    native, models = bare.aba_in_parallel if work.forward else bare.rnea_in_parallel, bare.pool(1)
    size = min(work.samples or len(states), len(states))
    parts = [slice(first, first + size) for first in range(0, len(states) - size + 1 if work.cold else 1, size)]

    def ours(rows: slice) -> Array:
        q, v, x = (array[rows] for array in (states.q, states.v, third))
        if work.whole:
            whole = graphdyn.forward_dynamics if work.forward else graphdyn.inverse_dynamics
            answer: Array = getattr(whole(states.model, q, v, x, method="recursive", threads=1), name)
            return answer
        verb = graphdyn.joint_accelerations if work.forward else graphdyn.joint_torques
        return verb(states.model, q, v, x, method="recursive", threads=1)

    def theirs(rows: slice) -> Array:
        native(1, models, *(x[rows].T for x in (states.q, states.v, third)), out[rows].T)
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
        contender(our_name(), ours, "arguments checked, results in new arrays"),
        contender(PINOCCHIO_PARALLEL, theirs, "results written to given memory, pool of models made before"),
    ]
