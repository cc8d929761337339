"""Long robots: a step of one body is recorded once, and done for one body after the other.

Straight-line code grows with the robot, and compiling it takes longer than in proportion. Here constants come from a
table, and what later steps need of a body is kept in memory of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from math import prod

from graphdyn.compiler.programs import JOINT_ARRAYS, Request, for_joints_only, pivot_scales, reduced_links
from graphdyn.compiler.rolled.program import (
    CARRIED,
    MEMORY,
    BodyProgram,
    ColumnPasses,
    Extent,
    LongProgram,
    Pass,
    Place,
    Product,
    Recorded,
    RecordedColumnPasses,
    RecordedPass,
)
from graphdyn.compiler.rolled.recording import PER_BODY, Shared, with_needed
from graphdyn.compiler.rolled.steps import bodies, derivatives, frames, matrices, regressors, sums
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.mechanism.mechanism import links
from graphdyn.scalars.expressions import Guard

MOST_UNROLLED = {
    **dict.fromkeys((*bodies.PASSES, *sums.PASSES, *frames.PASSES), 24),
    "energy_regressor": 16,
    **dict.fromkeys(matrices.PASSES, 12),
    "mass_matrix_inverse": 16,
    **dict.fromkeys(derivatives.PASSES, 8),
    "forward_dynamics_derivatives": 7,
    "reaction_derivatives": 0,
    **dict.fromkeys(regressors.PASSES, 10),
    "body_regressor": 6,
    "forward_dynamics_parameter_derivatives": 7,
}
"""Bodies up to which straight-line code is compiled, by recursion. It leaves out what is zero for single bodies, and is
up to twice as fast; but beyond, compiling it takes more than half a second, and rolled code a tenth of a second. Rolled
derivatives of reactions are faster for any robot."""

MOST_UNROLLED_WITH_REACTIONS = 16
"""The same for inverse and forward dynamics of which more is asked than what the joints need."""

PASSES: dict[str, tuple[Pass | ColumnPasses | Product, ...]] = {
    **bodies.PASSES,
    **matrices.PASSES,
    **derivatives.PASSES,
    **sums.PASSES,
    **regressors.PASSES,
    **frames.PASSES,
}
"""Recursions that have rolled code."""


def is_long(model: RobotModel, request: Request) -> bool:
    """Whether a request is traced as rolled code: trees without couplings and chords, and recursions of PASSES."""
    if request.recursion not in PASSES or model.couplings or model.chords:
        return False
    if request.frame is not None and not model.frame(request.frame.name).body:  # of the ground
        return False
    return model.n_bodies > most_unrolled(request)


def most_unrolled(request: Request) -> int:
    """Bodies up to which a request is compiled as straight-line code."""
    if request.recursion in bodies.PASSES and not JOINT_ARRAYS.issuperset(request.outputs):
        return MOST_UNROLLED_WITH_REACTIONS
    return MOST_UNROLLED[request.recursion]


def record_long(model: RobotModel, request: Request) -> LongProgram:
    chain = reduced_links(model) if for_joints_only(model, request) else links(model)
    shared = Shared(model, request, chain, pivot_scales(model), at_joint_1=request.recursion not in bodies.PASSES)
    passes = [_recorded(shared, each) for each in PASSES[request.recursion]]
    outputs = {name: prod(shared.size(name)) for name in request.outputs}
    inputs = list(shared.recursion.inputs)
    inputs += ["external_wrenches"] * request.external + ["ground"] * request.moving_base
    passes = _pruned(passes, shared, set(outputs))
    passes, widths = _dense(passes)
    arrays, vectors = _extents(shared, widths, {*inputs, *outputs, *_answered(passes)})
    n = model.n_bodies
    guarded = any(step.program.guards for step in _steps(passes))
    pivots: tuple[Guard, ...] = ("minimum",) if guarded else ()
    return LongProgram(
        kinds=shared.kinds,
        inside=tuple(link.inside if link.inside >= 0 else n for link in chain),
        table=shared.table,
        passes=tuple(passes),
        arrays=arrays,
        vectors=vectors,
        frame_body=shared.frame.body if shared.frame is not None else 0,
        inputs={name: prod(shared.size(name)) for name in inputs},
        outputs={name: range(width) for name, width in outputs.items()},
        guards=("finite", "squares", *pivots),
    )


def _recorded(shared: Shared, each: Pass | ColumnPasses | Product) -> Recorded:
    if isinstance(each, Product):
        return each
    if isinstance(each, Pass):
        return shared.record(each)
    return RecordedColumnPasses(tuple(shared.record(one, in_columns=True) for one in each.passes), each.of_frame)


def _steps(passes: Iterable[Recorded]) -> Iterator[BodyProgram]:
    for each in passes:
        if not isinstance(each, Product):
            for one in each.passes if isinstance(each, RecordedColumnPasses) else (each,):
                yield from one.steps.values()


def _changed(passes: Iterable[Recorded], change: Callable[[BodyProgram], BodyProgram]) -> list[Recorded]:
    """The passes with their steps changed."""

    def of_pass(one: RecordedPass) -> RecordedPass:
        return RecordedPass(one.order, {kind: change(step) for kind, step in one.steps.items()})

    return [
        RecordedColumnPasses(tuple(map(of_pass, each.passes)), each.of_frame)
        if isinstance(each, RecordedColumnPasses)
        else of_pass(each)
        if isinstance(each, RecordedPass)
        else each
        for each in passes
    ]


def _pruned(passes: list[Recorded], shared: Shared, outputs: set[str]) -> list[Recorded]:
    """The passes without what no answer needs, sums among them to which every body adds its own."""
    needed: set[tuple[str, int]] = set()
    while True:
        shorter = _changed(passes, partial(with_needed, needed=frozenset(needed), outputs=outputs))
        read = {place for step in _steps(shorter) for place in _read(step)}
        for each in passes:
            if isinstance(each, Product) and (each.to in outputs or (each.to, 0) in needed):
                read |= {(name, column) for name in (each.left, each.right) for column in shared.part(name)}
        if read <= needed:
            return [each for each in shorter if not isinstance(each, Product) or (each.left, 0) in needed]
        needed |= read


def _read(step: BodyProgram) -> Iterator[tuple[str, int]]:
    for kind, *given in step.program.operations:
        if kind == "input":
            yield given[0].array, given[1]


def _answered(passes: Iterable[Recorded]) -> set[str]:
    """Arrays that steps and products write."""
    written = {write.place.array for step in _steps(passes) for write in step.writes}
    return {*written, *(each.to for each in passes if isinstance(each, Product))} - {MEMORY, CARRIED}


def _dense(passes: list[Recorded]) -> tuple[list[Recorded], dict[str, int]]:
    """The passes with columns of memory that are used, one after the other; and how many these are."""
    used: dict[str, set[int]] = {MEMORY: set(), CARRIED: set()}
    for step in _steps(passes):
        for write in step.writes:
            used.get(write.place.array, set()).update(write.columns)
        for array, column in _read(step):
            used.get(array, set()).add(column)
    new = {space: {column: k for k, column in enumerate(sorted(columns))} for space, columns in used.items()}

    def moved(place: Place, column: int) -> int:
        return new[place.array][column] if place.array in new else column

    def of_step(step: BodyProgram) -> BodyProgram:
        operations = tuple(
            ("input", given[0], moved(*given)) if kind == "input" else (kind, *given)
            for kind, *given in step.program.operations
        )
        writes = tuple(
            replace(write, columns=tuple(moved(write.place, column) for column in write.columns))
            for write in step.writes
        )
        return BodyProgram(replace(step.program, operations=operations), writes)

    # an odd number of vectors, as powers of two would put all bodies in the same few sets of the caches
    return _changed(passes, of_step), {space: len(columns) | 1 for space, columns in new.items()}


def _extents(shared: Shared, widths: dict[str, int], names: set[str]) -> tuple[dict[str, Extent], int]:
    """The extents of the arrays, and vectors in all. Memory has a block for each body and one for the ground."""
    n = shared.model.n_bodies
    arrays = {
        MEMORY: Extent(0, (n + 1) * widths[MEMORY], (widths[MEMORY],)),
        CARRIED: Extent((n + 1) * widths[MEMORY], widths[CARRIED], ()),
    }
    first = arrays[CARRIED].first + arrays[CARRIED].width
    for name in sorted(names):
        sizes = shared.size(name)
        strides = tuple(
            PER_BODY[size] * prod(sizes[k + 1 :]) for k, size in enumerate(shared.shape(name)) if isinstance(size, str)
        )
        arrays[name] = Extent(first, prod(sizes), strides)
        first += prod(sizes)
    return arrays, first
