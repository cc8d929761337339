"""Sums of products of columns as LLVM code: Gram matrices of equations that never exist as rows.

A stretch of samples is evaluated into the second-level cache, column after column; then tiles of the Gram matrices are
summed over the stretch in registers. One vector per sum: each lane has seen its own samples.
"""

from __future__ import annotations

from collections.abc import Sequence

from graphdyn.kernels.expressions import COLUMNS, Program
from graphdyn.kernels.vector_code import WATCHES, VectorCode, loop_over_rows

STRETCH = 16
"""Vectors of a column before they are summed: 130 columns of a six-axis arm take 130 kB."""


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
    """Code of gram(first, last, scratch, inputs…, sums, watched) for a number of rows that is a multiple of the lanes.

    scratch: STRETCH vectors for each column; sums: one vector for each of products, to which is added
    """
    width = len(program.outputs[COLUMNS])
    assert sum(groups) == width
    code = VectorCode(lanes)
    values = code.values(
        program, lambda name: code.columns_of(_rows(code, name, program.inputs[name]), program.inputs[name])
    )
    block = code.let("sub i64 %row, %first")
    block = code.let(f"getelementptr double, ptr %scratch, i64 {code.let(f'mul i64 {block}, {width}')}")
    for column, number in enumerate(program.outputs[COLUMNS]):
        code.store(f"{code.vector} {values[number]}", block, column * lanes)
    seen = [code.watch(kind, [values[k] for k in program.watches.get(kind, ())], f"%watch.{kind}") for kind in WATCHES]
    inputs = [f"ptr noalias %in.{name}" for name in program.inputs]
    pieces = _sum_up(groups, width, lanes)
    shared = ", ".join(["i64 %first", "i64 %last", "ptr noalias %scratch", *inputs])
    return "\n".join(
        [
            *code.declarations,
            *loop_over_rows(code, f"define internal void @columns({shared}, ptr %watched)", seen),
            *(line for piece in pieces for line in piece),
            *_drive(shared, [argument.replace("noalias ", "") for argument in inputs], lanes, len(pieces)),
        ]
    )


def _rows(code: VectorCode, array: str, width: int) -> str:
    return code.let(f"getelementptr double, ptr %in.{array}, i64 {code.let(f'mul i64 %row, {width}')}")


PIECE = 50
"""Tiles in one function: the time to compile a function grows faster than its length."""


def _sum_up(groups: Sequence[int], width: int, lanes: int) -> list[list[str]]:
    """Functions sum_up0, sum_up1, … (blocks, scratch, sums): a loop over the stretch for each tile."""
    everything, place = tiles(groups, lanes), 0
    functions: list[list[str]] = []
    for start in range(0, len(everything), PIECE):
        lines = [
            f"define internal void @sum_up{len(functions)}(i64 %blocks, ptr noalias %scratch, ptr noalias %sums) {{"
        ]
        lines.append("start:")
        before = "start"
        for number, (left, right) in enumerate(everything[start : start + PIECE]):
            pairs = [(x, y) for x in left for y in right if x <= y]
            lines += _tile(number, pairs, place, before, width, lanes)
            before, place = f"add{number}", place + len(pairs)
        functions.append([*lines, "  ret void", "}"])
    return functions


def _tile(number: int, pairs: Sequence[tuple[int, int]], place: int, before: str, width: int, lanes: int) -> list[str]:
    """Products of these pairs of columns, summed over the stretch and added to the sums from `place` on."""
    code = VectorCode(lanes, f"t{number}.")
    code.do(f"%b{number}.next = add i64 %b{number}, 1")
    block = code.let(f"getelementptr double, ptr %scratch, i64 {code.let(f'mul i64 %b{number}, {width * lanes}')}")
    column = {k: code.load(code.vector, block, k * lanes) for k in sorted({k for pair in pairs for k in pair})}
    sums = [code.call("fma", column[x], column[y], f"%s{number}.{index}") for index, (x, y) in enumerate(pairs)]
    phis = [
        f"  %s{number}.{index} = phi {code.vector} [ zeroinitializer, %{before} ], [ {value}, %tile{number} ]"
        for index, value in enumerate(sums)
    ]
    lines = [
        f"  br label %tile{number}",
        f"tile{number}:",
        f"  %b{number} = phi i64 [ 0, %{before} ], [ %b{number}.next, %tile{number} ]",
        *phis,
        *code.lines,
        f"  %more{number} = icmp slt i64 %b{number}.next, %blocks",
        f"  br i1 %more{number}, label %tile{number}, label %add{number}",
        f"add{number}:",
    ]
    code.lines = []
    for index, value in enumerate(sums):
        known = code.load(code.vector, "%sums", (place + index) * lanes)
        total = code.let(f"fadd {code.vector} {known}, {value}")
        code.store(f"{code.vector} {total}", "%sums", (place + index) * lanes)
    return lines + code.lines


def _drive(shared: str, inputs: Sequence[str], lanes: int, n_pieces: int) -> list[str]:
    """gram: stretch after stretch."""
    passed = ", ".join(inputs)
    return [
        f"define void @gram({shared}, ptr noalias %sums, ptr %watched) {{",
        "entry:",
        "  br label %loop",
        "loop:",
        "  %from = phi i64 [ %first, %entry ], [ %to, %loop ]",
        f"  %reach = add i64 %from, {STRETCH * lanes}",
        "  %beyond = icmp sgt i64 %reach, %last",
        "  %to = select i1 %beyond, i64 %last, i64 %reach",
        f"  call void @columns(i64 %from, i64 %to, ptr %scratch, {passed}, ptr %watched)",
        "  %count = sub i64 %to, %from",
        f"  %blocks = sdiv i64 %count, {lanes}",
        *(f"  call void @sum_up{k}(i64 %blocks, ptr %scratch, ptr %sums)" for k in range(n_pieces)),
        "  %more = icmp slt i64 %to, %last",
        "  br i1 %more, label %loop, label %exit",
        "exit:",
        "  ret void",
        "}",
    ]
