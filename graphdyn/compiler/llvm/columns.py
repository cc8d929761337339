"""Functions with loops that turn rows of an array into columns, one vector each, and columns into rows.

Code for one column after the other would take longer to compile than what is computed for most of them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence, Set

from graphdyn.compiler.llvm.precision import Precision
from graphdyn.compiler.llvm.vector_code import ALIGNED_STACK, GUARD_KINDS, VectorCode
from graphdyn.scalars.expressions import Guard


def rows_to_columns(name: str, width: int, lanes: int, guards: Sequence[Guard], precision: Precision) -> list[str]:
    """name(rows, columns, guards). These guards see every number."""

    def block(code: VectorCode, rows: str, to: str, count: int) -> None:
        if count == lanes:
            columns = code.transposed([code.load(code.vector, rows, lane * width) for lane in range(lanes)])
        else:
            columns = code.columns_of(rows, count, width)
        for k, column in enumerate(columns):
            code.store(f"{code.vector} {column}", to, k * lanes)
        for kind in guards:
            place = GUARD_KINDS.index(kind) * lanes
            seen = code.guard(kind, columns, code.load(code.vector, "%guards", place))
            code.store(f"{code.vector} {seen}", "%guards", place)

    return _in_blocks(name, "ptr %rows, ptr %columns, ptr %guards", width, lanes, precision, block, range(width))


def columns_to_rows(
    name: str, width: int, lanes: int, precision: Precision, changing: Collection[int] | None = None
) -> list[str]:
    """name(rows, columns). changing: columns that the rows do not have yet; None for all"""

    def block(code: VectorCode, rows: str, of: str, count: int) -> None:
        columns = [code.load(code.vector, of, k * lanes) for k in range(count)]
        if count == lanes:
            for lane, row in enumerate(code.transposed(columns)):
                code.store(f"{code.vector} {row}", rows, lane * width)
        else:
            code.write_columns(rows, width, dict(enumerate(columns)))

    wanted = range(width) if changing is None else changing
    return _in_blocks(name, "ptr %rows, ptr %columns", width, lanes, precision, block, wanted)


def _in_blocks(
    name: str,
    arguments: str,
    width: int,
    lanes: int,
    precision: Precision,
    block: Callable[[VectorCode, str, str, int], None],
    wanted: Collection[int],
) -> list[str]:
    """A function that does as many columns at a time as lanes, where any of them is wanted, and those that are left."""
    turn, whole = VectorCode(lanes, precision=precision), VectorCode(lanes, precision=precision)
    left = width % lanes
    rows = turn.let(f"getelementptr {precision.real}, ptr %rows, i64 %column")
    columns = turn.let(f"getelementptr {precision.real}, ptr %columns, i64 {turn.let(f'mul i64 %column, {lanes}')}")
    block(turn, rows, columns, lanes)
    for first, last in _runs({column // lanes for column in wanted if column < width - left}):
        whole.do(f"call void @{name}.blocks({arguments}, i64 {first * lanes}, i64 {last * lanes})")
    if left:
        first = width - left
        block(whole, whole.element("%rows", first), whole.element("%columns", first * lanes), left)
    return [
        f"define internal void @{name}.blocks({arguments.replace('ptr', 'ptr noalias', 2)}, i64 %from, i64 %to) {{",
        *loop_over("column", "%from", "%to", lanes, turn.lines),
        "  ret void",
        "}",
        f"define internal void @{name}({arguments.replace('ptr', 'ptr noalias', 2)}) {ALIGNED_STACK} {{",
        *whole.lines,
        "  ret void",
        "}",
    ]


def _runs(numbers: Set[int]) -> Iterator[tuple[int, int]]:
    """Runs of consecutive numbers: the first of each, and the one behind the last."""
    first = None
    for number in sorted(numbers):
        if first is None:
            first = number
        if number + 1 not in numbers:
            yield first, number + 1
            first = None


def loop_over(
    name: str, first: int | str, last: int | str, step: int, lines: list[str], before: str = "%0"
) -> Iterator[str]:
    """Lines for name = first, first + step, … before last, which may have blocks of their own, and end in one that goes
    on. before: the block that leads here"""
    yield f"  br label %{name}.test"
    yield f"{name}.test:"
    yield f"  %{name} = phi i64 [ {first}, {before} ], [ %{name}.next, %{name}.after ]"
    yield f"  %{name}.more = icmp ne i64 %{name}, {last}"
    yield f"  br i1 %{name}.more, label %{name}.do, label %{name}.done"
    yield f"{name}.do:"
    yield from lines
    yield f"  br label %{name}.after"
    yield f"{name}.after:"
    yield f"  %{name}.next = add i64 %{name}, {step}"
    yield f"  br label %{name}.test"
    yield f"{name}.done:"
