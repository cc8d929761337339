"""Pinocchio in the benchmark: one call per state in a Python loop, and its own loops over threads."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from crosscheck.bench.contender import UNLIMITED_SAMPLES, Contender, Forms
from crosscheck.bench.states import States
from crosscheck.quantities import QUANTITIES
from crosscheck.reference.pinocchio_model import FrameFunction, NativeFunction
from graphdyn.compiler import aligned
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.recursions import ARRAY_SPECS
from graphdyn.verbs import VERBS

PINOCCHIO_LOOP, PINOCCHIO_PARALLEL = "pinocchio loop", "pinocchio InParallel"
PYTHON_LOOP_NOTE = "a Python loop, results copied to given memory"
POOL_NOTE = "results written to given memory, pool of models made before"

MAX_LOOPED_SAMPLES = 20_000
"""Largest number of samples of matrices that a loop writes."""


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
        Contender(PINOCCHIO_LOOP, 1, loop, states.torque_errors, PYTHON_LOOP_NOTE),
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
        Contender(PINOCCHIO_LOOP, 1, loop, states.acceleration_errors, PYTHON_LOOP_NOTE),
        *_in_parallel(
            bare.aba_in_parallel, bare.pool, (states.q, states.v, states.tau), threads, states.acceleration_errors
        ),
    ]


def solve_kkt(states: States, threads: Sequence[int]) -> list[Contender]:
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
    return [Contender(f"{PINOCCHIO_LOOP} (aba + rnea)", 1, loop, None, included)]


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

    return [Contender(PINOCCHIO_LOOP, 1, loop, states.regressor_errors, PYTHON_LOOP_NOTE, most=MAX_LOOPED_SAMPLES)]


def inverse_derivatives(states: States, threads: Sequence[int]) -> list[Contender]:
    names = VERBS["inverse_dynamics_derivatives"].outputs
    return _derivatives(states, states.bare.rnea_derivatives, states.a, names)


def forward_derivatives(states: States, threads: Sequence[int]) -> list[Contender]:
    names = VERBS["forward_dynamics_derivatives"].outputs
    return _derivatives(states, states.bare.aba_derivatives, states.tau, names)


def _derivatives(
    states: States, function: Callable[..., tuple[Array, Array, Array]], given: Array, names: Sequence[str]
) -> list[Contender]:
    """given: the accelerations or torques at which the function differentiates"""
    n, model, data = states.model.n_bodies, states.bare.model, states.bare.data
    out = np.empty((len(names), min(len(states), MAX_LOOPED_SAMPLES), n, n))
    by_q, by_v, by_given = out

    def loop(count: int) -> Array:
        for k, (q, v, x) in enumerate(zip(states.q[:count], states.v[:count], given[:count], strict=True)):
            by_q[k], by_v[k], by_given[k] = function(model, data, q, v, x)
        return out[:, :count]

    return [
        Contender(PINOCCHIO_LOOP, 1, loop, states.quantity_errors(names), PYTHON_LOOP_NOTE, most=MAX_LOOPED_SAMPLES)
    ]


def quantity(name: str) -> Forms:
    """A loop of the function of Pinocchio that the table of quantities has for this verb; it takes the same arrays."""
    theirs = QUANTITIES[name].pinocchio
    assert isinstance(theirs, NativeFunction | FrameFunction)

    def forms(states: States, threads: Sequence[int]) -> list[Contender]:
        function, model, data = theirs.native, states.bare.model, states.bare.data
        further = states.bare.tip if VERBS[name].of_frame else ()
        inputs = [getattr(states, array) for array in VERBS[name].inputs]
        (output,) = VERBS[name].outputs
        out = np.empty((min(len(states), MAX_LOOPED_SAMPLES), *ARRAY_SPECS[output].shape_for(states.model)))

        def loop(count: int) -> Array:
            for k, row in enumerate(zip(*(x[:count] for x in inputs), strict=True)):
                out[k] = function(model, data, *row, *further)
            return out[None, :count]

        return [
            Contender(
                PINOCCHIO_LOOP, 1, loop, states.quantity_errors([output]), PYTHON_LOOP_NOTE, most=MAX_LOOPED_SAMPLES
            )
        ]

    return forms


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

        return Contender(PINOCCHIO_PARALLEL, used, run, errors, POOL_NOTE, least=UNLIMITED_SAMPLES)

    return [contender(used) for used in threads]
