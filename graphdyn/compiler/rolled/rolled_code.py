"""Programs of long robots as LLVM code: a function for each step of each kind of body, called body after body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphdyn.compiler.llvm.emitter import with_table
from graphdyn.compiler.llvm.memory import CACHE_LINE_BYTES
from graphdyn.compiler.llvm.vector_code import ALIGNED_STACK, GUARD_KINDS, VectorCode, loop_over_rows
from graphdyn.layout import Array
from graphdyn.scalars.expressions import Guard, Program

OWN, INSIDE, CONSTANTS = "own", "inside", "constants"
"""Arrays of a step beside those of the robot: memory of the body and of its inside body, its row of the table."""

GROUND_ARRAY_NAME = "ground"
"""The array of the robot that belongs to no body."""


@dataclass(frozen=True)
class Kind:
    """What bodies have in common whose steps are one function. at_ground: whether the inside body is the ground"""

    prismatic: bool
    quarters: int
    at_ground: bool


@dataclass(frozen=True)
class BodyProgram:
    """A step of a kind. Its program reads OWN, INSIDE, CONSTANTS and a body's columns of the robot's arrays.

    kept: columns of OWN that its output OWN overwrites; summed: columns of INSIDE to which its output INSIDE is added
    """

    program: Program
    kept: tuple[int, ...]
    summed: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class LongProgram:
    """Pass after pass over the bodies.

    kinds: of every body; inside: number of its inside body, -1 for the ground; table: its constants (bodies, …)
    passes: whether outwards, and the step of each kind
    inputs, outputs: widths of the robot's arrays; guards: kinds of guards; memory: vectors of each body
    """

    kinds: tuple[Kind, ...]
    inside: tuple[int, ...]
    table: Array
    passes: tuple[tuple[bool, Mapping[Kind, BodyProgram]], ...]
    inputs: dict[str, int]
    outputs: dict[str, range]
    guards: tuple[Guard, ...]
    memory: int

    @cached_property
    def arithmetic(self) -> int:
        """Operations of a sample."""
        return sum(steps[kind].program.arithmetic for _, steps in self.passes for kind in self.kinds)


def emit_long(program: LongProgram, lanes: int) -> str:
    """Code of batch and single, as graphdyn.compiler.llvm.emitter.emit gives; scratch: a copy of long_scratch."""
    widths = {**program.inputs, **{name: len(columns) for name, columns in program.outputs.items()}}
    functions, code = [], VectorCode(lanes)
    for name, width in widths.items():
        if width == len(program.kinds):  # a number for each body: lines that it would wait for
            code.fetch_ahead(code.rows_of(name, width), width, turns=1, to_write=name in program.outputs)
    for number, (outwards, steps) in enumerate(program.passes):
        names = {kind: f"step_{number}_{place}" for place, kind in enumerate(steps)}
        functions += [line for kind, name in names.items() for line in _step(steps[kind], name, program, widths, lanes)]
        bodies = range(len(program.kinds))
        # calls, one after the other: inside bodies first on the way out, last on the way in
        for body in bodies if outwards else reversed(bodies):
            kind = program.kinds[body]
            places = ", ".join(f"ptr {place}" for place in _places(code, program, body, steps[kind].program, widths))
            code.do(f"call void @{names[kind]}({places}, ptr %guards)")
    pointers = ", ".join(f"ptr %{name}" for name in ("scratch", *widths, "guards"))
    header = f"define internal void @rows(i64 %first, i64 %last, i1 %bypass, {pointers})"
    rows = loop_over_rows(code, header, [])
    return "\n".join([*code.declarations, *functions, *rows, *with_table(lanes, 2 + len(widths))])


def _places(code: VectorCode, program: LongProgram, body: int, step: Program, widths: dict[str, int]) -> Iterator[str]:
    """Addresses of the constants of a body, its memory, that of its inside body, and its columns of the arrays."""
    row, memory = _row(program), program.memory * code.lanes
    # scratch: the table with a row of constants for each body, then the memory of each body
    first = row * len(program.kinds)
    yield code.element("%scratch", body * row)
    yield code.element("%scratch", first + body * memory)
    yield code.element("%scratch", first + max(program.inside[body], 0) * memory)  # unused beside the ground
    for name in _arrays(step, program):
        column = 0 if name == GROUND_ARRAY_NAME else body * _share(name, program, widths)
        yield code.element(code.rows_of(name, widths[name]), column)


def long_scratch(program: LongProgram, lanes: int) -> Array:
    """The table, and memory of the bodies."""
    table = np.pad(program.table, ((0, 0), (0, _row(program) - program.table.shape[1])))
    return np.concatenate([table.ravel(), np.zeros(len(program.kinds) * program.memory * lanes)])


def _row(program: LongProgram) -> int:
    """Constants of a body, with as many behind them as fill lines of memory."""
    width: int = program.table.shape[1]
    return width + -width % (CACHE_LINE_BYTES // 8)


def _arrays(step: Program, program: LongProgram) -> list[str]:
    """Arrays of the robot that a step reads or writes."""
    return [name for name in (*program.inputs, *program.outputs) if name in step.inputs or name in step.outputs]


def _share(name: str, program: LongProgram, widths: dict[str, int]) -> int:
    """Columns of an array that belong to one body."""
    return widths[name] if name == GROUND_ARRAY_NAME else widths[name] // len(program.kinds)


def _step(step: BodyProgram, name: str, program: LongProgram, widths: dict[str, int], lanes: int) -> list[str]:
    code = VectorCode(lanes)

    def columns(array: str) -> list[str]:
        inputs = [given for kind, *given in step.program.operations if kind == "input"]
        used = {column for name, column in inputs if name == array}
        # one number of the table for all lanes; memory holds a vector per column already
        if array == CONSTANTS:
            rows = range(max(used) + 1)
            return [code.broadcast(code.load("double", "%constants", k)) if k in used else "" for k in rows]
        if array in (OWN, INSIDE):
            return [code.load(code.vector, f"%{array}", k * lanes) if k in used else "" for k in range(program.memory)]
        return code.columns_of(f"%{array}", _share(array, program, widths), widths[array])

    values = code.values(step.program, columns)
    outputs = step.program.outputs
    for number, column in zip(outputs[OWN], step.kept, strict=True):
        code.store(f"{code.vector} {values[number]}", "%own", column * lanes)
    # sums of the inside body: several bodies outside may add to them
    for number, column in zip(outputs[INSIDE], step.summed, strict=True):
        total = code.arithmetic("fadd", code.load(code.vector, "%inside", column * lanes), values[number])
        code.store(f"{code.vector} {total}", "%inside", column * lanes)
    for array in program.outputs:
        if array in outputs:
            code.write_columns(f"%{array}", widths[array], {k: values[x] for k, x in enumerate(outputs[array])})
    # in memory, as every step of every body goes on guarding
    for place, kind in enumerate(GUARD_KINDS):
        if kind in step.program.guards:
            before = code.load(code.vector, "%guards", place * lanes)
            seen = code.guard(kind, [values[k] for k in step.program.guards[kind]], before)
            code.store(f"{code.vector} {seen}", "%guards", place * lanes)
    pointers = [CONSTANTS, OWN, INSIDE, *_arrays(step.program, program), "guards"]
    arguments = ", ".join(f"ptr noalias %{pointer}" for pointer in pointers)
    return [f"define internal void @{name}({arguments}) {ALIGNED_STACK} {{", *code.lines, "  ret void", "}"]
