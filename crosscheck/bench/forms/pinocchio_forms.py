"""Pinocchio in the benchmark: one call per state in a Python loop, and its own loops over threads."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from crosscheck.bench.contender import UNLIMITED_SAMPLES, Contender, Forms
from crosscheck.bench.states import States
from crosscheck.quantities import QUANTITIES
from crosscheck.reference.native_functions import FrameFunction, NativeFunction
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


def dynamics(forward: bool, states: States, threads: Sequence[int]) -> list[Contender]:
    """Joint accelerations, or joint torques."""
    (inputs, errors), bare = states.dynamics(forward), states.bare
    one, several = (bare.aba, bare.aba_in_parallel) if forward else (bare.rnea, bare.rnea_in_parallel)
    out = aligned(states.q.shape)

    def in_parallel(used: int) -> Contender:
        models = bare.pool(used)

        def run(count: int) -> Array:
            several(used, models, *(x[:count].T for x in inputs), out[:count].T)
            return out[:count]

        return Contender(PINOCCHIO_PARALLEL, used, run, errors, POOL_NOTE, least=UNLIMITED_SAMPLES)

    loop = _looped(states, one, inputs, np.empty(states.q.shape))
    return [Contender(PINOCCHIO_LOOP, 1, loop, errors, PYTHON_LOOP_NOTE), *map(in_parallel, threads)]


def _looped(
    states: States, function: Callable[..., Array], inputs: tuple[Array, Array, Array], out: Array
) -> Callable[[int], Array]:
    """run(count): the function of one state after the other."""
    model, data = states.bare.model, states.bare.data

    def loop(count: int) -> Array:
        for k, (q, v, given) in enumerate(zip(*(x[:count] for x in inputs), strict=True)):
            out[k] = function(model, data, q, v, given)
        return out[:count]

    return loop


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
    n = states.model.n_bodies
    out = np.empty((min(len(states), MAX_LOOPED_SAMPLES), n, BODY_PARAMETERS * n))
    loop = _looped(states, states.bare.torque_regressor, (states.q, states.v, states.a), out)
    return [Contender(PINOCCHIO_LOOP, 1, loop, states.regressor_errors, PYTHON_LOOP_NOTE, most=MAX_LOOPED_SAMPLES)]


def derivatives(forward: bool, states: States, threads: Sequence[int]) -> list[Contender]:
    """Three derivatives of joint accelerations, or of joint torques."""
    (*_, given), _ = states.dynamics(forward)
    function = states.bare.aba_derivatives if forward else states.bare.rnea_derivatives
    names = VERBS[f"{'forward' if forward else 'inverse'}_dynamics_derivatives"].outputs
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
