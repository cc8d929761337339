"""Rolled programs as LLVM code: a function for each step of each kind of body, called in loops over the bodies.

While as many samples as lanes are computed, all that is read and written lies in memory in columns, one vector each:
the rows of the inputs are turned into columns before the first step, and columns into rows of the outputs after the
last one.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from graphdyn.compiler.llvm.columns import columns_to_rows, loop_over, rows_to_columns
from graphdyn.compiler.llvm.emitter import with_table
from graphdyn.compiler.llvm.memory import CACHE_LINE_BYTES
from graphdyn.compiler.llvm.precision import DOUBLE, Precision
from graphdyn.compiler.llvm.vector_code import ALIGNED_STACK, GUARD_KINDS, VectorCode, loop_over_rows
from graphdyn.compiler.rolled.program import (
    CONSTANTS,
    BodyProgram,
    Extent,
    LongProgram,
    Order,
    Place,
    Product,
    RecordedColumnPasses,
    RecordedPass,
)
from graphdyn.layout import Array
from graphdyn.scalars.expressions import Guard

SHARED = "ptr %constants, ptr %vectors, ptr %guards"
"""Arguments that every function hands on."""


def emit_long(program: LongProgram, lanes: int, precision: Precision = DOUBLE) -> str:
    """Code of batch and single, as graphdyn.compiler.llvm.emitter.emit gives; scratch: a copy of long_scratch."""
    code, real = VectorCode(lanes, precision=precision), precision.real
    code.do(f"%constants = getelementptr {real}, ptr %scratch, i64 0")
    code.do(f"%vectors = getelementptr {real}, ptr %scratch, i64 {program.table.shape[0] * _row(program, precision)}")
    functions: list[str] = []
    for name, width in program.inputs.items():
        guards: tuple[Guard, ...] = ("finite", "squares") if name == "q" else ("finite",)
        functions += rows_to_columns(f"fetch_{name}", width, lanes, guards, precision)
        to = code.element("%vectors", program.arrays[name].first * lanes)
        code.do(f"call void @fetch_{name}(ptr {code.rows_of(name, width)}, ptr {to}, ptr %guards)")
    for number, each in enumerate(program.passes):
        if isinstance(each, Product):
            functions += _product(f"product_{number}", each, program, lanes, precision)
            code.do(f"call void @product_{number}(ptr %vectors)")
            continue
        inner = each.passes if isinstance(each, RecordedColumnPasses) else (each,)
        names = [f"pass_{number}_{place}" for place in range(len(inner))]
        for name, one in zip(names, inner, strict=True):
            functions += _pass(name, one, program, lanes, precision)
        if isinstance(each, RecordedColumnPasses):
            functions += _columns(f"columns_{number}", each, names, program)
            code.do(f"call void @columns_{number}({SHARED})")
        else:
            code.do(f"call void @{names[0]}({SHARED}, i64 0)")
    for name, columns in program.outputs.items():
        functions += columns_to_rows(f"deliver_{name}", len(columns), lanes, precision)
        of = code.element("%vectors", program.arrays[name].first * lanes)
        code.do(f"call void @deliver_{name}(ptr {code.rows_of(name, len(columns))}, ptr {of})")
    names = [*program.inputs, *program.outputs]
    pointers = ", ".join(f"ptr %{name}" for name in ("scratch", *names, "guards"))
    header = f"define internal void @rows(i64 %first, i64 %last, i1 %bypass, {pointers})"
    tables = [_table("inside", program.inside), _table("kinds", program.kinds)]
    rows = loop_over_rows(code, header, [])
    minimum = "declare i64 @llvm.smin.i64(i64, i64)"
    return "\n".join([minimum, *code.declarations, *tables, *functions, *rows, *with_table(lanes, 2 + len(names))])


def long_scratch(program: LongProgram, lanes: int, precision: Precision = DOUBLE) -> Array:
    """The table of constants with a row for each body, and the vectors."""
    table = np.pad(program.table, ((0, 0), (0, _row(program, precision) - program.table.shape[1])))
    return np.concatenate([table.ravel(), np.zeros(program.vectors * lanes)]).astype(precision.dtype)


def _row(program: LongProgram, precision: Precision) -> int:
    """Constants of a body, with as many behind them as fill lines of memory."""
    width: int = program.table.shape[1]
    return width + -width % (CACHE_LINE_BYTES // precision.bytes)


def _table(name: str, values: tuple[int, ...]) -> str:
    return f"@{name} = internal constant [{len(values)} x i64] [{', '.join(f'i64 {value}' for value in values)}]"


# Products

TILE = 4
"""Rows and columns of a product that are summed at a time: 16 sums in registers, for each pair of 8 numbers read."""


def _product(name: str, product: Product, program: LongProgram, lanes: int, precision: Precision) -> Iterator[str]:
    """product(vectors): tile after tile, the last ones overlapping those before."""
    left, right, to = (program.arrays[array] for array in (product.left, product.right, product.to))
    rows, inner = len(program.inside), len(program.inside)
    columns = right.width // inner
    high, wide = min(TILE, rows), min(TILE, columns)
    code, sums, done = (VectorCode(lanes, prefix, precision) for prefix in "xsd")
    i, j = (
        code.let(f"call i64 @llvm.smin.i64(i64 %{at}, i64 {last})")
        for at, last in (("row", rows - high), ("column", columns - wide))
    )
    reach = str(inner)
    if product.triangular:
        reach = code.let(f"add i64 {i}, {TILE}")
        reach = code.let(f"call i64 @llvm.smin.i64(i64 {reach}, i64 {inner})")
    code.do("br label %sum")

    def at(piece: VectorCode, layout: Extent, row: str, column: str) -> str:
        width = layout.width // inner
        number = piece.let(f"add i64 {piece.let(f'mul i64 {row}, {width}')}, {column}")
        first = piece.element("%vectors", layout.first * lanes)
        return piece.let(f"getelementptr {precision.real}, ptr {first}, i64 {piece.let(f'mul i64 {number}, {lanes}')}")

    x, y = at(sums, left, "%k", i), at(sums, right, "%k", j)
    xs = [sums.load(sums.vector, x, place * lanes) for place in range(high)]
    ys = [sums.load(sums.vector, y, place * lanes) for place in range(wide)]
    pairs = [(a, b) for a in range(high) for b in range(wide)]
    found = [sums.call("fma", xs[a], ys[b], f"%sum{a}.{b}") for a, b in pairs]
    signed = found if product.sign > 0 else [done.let(f"fneg nsz {done.vector} {value}") for value in found]
    for a in range(high):
        row = at(done, to, done.let(f"add i64 {i}, {a}"), j)
        for b in range(wide):
            done.store(f"{done.vector} {signed[a * wide + b]}", row, b * lanes)
    if product.triangular:  # the other half is the same
        for b in range(wide):
            row = at(done, to, done.let(f"add i64 {j}, {b}"), i)
            for a in range(high):
                done.store(f"{done.vector} {signed[a * wide + b]}", row, a * lanes)
    body = [
        *code.lines,
        "sum:",
        "  %k = phi i64 [ 0, %column.do ], [ %k.next, %sum ]",
        *(
            f"  %sum{a}.{b} = phi {code.vector} [ zeroinitializer, %column.do ], [ {value}, %sum ]"
            for (a, b), value in zip(pairs, found, strict=True)
        ),
        *sums.lines,
        "  %k.next = add i64 %k, 1",
        f"  %k.more = icmp slt i64 %k.next, {reach}",
        "  br i1 %k.more, label %sum, label %summed",
        "summed:",
        *done.lines,
    ]
    tiles = list(
        loop_over("column", "%row" if product.triangular else 0, columns + -columns % wide, wide, body, "%row.do")
    )
    yield f"define internal void @{name}(ptr %vectors) {{"
    yield from loop_over("row", 0, rows + -rows % high, high, tiles)
    yield "  ret void"
    yield "}"


# Steps


def _columns(name: str, each: RecordedColumnPasses, passes: list[str], program: LongProgram) -> Iterator[str]:
    """The passes for one column after the other."""
    first, last = (program.frame_body, program.frame_body + 1) if each.of_frame else (0, len(program.inside))
    yield f"define internal void @{name}({SHARED}) {{"
    yield from loop_over("of", first, last, 1, [f"  call void @{one}({SHARED}, i64 %of)" for one in passes])
    yield "  ret void"
    yield "}"


def _pass(name: str, each: RecordedPass, program: LongProgram, lanes: int, precision: Precision) -> Iterator[str]:
    """pass(…, of): the step of body after body; of: the body of the column."""
    for kind, step in each.steps.items():
        if _same(each, kind) == kind:
            yield from _step(f"{name}_{kind}", step, program, VectorCode(lanes, precision=precision))
    n = len(program.inside)
    yield f"define internal void @{name}({SHARED}, i64 %of) {{"
    if each.order == "ground":
        yield f"  call void @{name}_0({SHARED}, i64 {n}, i64 {n}, i64 %of)"
    elif each.order == "frame":
        inside = program.inside[program.frame_body]
        yield f"  call void @{name}_0({SHARED}, i64 {program.frame_body}, i64 {inside}, i64 %of)"
    elif each.order == "column":
        yield from _call(name, each, "%of")
    elif each.order in ("outwards", "inwards"):
        first, last, following = (0, n, 1) if each.order == "outwards" else (n - 1, -1, -1)
        yield from loop_over("body", first, last, following, list(_call(name, each, "%body")))
    else:
        yield from _along_path(each.order, n, list(_call(name, each, "%body")))
    yield "  ret void"
    yield "}"


def _same(each: RecordedPass, kind: int) -> int:
    """The first kind with the same step."""
    return next(k for k, step in each.steps.items() if step == each.steps[kind])


def _along_path(order: Order, n: int, lines: list[str]) -> Iterator[str]:
    """Lines for %body on the way from the column's body to the ground."""
    start = "%of"
    if order == "beyond":
        yield "  %start.at = getelementptr i64, ptr @inside, i64 %of"
        yield "  %start = load i64, ptr %start.at"
        start = "%start"
    yield "  br label %body.test"
    yield "body.test:"
    yield f"  %body = phi i64 [ {start}, %0 ], [ %body.inside, %body.after ]"
    yield f"  %body.more = icmp ne i64 %body, {n}"
    yield "  br i1 %body.more, label %body.do, label %body.done"
    yield "body.do:"
    yield from lines
    yield "  br label %body.after"
    yield "body.after:"
    yield "  br label %body.test"
    yield "body.done:"


def _call(name: str, each: RecordedPass, body: str) -> Iterator[str]:
    """The step of a body, by its kind."""
    yield f"  %inside.at = getelementptr i64, ptr @inside, i64 {body}"
    yield "  %body.inside = load i64, ptr %inside.at"
    call = f"({SHARED}, i64 {body}, i64 %body.inside, i64 %of)"
    if len({_same(each, kind) for kind in each.steps}) == 1:
        yield f"  call void @{name}_{next(iter(each.steps))}{call}"
        return
    yield f"  %kind.at = getelementptr i64, ptr @kinds, i64 {body}"
    yield "  %kind = load i64, ptr %kind.at"
    first, *others = each.steps
    yield f"  switch i64 %kind, label %kind{first} [ {' '.join(f'i64 {k}, label %kind{k}' for k in others)} ]"
    for kind in each.steps:
        yield f"kind{kind}:"
        yield f"  call void @{name}_{_same(each, kind)}{call}"
        yield "  br label %called"
    yield "called:"


def _step(name: str, step: BodyProgram, program: LongProgram, code: VectorCode) -> list[str]:
    lanes, real = code.lanes, code.real
    indices = {"body": "%body", "inside": "%inside", "column": "%column", "ground": str(len(program.inside))}
    known: dict[Place, str] = {}

    def address(place: Place) -> str:
        if place not in known:
            if place.array == CONSTANTS:
                offset = code.let(f"mul i64 %body, {_row(program, code.precision)}")
                known[place] = code.let(f"getelementptr {real}, ptr %constants, i64 {offset}")
            else:
                layout = program.arrays[place.array]
                first = code.element("%vectors", layout.first * lanes)
                for index, stride in zip(place.of, layout.strides, strict=True):
                    offset = code.let(f"mul i64 {indices[index]}, {stride * lanes}")
                    first = code.let(f"getelementptr {real}, ptr {first}, i64 {offset}")
                known[place] = first
        return known[place]

    read: dict[Place, set[int]] = {}
    for kind, *given in step.program.operations:
        if kind == "input":
            read.setdefault(given[0], set()).add(given[1])

    def columns(place: Place) -> dict[int, str]:
        at = address(place)
        if place.array == CONSTANTS:  # one number for all lanes
            return {k: code.broadcast(code.load(real, at, k)) for k in sorted(read[place])}
        return {k: code.load(code.vector, at, k * lanes) for k in sorted(read[place])}

    values = code.values(step.program, columns)
    for k, write in enumerate(step.writes):
        at = address(write.place)
        for number, column in zip(step.program.outputs[str(k)], write.columns, strict=True):
            value = values[number]
            if write.added:  # several bodies outside may add to a sum
                value = code.arithmetic("fadd", code.load(code.vector, at, column * lanes), value)
            code.store(f"{code.vector} {value}", at, column * lanes)
    for place, kind in enumerate(GUARD_KINDS):
        if kind in step.program.guards:
            before = code.load(code.vector, "%guards", place * lanes)
            seen = code.guard(kind, [values[k] for k in step.program.guards[kind]], before)
            code.store(f"{code.vector} {seen}", "%guards", place * lanes)
    arguments = ", ".join(f"ptr noalias %{pointer}" for pointer in ("constants", "vectors", "guards"))
    header = f"define internal void @{name}({arguments}, i64 %body, i64 %inside, i64 %column) {ALIGNED_STACK} {{"
    return [header, *code.lines, "  ret void", "}"]
