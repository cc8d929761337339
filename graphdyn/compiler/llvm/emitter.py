"""Sines and cosines one turn of a loop ahead.

Everything waits for sines and cosines, and they wait for nothing: those of the following rows are computed while the
processor waits for other results of these rows.

A program as LLVM code: all constants in place, one loop over the rows of the arrays.

Rows of wide arrays are assembled in the first-level cache, where their constant columns already are, and written from
there as whole cache lines.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.compiler.llvm.columns import columns_to_rows
from graphdyn.compiler.llvm.precision import DOUBLE, Precision
from graphdyn.compiler.llvm.vector_code import GUARD_KINDS, Carried, VectorCode, loop_over_rows
from graphdyn.layout import Array
from graphdyn.scalars.expressions import Program, program_of

Turns = dict[int, tuple[str, str]]
"""Names of sine and cosine of angles, by the number of the angle."""


def sincos_pipelining(program: Program, lanes: int, precision: Precision) -> tuple[Turns, Carried]:
    """All sines and cosines as the lines of the loop know them, and what computes them a turn before."""
    angles = sorted({given[0] for kind, *given in program.operations if kind in ("sine", "cosine")})
    # the operations that lead to the angles: none where these are inputs
    part = program_of(program.operations, program.inputs, {"angles": angles}, {})
    # phi nodes of these names hold the pair of a turn, and get that of the next one at its end
    turns = {angle: (f"%sine{angle}", f"%cosine{angle}") for angle in angles}
    names = [name for pair in turns.values() for name in pair]
    first, following = VectorCode(lanes, "f", precision), VectorCode(lanes, "n", precision)
    return turns, Carried(names, _turns(part, first, "%first"), _turns(part, following, "%next"))


def _turns(part: Program, code: VectorCode, row: str) -> tuple[VectorCode, list[str]]:
    """Code for the rows from this one on, and sine and cosine of its angles in turn."""

    def columns(name: str) -> list[str]:
        width = part.inputs[name]
        return code.columns_of(code.rows_of(f"in.{name}", width, row), width)

    values = code.values(part, columns)
    return code, [name for k in part.outputs["angles"] for name in code.sine_and_cosine(values[k])]


MIN_WIDE_COLUMNS = 16
"""Columns from which rows are assembled first: below, writing whole lines does not pay."""

MIN_COLUMNS_IN_MEMORY = 128
"""Columns of an array from which they are kept in memory as vectors, and turned into rows in a loop: code that writes
each of them takes longer to compile than what is computed for it."""

MIN_SHARE_OF_BLOCKS = 0.75
"""Share of the columns in blocks of as many as lanes that must not be constant: the loop turns whole blocks."""

# few: number by number. deliver, with bypass: numbers until the address is a multiple of a vector (head), vectors past
# the caches (nontemporal, which asks for such addresses), numbers that are left (tail); without: plain copies.
_DELIVER = """define internal void @few(ptr noalias %to, ptr noalias %from, i64 %first, i64 %last) {{
entry:
  %any = icmp slt i64 %first, %last
  br i1 %any, label %loop, label %exit
loop:
  %i = phi i64 [ %first, %entry ], [ %next, %loop ]
  %i.from = getelementptr {real}, ptr %from, i64 %i
  %i.to = getelementptr {real}, ptr %to, i64 %i
  %i.value = load {real}, ptr %i.from, align {size}
  store {real} %i.value, ptr %i.to, align {size}
  %next = add i64 %i, 1
  %more = icmp slt i64 %next, %last
  br i1 %more, label %loop, label %exit
exit:
  ret void
}}
define internal void @deliver(ptr noalias %to, ptr noalias %from, i64 %count, i1 %bypass) {{
entry:
  br i1 %bypass, label %before, label %plain
plain:
  %i = phi i64 [ 0, %entry ], [ %i.next, %plain ]
  %i.from = getelementptr {vector}, ptr %from, i64 %i
  %i.to = getelementptr {vector}, ptr %to, i64 %i
  %i.value = load {vector}, ptr %i.from, align {size}
  store {vector} %i.value, ptr %i.to, align {size}
  %i.next = add i64 %i, 1
  %i.more = icmp slt i64 %i.next, %count
  br i1 %i.more, label %plain, label %exit
before:
  %address = ptrtoint ptr %to to i64
  %negative = sub i64 0, %address
  %bytes = and i64 %negative, {mask}
  %head = udiv i64 %bytes, {size}
  %total = mul i64 %count, {lanes}
  %body = sub i64 %total, %head
  %whole = udiv i64 %body, {lanes}
  %covered = mul i64 %whole, {lanes}
  %tail = add i64 %head, %covered
  call void @few(ptr %to, ptr %from, i64 0, i64 %head)
  %lines.from = getelementptr {real}, ptr %from, i64 %head
  %lines.to = getelementptr {real}, ptr %to, i64 %head
  br label %lines
lines:
  %k = phi i64 [ 0, %before ], [ %k.next, %lines ]
  %k.from = getelementptr {vector}, ptr %lines.from, i64 %k
  %k.to = getelementptr {vector}, ptr %lines.to, i64 %k
  %k.value = load {vector}, ptr %k.from, align {size}
  store {vector} %k.value, ptr %k.to, align {bytes}, !nontemporal !0
  %k.next = add i64 %k, 1
  %k.more = icmp slt i64 %k.next, %whole
  br i1 %k.more, label %lines, label %after
after:
  call void @few(ptr %to, ptr %from, i64 %tail, i64 %total)
  br label %exit
exit:
  ret void
}}
!0 = !{{i32 1}}"""
"""Rows to where they are wanted: past the caches whole lines, and single numbers before and after these."""


def emit(program: Program, lanes: int, precision: Precision = DOUBLE, ahead: bool = True) -> str:
    """Code of two functions.

    batch(first, last, bypass, table) for at least as many rows as lanes. bypass: whether the results are so large that
    they should not push everything else out of the caches. table: where the addresses of scratch, inputs, outputs and
    guards stand. scratch: a copy of `scratch`, aligned to a vector. The last rows are done together with some before
    them, which are done twice, with the same result.

    single(table) for as many rows as lanes.

    ahead: sines and cosines of the following rows are computed with these rows, which a call on few rows is better
    without
    """
    code = VectorCode(lanes, precision=precision)
    turns, carried = sincos_pipelining(program, lanes, precision) if ahead else ({}, None)

    def columns(name: str) -> list[str]:
        width = program.inputs[name]
        return code.columns_of(code.rows_of(f"in.{name}", width), width)

    in_memory, functions = _columns_in_memory(program, lanes), []
    places: dict[int, list[int]] = {}
    for name, column_place in in_memory.items():
        for column, k in enumerate(program.outputs[name]):
            if program.constant(k) is None:
                places.setdefault(k, []).append(column_place + column * lanes)

    def stored(number: int, values: Sequence[str]) -> None:
        for place in places.get(number, ()):
            code.store(f"{code.vector} {values[number]}", "%scratch", place)

    values = code.values(program, columns, stored, known_turns=turns)
    first = 0
    for name, numbers in program.outputs.items():
        width = len(numbers)
        to = code.rows_of(f"out.{name}", width)
        # few columns go straight to their place; constants of wide rows are in %scratch from the beginning (scratch)
        if width < MIN_WIDE_COLUMNS:
            code.write_columns(to, width, {column: values[k] for column, k in enumerate(numbers)})
            continue
        block, first = code.element("%scratch", first), first + lanes * width
        if name in in_memory:
            changing = [column for column, k in enumerate(numbers) if program.constant(k) is None]
            functions += columns_to_rows(f"rows_of.{name}", width, lanes, precision, changing)
            of = code.element("%scratch", in_memory[name])
            code.do(f"call void @rows_of.{name}(ptr {block}, ptr {of})")
        else:
            named = {column: values[k] for column, k in enumerate(numbers) if program.constant(k) is None}
            code.write_columns(block, width, named)
        code.do(f"call void @deliver(ptr {to}, ptr {block}, i64 {width}, i1 %bypass)")
    seen = [
        code.guard(kind, [values[k] for k in program.guards.get(kind, ())], f"%guard.{kind}") for kind in GUARD_KINDS
    ]
    arrays = [f"in.{name}" for name in program.inputs] + [f"out.{name}" for name in program.outputs]
    parameters = ["i64 %first", "i64 %last", "i1 %bypass", *(f"ptr noalias %{name}" for name in ("scratch", *arrays))]
    header = f"define internal void @rows({', '.join(parameters)}, ptr %guards)"
    return "\n".join(
        [
            *code.declarations,
            _deliver(code),
            *functions,
            *loop_over_rows(code, header, seen, carried),
            *with_table(lanes, 2 + len(arrays)),
        ]
    )


def _deliver(code: VectorCode) -> str:
    size = code.precision.bytes
    whole = size * code.lanes
    return _DELIVER.format(vector=code.vector, real=code.real, size=size, bytes=whole, mask=whole - 1, lanes=code.lanes)


def _columns_in_memory(program: Program, lanes: int) -> dict[str, int]:
    """Places in scratch where the columns of those arrays begin that have too many to be written one by one."""
    wide = {name: numbers for name, numbers in program.outputs.items() if len(numbers) >= MIN_WIDE_COLUMNS}
    first, found = lanes * sum(map(len, wide.values())), {}
    for name, numbers in wide.items():
        changing = [column for column, k in enumerate(numbers) if program.constant(k) is None]
        blocks = {column // lanes for column in changing}
        if len(changing) >= max(MIN_COLUMNS_IN_MEMORY, MIN_SHARE_OF_BLOCKS * lanes * len(blocks)):
            found[name], first = first, first + lanes * len(numbers)
    return found


def scratch(program: Program, lanes: int, precision: Precision = DOUBLE) -> Array:
    """Rows of wide arrays, one array after the other, with their constant columns; then columns of those with many."""
    rows = [
        np.tile([program.constant(k) or 0.0 for k in numbers], lanes)
        for numbers in program.outputs.values()
        if len(numbers) >= MIN_WIDE_COLUMNS
    ]
    columns = [
        np.repeat([program.constant(k) or 0.0 for k in program.outputs[name]], lanes)
        for name in _columns_in_memory(program, lanes)
    ]
    return np.concatenate([np.empty(0), *rows, *columns]).astype(precision.dtype)


def with_table(lanes: int, count: int) -> list[str]:
    """The same functions for callers to whom every argument costs time."""
    loads = [
        line
        # the table says where the addresses stand, mostly in fields of NumPy's arrays: two loads lead to the data
        for k in range(count)
        for line in (
            f"  %at{k} = getelementptr ptr, ptr %table, i64 {k}",
            f"  %place{k} = load ptr, ptr %at{k}",
            f"  %p{k} = load ptr, ptr %place{k}",
        )
    ]
    pointers = ", ".join(f"ptr %p{k}" for k in range(count))
    return [
        "define void @batch(i64 %first, i64 %last, i1 zeroext %bypass, ptr %table) {",
        *loads,
        f"  call void @rows(i64 %first, i64 %last, i1 %bypass, {pointers})",
        "  ret void",
        "}",
        "define void @single(ptr %table) {",
        f"  call void @batch(i64 0, i64 {lanes}, i1 zeroext false, ptr %table)",
        "  ret void",
        "}",
    ]
