"""Lines of LLVM code that compute with vectors, one sample per lane.

Sine and cosine of the same angle come at once, as vector operations without branches.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.compiler.llvm.memory import CACHE_LINE_BYTES
from graphdyn.compiler.llvm.precision import DOUBLE, QUARTER_TURNS_PER_RADIAN, Precision
from graphdyn.scalars.expressions import Guard, Program

GUARD_KINDS: tuple[Guard, ...] = ("finite", "squares", "minimum")
"""Order in which code keeps what its guards find: one vector each."""

GUARD_STARTS = (0.0, 0.0, float("inf"))

PREFETCHED_TURNS = 4
"""Turns of a loop by which memory is asked for before it is read, where other traffic leaves the processor's own
guesses too late. Of long rows, one turn is far enough."""

ALIGNED_STACK = '"frame-pointer"="all"'
"""What lets LLVM align the stack of a function to whole vectors: otherwise most registers that are set aside lie
across two cache lines."""

_ROUNDED = "contract nsz"
"""A product and a sum may round once together. Nothing else is rearranged: NaN and infinity stay what they are."""

_INSTRUCTIONS = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}


class VectorCode:
    """Lines, each of which names its result; prefix keeps the names of several pieces of one function apart."""

    def __init__(self, lanes: int, prefix: str = "x", precision: Precision = DOUBLE) -> None:
        self._prefix = prefix
        self.lanes, self.precision, self.real = lanes, precision, precision.real
        self.vector = f"<{lanes} x {self.real}>"
        self.integers = f"<{lanes} x {precision.integer}>"
        self.lines: list[str] = []
        self._count = 0

    @property
    def declarations(self) -> list[str]:
        """Lines that declare the functions which the code calls."""
        functions, kind = {"fabs": 1, "fma": 3, "rint": 1}, f"v{self.lanes}f{self.precision.bits}"
        return [
            "declare void @llvm.prefetch.p0(ptr, i32, i32, i32)",
            *(
                f"declare {self.vector} @llvm.{name}.{kind}({', '.join([self.vector] * count)})"
                for name, count in functions.items()
            ),
        ]

    def let(self, code: str) -> str:
        self._count += 1
        name = f"%{self._prefix}{self._count}"
        self.lines.append(f"  {name} = {code}")
        return name

    def do(self, code: str) -> None:
        self.lines.append(f"  {code}")

    def arithmetic(self, instruction: str, x: str, y: str) -> str:
        return self.let(f"{instruction} {_ROUNDED} {self.vector} {x}, {y}")

    def call(self, function: str, *operands: str) -> str:
        arguments = ", ".join(f"{self.vector} {operand}" for operand in operands)
        return self.let(f"call {self.vector} @llvm.{function}.v{self.lanes}f{self.precision.bits}({arguments})")

    def splat(self, value: float) -> str:
        # hexadecimal, as LLVM refuses decimal fractions that are not exact: of floats, those of the double they equal
        with np.errstate(over="ignore"):
            bits = struct.pack(">d", self.precision.dtype.type(value)).hex().upper()
        return "<" + ", ".join([f"{self.real} 0x{bits}"] * self.lanes) + ">"

    def splat_integer(self, value: int) -> str:
        return "<" + ", ".join([f"{self.precision.integer} {value}"] * self.lanes) + ">"

    def element(self, array: str, index: int) -> str:
        """Address of an element."""
        return self.let(f"getelementptr {self.real}, ptr {array}, i64 {index}")

    def load(self, kind: str, array: str, index: int) -> str:
        return self.let(f"load {kind}, ptr {self.element(array, index)}, align {self.precision.bytes}")

    def broadcast(self, number: str) -> str:
        """A number in all lanes."""
        # into lane 0 of a vector that is undefined otherwise, then from lane 0 into all
        one = self.let(f"insertelement {self.vector} poison, {self.real} {number}, i64 0")
        return self.let(
            f"shufflevector {self.vector} {one}, {self.vector} poison, <{self.lanes} x i32> zeroinitializer"
        )

    def select(self, relation: str, x: str, y: str, yes: str, no: str) -> str:
        """yes where x relates so to y, else no, also where one is NaN."""
        holds = self.let(f"fcmp {relation} {self.vector} {x}, {y}")
        return self.let(f"select <{self.lanes} x i1> {holds}, {self.vector} {yes}, {self.vector} {no}")

    def any(self, holds: str) -> str:
        """Whether it holds in some lane."""
        bits = self.let(f"bitcast <{self.lanes} x i1> {holds} to i{self.lanes}")  # one bit per lane
        return self.let(f"icmp ne i{self.lanes} {bits}, 0")

    def label(self, name: str) -> None:
        self.lines.append(f"{name}:")

    def store(self, typed_value: str, array: str, index: int) -> None:
        self.do(f"store {typed_value}, ptr {self.element(array, index)}, align {self.precision.bytes}")

    # Programs

    def values(
        self,
        program: Program,
        columns: Callable[[Any], Sequence[str] | Mapping[int, str]],
        computed: Callable[[int, Sequence[str]], None] = lambda number, values: None,
        known_turns: Mapping[int, tuple[str, str]] | None = None,
    ) -> list[str]:
        """The value of every operation; columns gives those of an input array.

        known_turns: sine and cosine of angles, by number
        computed: called with the number of each operation and all values so far: what is stored at once need not be
        kept in registers
        """
        values: list[str] = []
        turns = dict(known_turns or {})
        rows: dict[Any, Sequence[str] | Mapping[int, str]] = {}
        for number, (kind, *arguments) in enumerate(program.operations):
            if kind == "constant":
                values.append(self.splat(arguments[0]))
            elif kind == "input":
                name, column = arguments
                if name not in rows:
                    rows[name] = columns(name)
                values.append(rows[name][column])
            elif kind == "negate":
                values.append(self.let(f"fneg nsz {self.vector} {values[arguments[0]]}"))
            elif kind in _INSTRUCTIONS:
                values.append(self.arithmetic(_INSTRUCTIONS[kind], *(values[k] for k in arguments)))
            else:
                (angle,) = arguments
                # one reduction and two polynomials give both, whichever is asked for first
                if angle not in turns:
                    turns[angle] = self.sine_and_cosine(values[angle])
                values.append(turns[angle][kind == "cosine"])
            computed(number, values)
        return values

    def guard(self, kind: Guard, values: Sequence[str], seen: str) -> str:
        """What was seen before, and in these values: one instruction for each."""
        for value in values:
            if kind == "minimum":  # the comparison with NaN fails
                seen = self.select("olt", value, seen, value, seen)
            else:
                # finite: 0 · x + seen is NaN from the first x on that is not finite; squares: Σ x²
                seen = self.call("fma", value, self.splat(0.0) if kind == "finite" else value, seen)
        return seen

    def sine_and_cosine(self, angle: str) -> tuple[str, str]:
        """See graphdyn.compiler.llvm.precision."""
        kind = self.precision
        # k = angle · 2/π, rounded to the nearest integer
        scaled = self.arithmetic("fmul", angle, self.splat(QUARTER_TURNS_PER_RADIAN))
        scaled = self.arithmetic("fadd", scaled, self.splat(kind.rounding_offset))
        # k itself; no flag lets LLVM take the sum and the difference together
        turns = self.let(f"fsub {self.vector} {scaled}, {self.splat(kind.rounding_offset)}")
        rest = angle
        # r = angle - k π/2 in [-π/4, π/4], part after part
        for part in kind.half_pi:
            if kind.exact_products:
                rest = self.arithmetic("fsub", rest, self.arithmetic("fmul", turns, self.splat(part)))
            else:
                rest = self.call("fma", turns, self.splat(-part), rest)
        square = self.arithmetic("fmul", rest, rest)
        sine = self._polynomial(kind.sine_coefficients, square)
        sine = self.arithmetic("fadd", self.arithmetic("fmul", self.arithmetic("fmul", rest, square), sine), rest)
        cosine = self._polynomial((1.0, -0.5, *kind.cosine_coefficients), square)
        # the last bits of the mantissa of k + rounding_offset are those of k: k mod 4 is the quadrant
        bits = self.let(f"bitcast {self.vector} {scaled} to {self.integers}")
        # in odd quadrants sine and cosine of the rest change places
        odd = self.let(f"trunc {self.integers} {bits} to <{self.lanes} x i1>")
        # cos x = sin(x + π/2): the cosine has the sign of the quadrant after
        following = self.let(f"add {self.integers} {bits}, {self.splat_integer(1)}")
        select = f"select <{self.lanes} x i1> {odd}, {self.vector}"
        return (
            self._signed(self.let(f"{select} {cosine}, {self.vector} {sine}"), bits),
            self._signed(self.let(f"{select} {sine}, {self.vector} {cosine}"), following),
        )

    def _polynomial(self, coefficients: Sequence[float], x: str) -> str:
        # Horner's rule
        result = self.splat(coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            result = self.arithmetic("fadd", self.arithmetic("fmul", result, x), self.splat(coefficient))
        return result

    def _signed(self, value: str, quadrant: str) -> str:
        """The value, with the other sign in quadrants 2 and 3."""
        # bit 1 of the quadrant, moved to the place of the sign, and all others cleared
        shifted = self.let(f"shl {self.integers} {quadrant}, {self.splat_integer(self.precision.bits - 2)}")
        sign = self.let(f"and {self.integers} {shifted}, {self.splat_integer(-(2 ** (self.precision.bits - 1)))}")
        bits = self.let(f"bitcast {self.vector} {value} to {self.integers}")
        return self.let(f"bitcast {self.integers} {self.let(f'xor {self.integers} {bits}, {sign}')} to {self.vector}")

    # Rows and columns: rows of an array lie one after the other, lanes want columns. As many columns as 16 bytes hold
    # are read and written at a time, so that half of the transposition and more is done by the load and store units.

    def rows_of(self, array: str, width: int, row: str = "%row") -> str:
        """Address of the first of the rows of an array: those of this turn of the loop, or from another one on."""
        return self.let(f"getelementptr {self.real}, ptr %{array}, i64 {self.let(f'mul i64 {row}, {width}')}")

    def columns_of(self, block: str, width: int, step: int | None = None) -> list[str]:
        """The columns of as many rows as lanes, which begin at block, one row a step after the other."""
        step = width if step is None else step
        columns: list[str] = []
        for size in self._together(width):
            if size == 1:  # lane by lane
                vector = "poison"
                for lane in range(self.lanes):
                    value = self.load(self.real, block, lane * step + len(columns))
                    vector = self.let(f"insertelement {self.vector} {vector}, {self.real} {value}, i64 {lane}")
                columns.append(vector)
                continue
            # neighboring columns of each row: (x_0 y_0), (x_1 y_1), … of the lanes
            parts = [
                self.load(f"<{size} x {self.real}>", block, lane * step + len(columns)) for lane in range(self.lanes)
            ]
            # of two, even rows x_0 y_0 x_2 y_2 …, odd rows x_1 y_1 x_3 y_3 …; then x_0 x_1 x_2 …, and y_0 y_1 …
            columns += self.transposed([self._joined(parts[first::size], size) for first in range(size)])
        return columns

    def write_columns(self, block: str, width: int, columns: dict[int, str]) -> None:
        """Some columns of as many rows as lanes, which begin at block."""
        pending = sorted(columns)
        while pending:
            column = pending[0]
            run = next((k for k, each in enumerate(pending) if each != column + k), len(pending))
            size = self._together(run)[0]
            del pending[:size]
            if size == 1:
                for lane in range(self.lanes):
                    value = self.let(f"extractelement {self.vector} {columns[column]}, i64 {lane}")
                    self.store(f"{self.real} {value}", block, lane * width + column)
                continue
            # the inverse of columns_of: of two columns rows 0, 2, …, and rows 1, 3, …
            parts = self.transposed([columns[column + k] for k in range(size)])
            for lane in range(self.lanes):
                part, first = parts[lane % size], lane // size * size
                row = self._shuffle(part, part, self.lanes, [*range(first, first + size)])
                self.store(f"<{size} x {self.real}> {row}", block, lane * width + column)

    def _together(self, width: int) -> list[int]:
        """Numbers of columns that are read or written at a time, of so many beside each other."""
        sizes, most = [], min(16 // self.precision.bytes, self.lanes)
        while width:
            while most > width:
                most //= 2
            sizes.append(most)
            width -= most
        return sizes

    def transposed(self, vectors: list[str]) -> list[str]:
        """Columns from as many rows as lanes, or rows from columns; of fewer vectors, the same in blocks of as many."""
        # blocks of 1, 2, 4, … elements change places in pairs of vectors so far apart
        size = 1
        while size < len(vectors):
            for k in range(len(vectors)):
                if not k & size:
                    x, y = vectors[k], vectors[k + size]
                    for half, place in ((0, k), (size, k + size)):
                        order = [
                            first + half + element
                            for pair in range(0, self.lanes, 2 * size)
                            for first in (pair, self.lanes + pair)
                            for element in range(size)
                        ]
                        vectors[place] = self._shuffle(x, y, self.lanes, order)
            size *= 2
        return vectors

    def fetch_ahead(self, block: str, width: int, turns: int = PREFETCHED_TURNS, to_write: bool = False) -> None:
        """Ask for the rows of some turns of the loop later, which may lie beyond the array."""
        # one request for each line of memory; 3: to be kept in all caches, 1: data, not code
        rows = self.lanes * width
        for first in range(0, rows, CACHE_LINE_BYTES // self.precision.bytes):
            address = self.element(block, turns * rows + first)
            self.do(f"call void @llvm.prefetch.p0(ptr {address}, i32 {int(to_write)}, i32 3, i32 1)")

    def _joined(self, parts: list[str], size: int) -> str:
        """Short vectors of this size one after the other."""
        while len(parts) > 1:
            parts = [
                self._shuffle(x, y, size, list(range(2 * size))) for x, y in zip(parts[0::2], parts[1::2], strict=True)
            ]
            size *= 2
        return parts[0]

    def _shuffle(self, x: str, y: str, size: int, order: list[int]) -> str:
        kind, indices = f"<{size} x {self.real}>", ", ".join(f"i32 {k}" for k in order)
        return self.let(f"shufflevector {kind} {x}, {kind} {y}, <{len(order)} x i32> <{indices}>")


@dataclass(frozen=True)
class Carried:
    """Values that are computed one turn of the loop before they are used.

    names: by which the lines of the loop know them; first, following: code for the rows %first and %next, its values
    """

    names: list[str]
    first: tuple[VectorCode, list[str]]
    following: tuple[VectorCode, list[str]]


def loop_over_rows(code: VectorCode, header: str, seen: Sequence[str], carried: Carried | None = None) -> list[str]:
    """A function whose body, the lines of the code, is done for %row from %first on, as many rows at a time as lanes.

    It takes what the guards found from %guards and leaves it there; seen: names of what the body saw, in order of
    GUARD_KINDS, or none if the lines do that themselves.
    """
    before, after = (carried.first[0].lines, carried.following[0].lines) if carried else ([], [])
    entry, phis, stores = [], [], []
    for place, (kind, value) in enumerate(zip(GUARD_KINDS if seen else (), seen, strict=True)):
        # what the guards found is in registers during the loop, loaded before it and stored behind it
        entry += [
            f"  %place.{kind} = getelementptr {code.real}, ptr %guards, i64 {place * code.lanes}",
            f"  %start.{kind} = load {code.vector}, ptr %place.{kind}, align {code.precision.bytes}",
        ]
        phis.append(f"  %guard.{kind} = phi {code.vector} [ %start.{kind}, %entry ], [ {value}, %loop ]")
        stores.append(f"  store {code.vector} {value}, ptr %place.{kind}, align {code.precision.bytes}")
    if carried:
        for name, one, other in zip(carried.names, carried.first[1], carried.following[1], strict=True):
            phis.append(f"  {name} = phi {code.vector} [ {one}, %entry ], [ {other}, %loop ]")
    return [
        f"{header} {ALIGNED_STACK} {{",
        "entry:",
        *entry,
        *before,
        # the last turn begins at %final, as the rows may be no multiple of the lanes: it does some rows again
        f"  %final = sub i64 %last, {code.lanes}",
        "  br label %loop",
        "loop:",
        "  %row = phi i64 [ %first, %entry ], [ %next, %loop ]",
        *phis,
        f"  %after = add i64 %row, {code.lanes}",
        "  %short = icmp sgt i64 %after, %final",
        "  %next = select i1 %short, i64 %final, i64 %after",
        *code.lines,
        *after,
        "  %more = icmp slt i64 %after, %last",
        "  br i1 %more, label %loop, label %exit",
        "exit:",
        *stores,
        # what bypassed the caches is there before the function returns
        "  fence seq_cst",
        "  ret void",
        "}",
    ]
