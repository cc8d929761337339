"""A program as LLVM code: one vector lane per sample, all constants in place, one loop over the rows.

Rows of the arrays lie one after the other (N, width); the lanes want columns. Columns are read and written two at a
time, so that half of the transposition is done by the load and store units. Rows of wide arrays are put together in
the first-level cache, where constant columns are waiting, and leave it as whole cache lines.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from graphdyn.kernels.expressions import Program, Watch
from graphdyn.kernels.sines import COSINE, HALF_PI, QUARTER_TURNS, ROUND, SINE
from graphdyn.layout import Array

WATCHES: tuple[Watch, ...] = ("finite", "magnitude", "minimum")
"""Order in which the code leaves what it watched: one vector each."""

WIDE = 16
"""Columns from which rows are put together first: below, the lines are not worth the detour."""

_ROUNDED = "contract nsz"
"""A product and a sum may round once together. Nothing else is rearranged: NaN and infinity stay what they are."""


def emit(program: Program, lanes: int, name: str) -> str:
    """Code of name(first, last, bypass, scratch, inputs…, outputs…, watched) for at least as many rows as lanes.

    bypass: whether results are so large that they should not push everything else out of the caches
    scratch: a copy of `scratch`, aligned to a vector
    The last rows are done together with some before them, which are done twice, with the same result.
    """
    return _Emitter(program, lanes).function(name)


def scratch(program: Program, lanes: int) -> Array:
    """Rows of wide arrays, one array after the other, with their constant columns."""
    rows = [
        np.tile([_constant(program, number) or 0.0 for number in numbers], lanes)
        for numbers in program.outputs.values()
        if len(numbers) >= WIDE
    ]
    return np.concatenate([np.empty(0), *rows])


def _constant(program: Program, number: int) -> float | None:
    kind, *arguments = program.operations[number]
    return float(arguments[0]) if kind == "constant" else None


_DELIVER = """define internal void @deliver(ptr noalias %to, ptr noalias %from, i64 %count, i1 %bypass) {{
entry:
  %address = ptrtoint ptr %to to i64
  %offset = and i64 %address, {mask}
  %aligned = icmp eq i64 %offset, 0
  %past = and i1 %aligned, %bypass
  br i1 %past, label %lines, label %plain
plain:
  %i = phi i64 [ 0, %entry ], [ %i.next, %plain ]
  %i.from = getelementptr {vector}, ptr %from, i64 %i
  %i.to = getelementptr {vector}, ptr %to, i64 %i
  %i.value = load {vector}, ptr %i.from, align 8
  store {vector} %i.value, ptr %i.to, align 8
  %i.next = add i64 %i, 1
  %i.more = icmp slt i64 %i.next, %count
  br i1 %i.more, label %plain, label %exit
lines:
  %k = phi i64 [ 0, %entry ], [ %k.next, %lines ]
  %k.from = getelementptr {vector}, ptr %from, i64 %k
  %k.to = getelementptr {vector}, ptr %to, i64 %k
  %k.value = load {vector}, ptr %k.from, align 8
  store {vector} %k.value, ptr %k.to, align {bytes}, !nontemporal !0
  %k.next = add i64 %k, 1
  %k.more = icmp slt i64 %k.next, %count
  br i1 %k.more, label %lines, label %exit
exit:
  ret void
}}
!0 = !{{i32 1}}
"""


class _Emitter:
    def __init__(self, program: Program, lanes: int) -> None:
        self.program = program
        self.lanes = lanes
        self.vector = f"<{lanes} x double>"
        self.integers = f"<{lanes} x i64>"
        self.lines: list[str] = []
        self._count = 0
        self._rows: dict[str, list[str]] = {}
        self._scratch = 0
        self._turns: dict[int, tuple[str, str]] = {}

    def function(self, name: str) -> str:
        arrays = [f"in.{array}" for array in self.program.inputs] + [f"out.{array}" for array in self.program.outputs]
        self._body()
        parameters = ", ".join(
            ["i64 %first", "i64 %last", "i1 %bypass", "ptr noalias %scratch", *(f"ptr noalias %{a}" for a in arrays)]
        )
        watches = [
            f"  %watch.{kind} = phi {self.vector} [ {self.splat(start)}, %entry ], [ %seen.{kind}, %loop ]"
            for kind, start in zip(WATCHES, (0.0, 0.0, float("inf")), strict=True)
        ]
        stores = [
            line
            for place, kind in enumerate(WATCHES)
            for line in (
                f"  %place.{kind} = getelementptr double, ptr %watched, i64 {place * self.lanes}",
                f"  store {self.vector} %seen.{kind}, ptr %place.{kind}, align 8",
            )
        ]
        return "\n".join(
            [
                *(
                    f"declare {self.vector} @llvm.{function}.v{self.lanes}f64({self.vector}{more})"
                    for function, more in (
                        ("fabs", ""),
                        ("maxnum", f", {self.vector}"),
                        ("minnum", f", {self.vector}"),
                    )
                ),
                _DELIVER.format(vector=self.vector, bytes=8 * self.lanes, mask=8 * self.lanes - 1),
                f"define void @{name}({parameters}, ptr %watched) {{",
                "entry:",
                f"  %final = sub i64 %last, {self.lanes}",
                "  br label %loop",
                "loop:",
                "  %row = phi i64 [ %first, %entry ], [ %next, %loop ]",
                *watches,
                *self.lines,
                f"  %after = add i64 %row, {self.lanes}",
                "  %short = icmp sgt i64 %after, %final",
                "  %next = select i1 %short, i64 %final, i64 %after",
                "  %more = icmp slt i64 %after, %last",
                "  br i1 %more, label %loop, label %exit",
                "exit:",
                *stores,
                "  fence seq_cst",
                "  ret void",
                "}",
            ]
        )

    def _body(self) -> None:
        values: list[str] = []
        for kind, *arguments in self.program.operations:
            values.append(self._operation(kind, arguments, values))
        for array, numbers in self.program.outputs.items():
            self._store(array, numbers, values)
        for kind in WATCHES:
            self._watch(kind, [values[k] for k in self.program.watches.get(kind, ())])

    def _operation(self, kind: str, arguments: Sequence, values: Sequence[str]) -> str:
        if kind == "constant":
            return self.splat(arguments[0])
        if kind == "input":
            return self._columns(arguments[0])[arguments[1]]
        if kind == "negate":
            return self.let(f"fneg nsz {self.vector} {values[arguments[0]]}")
        if kind in ("sine", "cosine"):
            if arguments[0] not in self._turns:
                self._turns[arguments[0]] = self._sine_and_cosine(values[arguments[0]])
            return self._turns[arguments[0]][kind == "cosine"]
        return self.arithmetic(
            {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}[kind], *(values[k] for k in arguments)
        )

    def let(self, code: str) -> str:
        self._count += 1
        self.lines.append(f"  %x{self._count} = {code}")
        return f"%x{self._count}"

    def arithmetic(self, instruction: str, x: str, y: str) -> str:
        return self.let(f"{instruction} {_ROUNDED} {self.vector} {x}, {y}")

    def splat(self, value: float) -> str:
        return "<" + ", ".join([f"double {_bits(value)}"] * self.lanes) + ">"

    def splat_integer(self, value: int) -> str:
        return "<" + ", ".join([f"i64 {value}"] * self.lanes) + ">"

    def call(self, function: str, *operands: str) -> str:
        arguments = ", ".join(f"{self.vector} {operand}" for operand in operands)
        return self.let(f"call {self.vector} @llvm.{function}.v{self.lanes}f64({arguments})")

    # Rows and columns

    def _row_address(self, array: str, width: int) -> str:
        return self.let(f"getelementptr double, ptr %{array}, i64 {self.let(f'mul i64 %row, {width}')}")

    def _columns(self, array: str) -> list[str]:
        """All columns of an input array."""
        if array not in self._rows:
            width = self.program.inputs[array]
            block = self._row_address(f"in.{array}", width)
            columns: list[str] = []
            for column in range(0, width - 1, 2):
                columns += self._load_pair(block, width, column)
            if width % 2:
                columns.append(self._load_single(block, width, width - 1))
            self._rows[array] = columns
        return self._rows[array]

    def _load_pair(self, block: str, width: int, column: int) -> list[str]:
        pairs = [self._load("<2 x double>", block, lane * width + column) for lane in range(self.lanes)]
        even, odd = self._joined(pairs[0::2]), self._joined(pairs[1::2])
        return [self._interleaved(even, odd, half) for half in (0, 1)]

    def _load_single(self, block: str, width: int, column: int) -> str:
        vector = "poison"
        for lane in range(self.lanes):
            value = self._load("double", block, lane * width + column)
            vector = self.let(f"insertelement {self.vector} {vector}, double {value}, i64 {lane}")
        return vector

    def _load(self, kind: str, block: str, element: int) -> str:
        address = self.let(f"getelementptr double, ptr {block}, i64 {element}")
        return self.let(f"load {kind}, ptr {address}, align 8")

    def _store(self, array: str, numbers: Sequence[int], values: Sequence[str]) -> None:
        """Two columns at a time, and one that remains."""
        width, wide = len(numbers), len(numbers) >= WIDE
        columns = list(range(width))
        if wide:
            block = self.let(f"getelementptr double, ptr %scratch, i64 {self._scratch}")
            self._scratch += self.lanes * width
            columns = [column for column in columns if _constant(self.program, numbers[column]) is None]
        else:
            block = self._row_address(f"out.{array}", width)
        while columns:
            if len(columns) > 1 and columns[1] == columns[0] + 1:
                together, columns = columns[:2], columns[2:]
                parts = self._pairs(*(values[numbers[column]] for column in together))
            else:
                together, columns = columns[:1], columns[1:]
                parts = self._singles(values[numbers[together[0]]])
            self._write(block, width, together[0], parts)
        if wide:
            to = self._row_address(f"out.{array}", width)
            self.lines.append(f"  call void @deliver(ptr {to}, ptr {block}, i64 {width}, i1 %bypass)")

    def _write(self, block: str, width: int, column: int, parts: Sequence[str]) -> None:
        """Something to each lane's row, from this column on."""
        for lane, part in enumerate(parts):
            address = self.let(f"getelementptr double, ptr {block}, i64 {lane * width + column}")
            self.lines.append(f"  store {part}, ptr {address}, align 8")

    def _pairs(self, x: str, y: str) -> list[str]:
        halves = [self._interleaved(x, y, half) for half in (0, 1)]
        return [
            "<2 x double> "
            + self._shuffle(halves[lane % 2], halves[lane % 2], self.lanes, [lane // 2 * 2, lane // 2 * 2 + 1])
            for lane in range(self.lanes)
        ]

    def _singles(self, x: str) -> list[str]:
        return ["double " + self.let(f"extractelement {self.vector} {x}, i64 {lane}") for lane in range(self.lanes)]

    def _joined(self, parts: list[str]) -> str:
        """Short vectors one after the other."""
        size = 2
        while len(parts) > 1:
            parts = [
                self._shuffle(x, y, size, list(range(2 * size))) for x, y in zip(parts[0::2], parts[1::2], strict=True)
            ]
            size *= 2
        return parts[0]

    def _interleaved(self, x: str, y: str, half: int) -> str:
        """Even (half 0) or odd (half 1) elements of x and y in turn: x_0 y_0 x_2 y_2 …"""
        order = [k for pair in range(half, self.lanes, 2) for k in (pair, self.lanes + pair)]
        return self._shuffle(x, y, self.lanes, order)

    def _shuffle(self, x: str, y: str, size: int, order: list[int]) -> str:
        indices = ", ".join(f"i32 {k}" for k in order)
        return self.let(f"shufflevector <{size} x double> {x}, <{size} x double> {y}, <{len(order)} x i32> <{indices}>")

    # Sine, cosine and what is watched

    def _sine_and_cosine(self, angle: str) -> tuple[str, str]:
        scaled = self.arithmetic("fadd", self.arithmetic("fmul", angle, self.splat(QUARTER_TURNS)), self.splat(ROUND))
        turns = self.let(f"fsub {self.vector} {scaled}, {self.splat(ROUND)}")
        rest = angle
        for part in HALF_PI:
            rest = self.arithmetic("fsub", rest, self.arithmetic("fmul", turns, self.splat(part)))
        square = self.arithmetic("fmul", rest, rest)
        sine = self._polynomial(SINE, square)
        sine = self.arithmetic("fadd", self.arithmetic("fmul", self.arithmetic("fmul", rest, square), sine), rest)
        cosine = self._polynomial(COSINE, square)
        head = self.arithmetic("fsub", self.splat(1.0), self.arithmetic("fmul", square, self.splat(0.5)))
        fourth = self.arithmetic("fmul", square, square)
        cosine = self.arithmetic("fadd", self.arithmetic("fmul", fourth, cosine), head)
        bits = self.let(f"bitcast {self.vector} {scaled} to {self.integers}")
        odd = self.let(f"trunc {self.integers} {bits} to <{self.lanes} x i1>")
        following = self.let(f"add {self.integers} {bits}, {self.splat_integer(1)}")
        select = f"select <{self.lanes} x i1> {odd}, {self.vector}"
        return (
            self._signed(self.let(f"{select} {cosine}, {self.vector} {sine}"), bits),
            self._signed(self.let(f"{select} {sine}, {self.vector} {cosine}"), following),
        )

    def _polynomial(self, coefficients: Sequence[float], x: str) -> str:
        result = self.splat(coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            result = self.arithmetic("fadd", self.arithmetic("fmul", result, x), self.splat(coefficient))
        return result

    def _signed(self, value: str, quadrant: str) -> str:
        """The value, with the other sign in quadrants 2 and 3."""
        shifted = self.let(f"shl {self.integers} {quadrant}, {self.splat_integer(62)}")
        sign = self.let(f"and {self.integers} {shifted}, {self.splat_integer(-(2**63))}")
        bits = self.let(f"bitcast {self.vector} {value} to {self.integers}")
        return self.let(f"bitcast {self.integers} {self.let(f'xor {self.integers} {bits}, {sign}')} to {self.vector}")

    def _watch(self, kind: Watch, values: Sequence[str]) -> None:
        seen = f"%watch.{kind}"
        for value in values:
            if kind == "finite":
                seen = self.let(f"fadd {self.vector} {seen}, {self.let(f'fsub {self.vector} {value}, {value}')}")
            elif kind == "magnitude":
                seen = self.call("maxnum", seen, self.call("fabs", value))
            else:
                seen = self.call("minnum", seen, value)
        self.lines.append(f"  %seen.{kind} = fadd {self.vector} {seen}, {self.splat(-0.0)}")


def _bits(value: float) -> str:
    return "0x" + struct.pack(">d", value).hex().upper()
