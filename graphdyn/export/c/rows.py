"""A program as a function on LANES rows at once, one statement for each operation.

It is a text that a source file includes twice: with one lane, and with as many as vectors of a processor hold. Of the
loops over the lanes compilers make vector instructions. All sines and cosines are taken in one loop of their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from graphdyn.export.c.dialect import Dialect
from graphdyn.scalars.expressions import Program, operands

TRIGONOMETRIC = ("sine", "cosine")


def rows_text(program: Program, dialect: Dialect) -> str:
    """static int ROWS(inputs, outputs), which answers a status: number k of lane l of an array is at k LANES + l."""
    angles = sorted({given[0] for kind, *given in program.operations if kind in TRIGONOMETRIC})
    pivots = program.guards.get("minimum", ())
    statements = _Statements(program, dialect, angles)
    arrays = [*(f"const {dialect.real} *RESTRICT {name}" for name in program.inputs)]
    arrays += [f"{dialect.real} *RESTRICT {name}" for name in program.outputs]
    used = {given[0] for kind, *given in program.operations if kind == "input"}
    size = f"{len(angles)} * LANES"
    lines = [f"static int ROWS({', '.join(arrays)})", "{"]
    lines += [f"    {dialect.real} angle[{size}], sine[{size}], cosine[{size}];"] if angles else []
    lines += [f"    {dialect.real} pivot[LANES];"] if pivots else []
    lines += [f"    int status = {dialect.upper}_OK;"]
    lines += [f"    (void) {name};" for name in program.inputs if name not in used]
    if angles:
        lines += _over_lanes(statements.of_angles())
        lines += [f"    status |= {dialect.name}_turns({size}, angle, sine, cosine);"]
    lines += _over_lanes(statements.of_outputs())
    lines += [f"    status |= {dialect.name}_pivots(LANES, pivot);"] if pivots else []
    return "\n".join([*lines, "    return status;", "}", ""])


def _over_lanes(statements: Iterable[str]) -> list[str]:
    return ["    for (int l = 0; l < LANES; ++l) {", *(f"        {line}" for line in statements), "    }"]


class _Statements:
    """The lines of a program. angles: operations of which sines and cosines are taken."""

    def __init__(self, program: Program, dialect: Dialect, angles: list[int]) -> None:
        self._program, self._dialect, self._angles = program, dialect, angles

    def of_angles(self) -> Iterator[str]:
        """What is done before sines and cosines are known."""
        for number in self._needed_for(self._angles):
            yield from self._statement(number)
        for k, number in enumerate(self._angles):
            yield f"angle[{k} * LANES + l] = {self._value(number)};"

    def of_outputs(self) -> Iterator[str]:
        """All that is done with them: a number is stored as soon as it is known, and needs no register then."""
        places: dict[int, list[str]] = {}
        for name, numbers in self._program.outputs.items():
            for k, number in enumerate(numbers):
                places.setdefault(number, []).append(f"{name}[{k} * LANES + l]")
        pivots = self._program.guards.get("minimum", ())
        for number in self._needed_for([*places, *pivots]):
            yield from self._statement(number)
            for place in places.get(number, []):
                yield f"{place} = {self._value(number)};"
        if pivots:
            yield f"{self._dialect.real} least = {self._value(pivots[0])};"
            for number in pivots[1:]:
                yield f"least = {self._value(number)} < least ? {self._value(number)} : least;"
            yield "pivot[l] = least;"

    def _needed_for(self, numbers: Iterable[int]) -> list[int]:
        """The operations that these need, in their order, but not the angles of sines and cosines."""
        needed, pending = set(), list(numbers)
        while pending:
            number = pending.pop()
            if number not in needed:
                needed.add(number)
                operation = self._program.operations[number]
                pending += operands(operation) if operation[0] not in TRIGONOMETRIC else ()
        return sorted(needed)

    def _statement(self, number: int) -> Iterator[str]:
        kind, *given = self._program.operations[number]
        if kind in ("constant", "input"):
            return
        if kind in TRIGONOMETRIC:
            value = f"{kind}[{self._angles.index(given[0])} * LANES + l]"
        elif kind == "negate":
            value = f"-{self._value(given[0])}"
        else:
            first, second = (self._value(k) for k in given)
            value = f"{first} {kind} {second}"
        yield f"const {self._dialect.real} x{number} = {value};"

    def _value(self, number: int) -> str:
        kind, *given = self._program.operations[number]
        if kind == "constant":
            return self._dialect.literal(given[0])
        return f"{given[0]}[{given[1]} * LANES + l]" if kind == "input" else f"x{number}"
