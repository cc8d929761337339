"""Long robots: a step of one body is recorded once, and done for one body after the other.

Straight-line code grows with the robot, and compiling it takes longer than in proportion. Here constants come from a
table, and what later steps need of a body is kept in memory of its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import prod

from graphdyn.compiler.programs import JOINT_ARRAYS, Request, for_joints_only, pivot_scales, reduced_links
from graphdyn.compiler.rolled.program import (
    CARRIED,
    MEMORY,
    BodyProgram,
    Columns,
    Layout,
    LongProgram,
    Pass,
    Place,
    RecordedColumns,
    RecordedPass,
)
from graphdyn.compiler.rolled.recording import PER_BODY, Shared, pruned
from graphdyn.compiler.rolled.steps import bodies, derivatives, frames, matrices, regressors, sums
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.mechanism.mechanism import links
from graphdyn.scalars.expressions import Guard

MOST_UNROLLED = {
    **dict.fromkeys((*bodies.PASSES, *sums.PASSES, *frames.PASSES), 24),
    **dict.fromkeys(matrices.PASSES, 14),
    **dict.fromkeys(derivatives.PASSES, 8),
    **dict.fromkeys(regressors.PASSES, 6),
}
"""Bodies up to which straight-line code is compiled, by recursion. It leaves out what is zero for single bodies, and is
up to twice as fast; but beyond, compiling it takes a second and more, and rolled code a tenth of that."""

MOST_UNROLLED_WITH_REACTIONS = 16
"""The same for inverse and forward dynamics of which more is asked than what the joints need."""

PASSES: dict[str, tuple[Pass | Columns, ...]] = {
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
    passes: list[RecordedPass | RecordedColumns] = []
    for each in PASSES[request.recursion]:
        if isinstance(each, Pass):
            passes.append(shared.record(each))
        else:
            inner = tuple(shared.record(one, in_columns=True) for one in each.passes)
            passes.append(RecordedColumns(inner, each.of_frame))
    outputs = {name: prod(shared.size(name)) for name in request.outputs}
    inputs = list(shared.recursion.inputs)
    inputs += ["external_wrenches"] * request.external + ["ground"] * request.moving_base
    passes = _replaced(passes, pruned(list(_steps(passes)), set(outputs)))
    passes, widths = _dense(passes, shared)
    arrays, vectors = _layouts(shared, widths, {*inputs, *outputs, *_used(passes)})
    n = model.n_bodies
    guarded = any(step.program.guards for step in _steps(passes))
    pivots: tuple[Guard, ...] = ("minimum",) if guarded else ()
    return LongProgram(
        prismatic=tuple(link.prismatic for link in chain),
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


def _steps(passes: Iterable[RecordedPass | RecordedColumns]) -> Iterable[BodyProgram]:
    for each in passes:
        for one in each.passes if isinstance(each, RecordedColumns) else (each,):
            yield from one.steps.values()


def _replaced(
    passes: Iterable[RecordedPass | RecordedColumns], steps: Iterable[BodyProgram]
) -> list[RecordedPass | RecordedColumns]:
    """The passes with other steps, in the order of _steps."""
    pending = iter(steps)

    def of_pass(one: RecordedPass) -> RecordedPass:
        return RecordedPass(one.order, {kind: next(pending) for kind in one.steps})

    return [
        RecordedColumns(tuple(map(of_pass, each.passes)), each.of_frame)
        if isinstance(each, RecordedColumns)
        else of_pass(each)
        for each in passes
    ]


def _used(passes: Iterable[RecordedPass | RecordedColumns]) -> set[str]:
    """Arrays in between that steps still write."""
    written = {write.place.array for step in _steps(passes) for write in step.writes}
    return written - {MEMORY, CARRIED}


def _dense(
    passes: list[RecordedPass | RecordedColumns], shared: Shared
) -> tuple[list[RecordedPass | RecordedColumns], dict[str, int]]:
    """The passes with columns of memory that are used, one after the other; and how many these are."""
    used: dict[str, set[int]] = {MEMORY: set(), CARRIED: set()}
    for step in _steps(passes):
        for write in step.writes:
            used.get(write.place.array, set()).update(write.columns)
        for kind, *given in step.program.operations:
            if kind == "input":
                used.get(given[0].array, set()).add(given[1])
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

    dense = _replaced(passes, [of_step(step) for step in _steps(passes)])
    return dense, {space: len(columns) for space, columns in new.items()}


def _layouts(shared: Shared, widths: dict[str, int], names: set[str]) -> tuple[dict[str, Layout], int]:
    """Where the arrays are, and how many vectors they take. Memory has a block for each body and one for the ground."""
    n = shared.model.n_bodies
    arrays = {
        MEMORY: Layout(0, (n + 1) * widths[MEMORY], (widths[MEMORY],)),
        CARRIED: Layout((n + 1) * widths[MEMORY], widths[CARRIED], ()),
    }
    first = arrays[CARRIED].first + arrays[CARRIED].width
    for name in sorted(names):
        sizes = shared.size(name)
        strides = tuple(
            PER_BODY[size] * prod(sizes[k + 1 :]) for k, size in enumerate(shared.shape(name)) if isinstance(size, str)
        )
        arrays[name] = Layout(first, prod(sizes), strides)
        first += prod(sizes)
    return arrays, first
