"""graphdyn's implementations ("forms") of each work: compiled, on NumPy arrays, projected, dense."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import graphdyn
from crosscheck.bench.contender import AMORTIZED_SAMPLES, UNLIMITED_SAMPLES, Contender, Forms
from crosscheck.bench.states import JACOBIAN_REFERENCE, States
from crosscheck.quantities import scales
from crosscheck.reference.subject import tip
from graphdyn import RobotModel
from graphdyn.arguments import Method
from graphdyn.compiler import BACKEND_VARIABLE, TorqueGram, aligned, chosen_backend, torque_gram
from graphdyn.identification import TorqueModel, structure
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import BODY_DOF, BODY_PARAMETERS, JOINT_CONSTRAINTS, Array
from graphdyn.recursions import ARRAY_SPECS
from graphdyn.verbs import VERBS

COMPILED_NAME, RECURSIVE_NAME, PROJECTED_NAME, DENSE_NAME = (
    "graphdyn compiled",
    "graphdyn NumPy",
    "graphdyn projected",
    "dense NumPy",
)

DEFAULT_NAME = "graphdyn by default"
"""The documented call, which chooses its method itself."""

MAX_REGRESSOR_SAMPLES = 100_000
"""Largest number of samples of a regressor that is written out: 300 MB for a six-axis arm."""

RESULTS_WRITTEN_NOTE = "arguments checked, results written to given memory"
NEW_ARRAYS_NOTE = "arguments checked, results in new arrays"


@contextmanager
def backend(name: str) -> Iterator[None]:
    """graphdyn uses this back end within the context."""
    before = os.environ.get(BACKEND_VARIABLE)
    os.environ[BACKEND_VARIABLE] = name
    try:
        yield
    finally:
        if before is None:
            del os.environ[BACKEND_VARIABLE]
        else:
            os.environ[BACKEND_VARIABLE] = before


def our_name() -> str:
    """Name of the form that the method "auto" uses for batches on this machine."""
    return COMPILED_NAME if chosen_backend() == "llvm" else RECURSIVE_NAME


def dynamics(forward: bool, states: States, threads: Sequence[int]) -> list[Contender]:
    """Joint accelerations, or joint torques."""
    inputs, errors = states.dynamics(forward)
    verb = graphdyn.joint_accelerations if forward else graphdyn.joint_torques
    into, projected = _calls(verb, states.model, inputs, aligned(states.q.shape))
    return [*_recursive(into, threads, errors), _projected(projected, errors)]


def solve_kkt(states: States, threads: Sequence[int]) -> list[Contender]:
    """All accelerations and all multipliers; the multipliers are judged."""
    n = states.model.n_bodies
    out = aligned((len(states), n, BODY_DOF)), aligned((len(states), n, JOINT_CONSTRAINTS))

    def run(count: int, method: Method, **options: Any) -> Array:
        q, v, tau = (x[:count] for x in (states.q, states.v, states.tau))
        _, multipliers = graphdyn.solve_kkt(states.model, q, v, tau, method=method, **options)
        return multipliers

    def into(count: int, used: int) -> Array:
        return run(count, "recursive", threads=used, out=(out[0][:count], out[1][:count]))

    size = (BODY_DOF + JOINT_CONSTRAINTS) * n
    dense = f"the {size}×{size} system of Eq. (111) solved for each sample"
    return [
        *_recursive(into, threads, states.multiplier_errors),
        _projected(lambda count: run(count, "projected"), states.multiplier_errors),
        Contender(
            DENSE_NAME, 1, lambda count: run(count, "dense"), states.multiplier_errors, f"{dense}; {NEW_ARRAYS_NOTE}"
        ),
    ]


def regressor(states: States, threads: Sequence[int]) -> list[Contender]:
    n = states.model.n_bodies
    inputs = states.q, states.v, states.a
    out = aligned((min(len(states), MAX_REGRESSOR_SAMPLES), n, BODY_PARAMETERS * n))
    into, projected = _calls(graphdyn.joint_torque_regressor, states.model, inputs, out)
    return [
        *_recursive(into, threads, states.regressor_errors, MAX_REGRESSOR_SAMPLES, ", written out"),
        *_streamed(states, threads),
        _projected(projected, states.regressor_errors),
    ]


def verb(name: str, answer: Callable[..., Any] | None = None) -> Forms:
    """The forms of a work that is one verb.

    answer: the class that holds its arrays, all of one shape, where there are several
    """

    def forms(states: States, threads: Sequence[int]) -> list[Contender]:
        function, outputs = getattr(graphdyn, name), VERBS[name].outputs
        if VERBS[name].of_frame:
            function = partial(function, frame=tip(states.model), reference=JACOBIAN_REFERENCE)
        inputs = [getattr(states, array) for array in VERBS[name].inputs]
        out = aligned((len(outputs), len(states), *ARRAY_SPECS[outputs[0]].shape_for(states.model)))

        def into(count: int, used: int) -> Array:
            written = out[:, :count]
            memory = answer(*written) if answer else written[0]
            function(states.model, *(x[:count] for x in inputs), method="recursive", threads=used, out=memory)
            return written

        return _recursive(into, threads, states.quantity_errors(outputs))

    return forms


def _calls(
    function: Callable[..., Array], model: RobotModel, inputs: Sequence[Array], out: Array
) -> tuple[Callable[..., Array], Callable[[int], Array]]:
    """The function of the first samples: recursively into given memory, and projected into a new array."""

    def into(count: int, used: int) -> Array:
        return function(model, *(x[:count] for x in inputs), method="recursive", threads=used, out=out[:count])

    def projected(count: int) -> Array:
        return function(model, *(x[:count] for x in inputs), method="projected")

    return into, projected


def _recursive(
    run: Callable[..., Array],
    threads: Sequence[int],
    errors: Callable[[Array], Array],
    most: int = UNLIMITED_SAMPLES,
    form: str = "",
) -> list[Contender]:
    """The recursive method, compiled with each number of threads, and on NumPy arrays."""

    def on_arrays(count: int) -> Array:
        with backend("numpy"):
            return run(count, used=1)

    compiled = [
        Contender(
            COMPILED_NAME + form,
            used,
            partial(run, used=used),
            errors,
            RESULTS_WRITTEN_NOTE,
            True,
            UNLIMITED_SAMPLES,
            most,
        )
        for used in threads
        if our_name() == COMPILED_NAME
    ]
    arrays = Contender(
        RECURSIVE_NAME + form, 1, on_arrays, errors, RESULTS_WRITTEN_NOTE, not compiled, AMORTIZED_SAMPLES, most
    )
    return [*compiled, arrays]


def _projected(run: Callable[[int], Array], errors: Callable[[Array], Array]) -> Contender:
    return Contender(PROJECTED_NAME, 1, run, errors, NEW_ARRAYS_NOTE)


def _streamed(states: States, threads: Sequence[int]) -> list[Contender]:
    """Sums of products of the regressor's independent columns, without the regressor."""
    model, columns = states.model, independent_columns(states.model)
    gram = torque_gram(model, columns.tolist())
    nothing = np.empty((len(states), model.n_bodies, 0))

    def run(count: int, used: int) -> Array:
        q, v, a, tau = (x[:count] for x in (states.q, states.v, states.a, states.torque))
        matrices, _ = gram(q, v, a, tau, nothing[:count], threads=used)
        return np.concatenate([matrix.ravel() for matrix in matrices])

    def errors(_: Array) -> Array:
        judged = len(states.regressor)
        equations = np.concatenate([states.regressor[..., columns], states.torque[:judged, :, None]], axis=-1)
        return _gram_errors(run(judged, 1), gram, equations)

    name = f"{our_name()}, streamed"
    included = f"products of the {len(columns)} independent columns summed up per joint instead of writing columns"
    return [
        Contender(name, used, partial(run, used=used), errors, included, True, UNLIMITED_SAMPLES) for used in threads
    ]


def independent_columns(model: RobotModel) -> NDArray[np.int64]:
    """Independent columns of the joint-torque regressor."""
    return structure(TorqueModel(model, (RigidBodies(),))).base.independent


def _gram_errors(flat: Array, gram: TorqueGram, equations: Array) -> Array:
    """Errors per joint, against the products of Pinocchio's equations (N, n, b + 1), relative to lengths of columns."""
    lengths = np.linalg.norm(equations, axis=(0, 1))
    errors, first = [], 0
    for joint, columns in enumerate(gram.columns):
        chosen = np.append(columns, equations.shape[-1] - 1)
        rows, size = equations[:, joint, chosen], len(chosen)
        matrix, first = flat[first : first + size**2].reshape(size, size), first + size**2
        scale = np.outer(lengths[chosen], lengths[chosen])
        errors.append(scales.ratio(np.abs(matrix - rows.T @ rows), scale).max())
    return np.array(errors)
