"""Pinocchio in the benchmark: one call per state in a Python loop, and its own loops over threads."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from crosscheck.studies.bench.contender import ALL, Contender
from crosscheck.studies.bench.states import States
from graphdyn.kernels.aligned import aligned
from graphdyn.layout import BODY_PARAMETERS, Array

LOOP, PARALLEL = "pinocchio loop", "pinocchio InParallel"
IN_LOOP = "a Python loop, results copied to given memory"
IN_PARALLEL = "results written to given memory, pool of models made before"


def instruction_set() -> str:
    """The vector instructions of Pinocchio's build, as its bindings report them; "unknown" where they do not."""
    try:
        from eigenpy import SimdInstructionSetsInUse  # of the same build, with the same instructions
    except ImportError:
        return "unknown"
    return str(SimdInstructionSetsInUse())


def inverse(states: States, threads: Sequence[int]) -> list[Contender]:
    bare, out = states.bare, np.empty(states.q.shape)
    rnea, model, data = bare.rnea, bare.model, bare.data

    def loop(count: int) -> Array:
        for k, (q, v, a) in enumerate(zip(states.q[:count], states.v[:count], states.a[:count], strict=True)):
            out[k] = rnea(model, data, q, v, a)
        return out[:count]

    return [
        Contender(LOOP, 1, loop, states.torque_errors, IN_LOOP),
        *_in_parallel(bare.rnea_in_parallel, bare.pool, (states.q, states.v, states.a), threads, states.torque_errors),
    ]


def forward(states: States, threads: Sequence[int]) -> list[Contender]:
    bare, out = states.bare, np.empty(states.q.shape)
    aba, model, data = bare.aba, bare.model, bare.data

    def loop(count: int) -> Array:
        for k, (q, v, tau) in enumerate(zip(states.q[:count], states.v[:count], states.tau[:count], strict=True)):
            out[k] = aba(model, data, q, v, tau)
        return out[:count]

    return [
        Contender(LOOP, 1, loop, states.acceleration_errors, IN_LOOP),
        *_in_parallel(
            bare.aba_in_parallel, bare.pool, (states.q, states.v, states.tau), threads, states.acceleration_errors
        ),
    ]


def everything(states: States, threads: Sequence[int]) -> list[Contender]:
    """aba, then rnea at its acceleration, which leaves the joint wrenches in data.f. They are not copied."""
    bare, out = states.bare, np.empty(states.q.shape)
    aba, rnea, model, data = bare.aba, bare.rnea, bare.model, bare.data

    def loop(count: int) -> Array:
        for k, (q, v, tau) in enumerate(zip(states.q[:count], states.v[:count], states.tau[:count], strict=True)):
            a = aba(model, data, q, v, tau)
            rnea(model, data, q, v, a)
            out[k] = a
        return out[:count]

    included = "a Python loop of aba and rnea, accelerations copied to given memory, joint wrenches left in data.f"
    return [Contender(f"{LOOP} (aba + rnea)", 1, loop, None, included)]


def regressor(states: States, threads: Sequence[int]) -> list[Contender]:
    bare, n = states.bare, states.model.n_bodies
    regressor, model, data = bare.torque_regressor, bare.model, bare.data
    memory: list[Array] = []

    def loop(count: int) -> Array:
        if not memory or len(memory[0]) < count:
            memory[:] = [np.empty((count, n, BODY_PARAMETERS * n))]
        out = memory[0]
        for k, (q, v, a) in enumerate(zip(states.q[:count], states.v[:count], states.a[:count], strict=True)):
            out[k] = regressor(model, data, q, v, a)
        return out[:count]

    return [Contender(LOOP, 1, loop, states.regressor_errors, IN_LOOP, most=20_000)]


def _in_parallel(
    function: Callable[..., None],
    pool: Callable[[int], object],
    arrays: tuple[Array, ...],
    threads: Sequence[int],
    errors: Callable[[Array], Array],
) -> list[Contender]:
    out = aligned(arrays[0].shape)

    def contender(used: int) -> Contender:
        models = pool(used)

        def run(count: int) -> Array:
            function(used, models, *(x[:count].T for x in arrays), out[:count].T)
            return out[:count]

        return Contender(PARALLEL, used, run, errors, IN_PARALLEL, least=ALL)

    return [contender(used) for used in threads]
