"""Sums of products of columns as LLVM code: Gram matrices of equations that are never stored as rows.

A stretch of samples is evaluated into the second-level cache, column after column; then tiles of the Gram matrices are
summed over the stretch in registers. One vector per sum: each lane has seen its own samples.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from graphdyn.compiler.llvm.vector_code import GUARD_KINDS, VectorCode, loop_over_rows
from graphdyn.scalars.expressions import MULTIPLIED_COLUMNS, Program

COLUMN_VECTORS = 48
"""Vectors of a column before they are summed: 150 columns of a six-axis arm take 460 kB, and the sums, which go through
the same cache, are touched three times less often than with 16."""

COLUMN_STRIDE = COLUMN_VECTORS + 1
"""Vectors from one column to the next: a power of two would put all columns in the same few sets of the caches."""


def tiles(groups: Sequence[int], lanes: int) -> list[tuple[list[int], list[int]]]:
    """Columns of the left and of the right factors of each tile; the groups lie one after the other."""
    size = 5 if lanes == 8 else 3  # size² sums and size + 1 factors at a time: 32 registers with 8 lanes, else 16
    result, first = [], 0
    for width in groups:
        parts = [list(range(k, min(k + size, first + width))) for k in range(first, first + width, size)]
        result += [(left, right) for i, left in enumerate(parts) for right in parts[i:]]
        first += width
    return result


def products(groups: Sequence[int], lanes: int) -> list[tuple[int, int]]:
    """The sums in their order: pairs of columns, each once."""
    return [(x, y) for left, right in tiles(groups, lanes) for x in left for y in right if x <= y]


def emit_gram(program: Program, groups: Sequence[int], lanes: int) -> str:
    """Code of gram(first, last, scratch, inputs…, sums, guards) for a number of rows that is a multiple of the lanes.

    scratch: COLUMN_STRIDE vectors for each column; sums: one vector for each of products, to which is added
    """
    width = len(program.outputs[MULTIPLIED_COLUMNS])
    assert sum(groups) == width
    code = VectorCode(lanes)
    # where these rows are in each column of scratch, whose columns begin with row %first
    block = code.let(f"getelementptr double, ptr %scratch, i64 {code.let('sub i64 %row, %first')}")
    # several columns may be the same operation
    places: dict[int, list[int]] = defaultdict(list)
    for column, number in enumerate(program.outputs[MULTIPLIED_COLUMNS]):
        places[number].append(column)

    def store(number: int, values: Sequence[str]) -> None:
        for column in places[number]:
            code.store(f"{code.vector} {values[number]}", block, column * COLUMN_STRIDE * lanes)

    def columns(name: str) -> list[str]:
        width = program.inputs[name]
        rows = code.rows_of(f"in.{name}", width)
        code.fetch_ahead(rows, width)
        return code.columns_of(rows, width)

    values = code.values(program, columns, store)
    seen = [
        code.guard(kind, [values[k] for k in program.guards.get(kind, ())], f"%guard.{kind}") for kind in GUARD_KINDS
    ]
    inputs = [f"ptr noalias %in.{name}" for name in program.inputs]
    shared = ", ".join(["i64 %first", "i64 %last", "ptr noalias %scratch", *inputs])
    return "\n".join(
        [
            *code.declarations,
            *loop_over_rows(code, f"define internal void @columns({shared}, ptr %guards)", seen),
            *_sum_up(groups, lanes),
            *_drive(shared, [argument.replace("noalias ", "") for argument in inputs], lanes),
        ]
    )


def _sum_up(groups: Sequence[int], lanes: int) -> list[str]:
    """sum_up(blocks, scratch, sums): tile after tile. Tiles of one shape share a function: there are few shapes."""
    code, place = VectorCode(lanes), 0
    functions: dict[str, list[str]] = {}
    for left, right in tiles(groups, lanes):
        # places within the tile; of a tile on the diagonal the upper triangle
        pairs = [(x - left[0], y - right[0]) for x in left for y in right if x <= y]
        name = f"tile_{len(left)}_{'itself' if left == right else len(right)}"
        if name not in functions:
            functions[name] = _tile(name, pairs, len(left), len(right), left == right, lanes)
        x, y = (code.element("%scratch", first * COLUMN_STRIDE * lanes) for first in (left[0], right[0]))
        code.do(f"call void @{name}(i64 %blocks, ptr {x}, ptr {y}, ptr {code.element('%sums', place * lanes)})")
        place += len(pairs)
    return [
        *(line for function in functions.values() for line in function),
        "define internal void @sum_up(i64 %blocks, ptr %scratch, ptr %sums) {",
        *code.lines,
        "  ret void",
        "}",
    ]


def _tile(
    name: str, pairs: Sequence[tuple[int, int]], n_left: int, n_right: int, itself: bool, lanes: int
) -> list[str]:
    """Products of these pairs of columns, summed over the stretch and added to the sums; itself: left is right."""
    code = VectorCode(lanes)
    offset = code.let(f"mul i64 %block, {lanes}")

    def columns(array: str, count: int) -> list[str]:
        here = code.let(f"getelementptr double, ptr {array}, i64 {offset}")
        return [code.load(code.vector, here, k * COLUMN_STRIDE * lanes) for k in range(count)]

    left = columns("%left", n_left)
    right = left if itself else columns("%right", n_right)
    sums = [code.call("fma", left[x], right[y], f"%sum{index}") for index, (x, y) in enumerate(pairs)]
    # the lines so far are the body of the loop; those that follow come behind it
    loop, code.lines = code.lines, []
    for index, value in enumerate(sums):
        known = code.load(code.vector, "%sums", index * lanes)
        code.store(f"{code.vector} {code.let(f'fadd {code.vector} {known}, {value}')}", "%sums", index * lanes)
    return [
        f"define internal void @{name}(i64 %blocks, ptr %left, ptr %right, ptr noalias %sums) noinline {{",
        "start:",
        "  br label %loop",
        "loop:",
        # a vector of rows per turn; all sums of the tile stay in registers
        "  %block = phi i64 [ 0, %start ], [ %next, %loop ]",
        *(
            f"  %sum{index} = phi {code.vector} [ zeroinitializer, %start ], [ {value}, %loop ]"
            for index, value in enumerate(sums)
        ),
        *loop,
        "  %next = add i64 %block, 1",
        "  %more = icmp slt i64 %next, %blocks",
        "  br i1 %more, label %loop, label %add",
        "add:",
        *code.lines,
        "  ret void",
        "}",
    ]


def _drive(shared: str, inputs: Sequence[str], lanes: int) -> list[str]:
    """gram: stretch after stretch."""
    passed = ", ".join(inputs)
    return [
        f"define void @gram({shared}, ptr noalias %sums, ptr %guards) {{",
        "entry:",
        "  br label %loop",
        "loop:",
        "  %from = phi i64 [ %first, %entry ], [ %to, %loop ]",
        f"  %reach = add i64 %from, {COLUMN_VECTORS * lanes}",
        "  %beyond = icmp sgt i64 %reach, %last",
        "  %to = select i1 %beyond, i64 %last, i64 %reach",
        # columns evaluates the stretch into scratch, sum_up reads it while it is in the cache
        f"  call void @columns(i64 %from, i64 %to, ptr %scratch, {passed}, ptr %guards)",
        "  %count = sub i64 %to, %from",
        f"  %blocks = sdiv i64 %count, {lanes}",
        "  call void @sum_up(i64 %blocks, ptr %scratch, ptr %sums)",
        "  %more = icmp slt i64 %to, %last",
        "  br i1 %more, label %loop, label %exit",
        "exit:",
        "  ret void",
        "}",
    ]
