"""A long program as LLVM code: a function for each step of each kind of body, called for one body after the other."""

from __future__ import annotations

import numpy as np

from graphdyn.kernels.aligned import LINE
from graphdyn.kernels.emitter import with_table
from graphdyn.kernels.expressions import Program
from graphdyn.kernels.long_program import CONSTANTS, INSIDE, OWN, BodyProgram, LongProgram
from graphdyn.kernels.vector_code import ALIGNED_STACK, WATCHES, VectorCode, loop_over_rows
from graphdyn.layout import Array


def emit_long(program: LongProgram, lanes: int) -> str:
    """Code of batch and single, as graphdyn.kernels.emitter.emit gives; scratch: a copy of long_scratch."""
    widths = {**program.inputs, **{name: len(columns) for name, columns in program.outputs.items()}}
    functions, code = [], VectorCode(lanes)
    memory = code.element("%scratch", _table(program).size)
    for number, (outwards, steps) in enumerate(program.passes):
        names = {kind: f"step_{number}_{place}" for place, kind in enumerate(steps)}
        functions += [line for kind, name in names.items() for line in _step(steps[kind], name, program, widths, lanes)]
        bodies = list(enumerate(zip(program.kinds, program.inside, strict=True)))
        for body, (kind, inside) in bodies if outwards else reversed(bodies):
            places = [
                code.element("%scratch", body * _table(program).shape[1]),
                code.element(memory, body * program.memory * lanes),
                code.element(memory, max(inside, 0) * program.memory * lanes),
            ]
            for name in _arrays(steps[kind].program, program):
                row = code.let(f"mul i64 %row, {widths[name]}")
                column = code.let(f"add i64 {row}, {body * _share(name, program, widths) % widths[name]}")
                places.append(code.let(f"getelementptr double, ptr %{name}, i64 {column}"))
            code.do(f"call void @{names[kind]}({', '.join(f'ptr {place}' for place in places)}, ptr %watched)")
    pointers = ", ".join(f"ptr %{name}" for name in ("scratch", *widths, "watched"))
    header = f"define internal void @rows(i64 %first, i64 %last, i1 %bypass, {pointers})"
    rows = loop_over_rows(code, header, [])
    return "\n".join([*code.declarations, *functions, *rows, *with_table(lanes, 2 + len(widths))])


def long_scratch(program: LongProgram, lanes: int) -> Array:
    """The table, and memory of the bodies."""
    return np.concatenate([_table(program).ravel(), np.zeros(len(program.kinds) * program.memory * lanes)])


def _table(program: LongProgram) -> Array:
    """Constants of each body from the beginning of a line of memory on."""
    width = program.table.shape[1]
    return np.pad(program.table, ((0, 0), (0, -width % (LINE // 8))))


def _arrays(step: Program, program: LongProgram) -> list[str]:
    """Arrays of the robot that a step reads or writes."""
    return [name for name in (*program.inputs, *program.outputs) if name in step.inputs or name in step.outputs]


def _share(name: str, program: LongProgram, widths: dict[str, int]) -> int:
    """Columns of an array that belong to one body."""
    return widths[name] if name == "ground" else widths[name] // len(program.kinds)


def _step(step: BodyProgram, name: str, program: LongProgram, widths: dict[str, int], lanes: int) -> list[str]:
    code = VectorCode(lanes)

    def columns(array: str) -> list[str]:
        used = {
            column
            for kind, *given in step.program.operations
            if kind == "input"
            for source, column in [given]
            if source == array
        }
        if array == CONSTANTS:
            return [code.broadcast("%constants", k) if k in used else "" for k in range(max(used) + 1)]
        if array in (OWN, INSIDE):
            return [code.load(code.vector, f"%{array}", k * lanes) if k in used else "" for k in range(program.memory)]
        return code.columns_of(f"%{array}", _share(array, program, widths), widths[array])

    values = code.values(step.program, columns)
    outputs = step.program.outputs
    for number, column in zip(outputs[OWN], step.kept, strict=True):
        code.store(f"{code.vector} {values[number]}", "%own", column * lanes)
    for number, column in zip(outputs[INSIDE], step.summed, strict=True):
        total = code.arithmetic("fadd", code.load(code.vector, "%inside", column * lanes), values[number])
        code.store(f"{code.vector} {total}", "%inside", column * lanes)
    for array in program.outputs:
        if array in outputs:
            code.write_columns(f"%{array}", widths[array], {k: values[x] for k, x in enumerate(outputs[array])})
    for place, kind in enumerate(WATCHES):
        if kind in step.program.watches:
            before = code.load(code.vector, "%watched", place * lanes)
            seen = code.watch(kind, [values[k] for k in step.program.watches[kind]], before)
            code.store(f"{code.vector} {seen}", "%watched", place * lanes)
    pointers = [CONSTANTS, OWN, INSIDE, *_arrays(step.program, program), "watched"]
    arguments = ", ".join(f"ptr noalias %{pointer}" for pointer in pointers)
    return [f"define internal void @{name}({arguments}) {ALIGNED_STACK} {{", *code.lines, "  ret void", "}"]
