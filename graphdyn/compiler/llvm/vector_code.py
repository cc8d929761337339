"""Sine and cosine for the compiled back end, of the same angle at once, as vector operations without branches.

Reduction to [-π/4, π/4] by Cody and Waite with π/2 in three parts of 33 bits, whose products with the number of quarter
turns are exact up to MAX_ANGLE; minimax polynomials of FreeBSD's msun (k_sin.c, k_cos.c; Sun Microsystems, 1993).
Measured against fifty digits: within 1.4 units in the last place up to 100 rad, 2.3 up to MAX_ANGLE, neighbors of the
multiples of π/2 included.

Lines of LLVM code that compute with vectors, one sample per lane.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from graphdyn.compiler.llvm.memory import CACHE_LINE_BYTES
from graphdyn.scalars.expressions import Guard, Program

MAX_ANGLE = 1e6
"""Largest |angle| [rad] that is reduced without loss: 2/π of it stays below 2^20 = 53 - 33 bits."""

QUARTER_TURNS_PER_RADIAN = 0.6366197723675814  # 2 / π
HALF_PI = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
ROUNDING_OFFSET = 6755399441055744.0
"""1.5 · 2^52: adding it leaves the nearest integer in the last bits of the sum."""

SINE_COEFFICIENTS = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE_COEFFICIENTS = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)


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

    def __init__(self, lanes: int, prefix: str = "x") -> None:
        self._prefix = prefix
        self.lanes = lanes
        self.vector = f"<{lanes} x double>"
        self.integers = f"<{lanes} x i64>"
        self.lines: list[str] = []
        self._count = 0

    @property
    def declarations(self) -> list[str]:
        """Lines that declare the functions which the code calls."""
        functions = {"fabs": 1, "fma": 3}
        return [
            "declare void @llvm.prefetch.p0(ptr, i32, i32, i32)",
            *(
                f"declare {self.vector} @llvm.{name}.v{self.lanes}f64({', '.join([self.vector] * count)})"
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
        return self.let(f"call {self.vector} @llvm.{function}.v{self.lanes}f64({arguments})")

    def splat(self, value: float) -> str:
        # hexadecimal, as LLVM refuses decimal fractions that are not exact
        bits = struct.pack(">d", value).hex().upper()
        return "<" + ", ".join([f"double 0x{bits}"] * self.lanes) + ">"

    def splat_integer(self, value: int) -> str:
        return "<" + ", ".join([f"i64 {value}"] * self.lanes) + ">"

    def element(self, array: str, index: int) -> str:
        """Address of an element."""
        return self.let(f"getelementptr double, ptr {array}, i64 {index}")

    def load(self, kind: str, array: str, index: int) -> str:
        return self.let(f"load {kind}, ptr {self.element(array, index)}, align 8")

    def broadcast(self, number: str) -> str:
        """A number in all lanes."""
        # into lane 0 of a vector that is undefined otherwise, then from lane 0 into all
        one = self.let(f"insertelement {self.vector} poison, double {number}, i64 0")
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
        self.do(f"store {typed_value}, ptr {self.element(array, index)}, align 8")

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
        """See graphdyn.compiler.llvm.vector_code."""
        # k = angle · 2/π, rounded to the nearest integer: with 1.5 · 2^52 added, the sum has no bits for a fraction
        scaled = self.arithmetic(
            "fadd", self.arithmetic("fmul", angle, self.splat(QUARTER_TURNS_PER_RADIAN)), self.splat(ROUNDING_OFFSET)
        )
        # k itself; no flag lets LLVM take the sum and the difference together
        turns = self.let(f"fsub {self.vector} {scaled}, {self.splat(ROUNDING_OFFSET)}")
        rest = angle
        # angle - k π/2, part after part; each product is exact, as k has 20 bits and a part 33
        for part in HALF_PI:
            rest = self.arithmetic("fsub", rest, self.arithmetic("fmul", turns, self.splat(part)))
        # r in [-π/4, π/4]: sin r = r + r r² (s_1 + s_2 r² + …), cos r = 1 - r²/2 + r⁴ (c_1 + c_2 r² + …)
        square = self.arithmetic("fmul", rest, rest)
        sine = self._polynomial(SINE_COEFFICIENTS, square)
        sine = self.arithmetic("fadd", self.arithmetic("fmul", self.arithmetic("fmul", rest, square), sine), rest)
        cosine = self._polynomial((1.0, -0.5, *COSINE_COEFFICIENTS), square)
        # the last bits of the mantissa of k + 1.5 · 2^52 are those of k: k mod 4 is the quadrant
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
        shifted = self.let(f"shl {self.integers} {quadrant}, {self.splat_integer(62)}")
        sign = self.let(f"and {self.integers} {shifted}, {self.splat_integer(-(2**63))}")
        bits = self.let(f"bitcast {self.vector} {value} to {self.integers}")
        return self.let(f"bitcast {self.integers} {self.let(f'xor {self.integers} {bits}, {sign}')} to {self.vector}")

    # Rows and columns: rows of an array lie one after the other, lanes want columns. Columns are read and written two
    # at a time, so that half of the transposition is done by the load and store units.

    def rows_of(self, array: str, width: int, row: str = "%row") -> str:
        """Address of the first of the rows of an array: those of this turn of the loop, or from another one on."""
        return self.let(f"getelementptr double, ptr %{array}, i64 {self.let(f'mul i64 {row}, {width}')}")

    def columns_of(self, block: str, width: int, step: int | None = None) -> list[str]:
        """The columns of as many rows as lanes, which begin at block, one row a step after the other."""
        step = width if step is None else step
        columns: list[str] = []
        for column in range(0, width - 1, 2):
            # two neighboring columns of each row: (x_0 y_0), (x_1 y_1), … of the lanes
            pairs = [self.load("<2 x double>", block, lane * step + column) for lane in range(self.lanes)]
            # even rows x_0 y_0 x_2 y_2 …, odd rows x_1 y_1 x_3 y_3 …; interleaved: x_0 x_1 x_2 …, and y_0 y_1 …
            even, odd = self._joined(pairs[0::2]), self._joined(pairs[1::2])
            columns += [self._interleaved(even, odd, half) for half in (0, 1)]
        if width % 2:
            # the last of an odd number of columns, lane by lane
            vector = "poison"
            for lane in range(self.lanes):
                value = self.load("double", block, lane * step + width - 1)
                vector = self.let(f"insertelement {self.vector} {vector}, double {value}, i64 {lane}")
            columns.append(vector)
        return columns

    def write_columns(self, block: str, width: int, columns: dict[int, str]) -> None:
        """Some columns of as many rows as lanes, which begin at block."""
        pending = sorted(columns)
        while pending:
            column = pending.pop(0)
            if pending and pending[0] == column + 1:
                # the inverse of columns_of: rows 0, 2, … of the pair of columns, and rows 1, 3, …
                halves = [
                    self._interleaved(columns[column], columns[pending.pop(0)], 0),
                    self._interleaved(columns[column], columns[column + 1], 1),
                ]
                for lane in range(self.lanes):
                    pair = self._shuffle(
                        halves[lane % 2], halves[lane % 2], self.lanes, [lane // 2 * 2, lane // 2 * 2 + 1]
                    )
                    self.store(f"<2 x double> {pair}", block, lane * width + column)
            else:
                for lane in range(self.lanes):
                    value = self.let(f"extractelement {self.vector} {columns[column]}, i64 {lane}")
                    self.store(f"double {value}", block, lane * width + column)

    def transposed(self, vectors: list[str]) -> list[str]:
        """Columns from as many rows as lanes, or rows from columns."""
        # blocks of 1, 2, 4, … elements change places in pairs of vectors so far apart
        size = 1
        while size < self.lanes:
            for k in range(self.lanes):
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
        for first in range(0, rows, CACHE_LINE_BYTES // 8):
            address = self.element(block, turns * rows + first)
            self.do(f"call void @llvm.prefetch.p0(ptr {address}, i32 {int(to_write)}, i32 3, i32 1)")

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
            f"  %place.{kind} = getelementptr double, ptr %guards, i64 {place * code.lanes}",
            f"  %start.{kind} = load {code.vector}, ptr %place.{kind}, align 8",
        ]
        phis.append(f"  %guard.{kind} = phi {code.vector} [ %start.{kind}, %entry ], [ {value}, %loop ]")
        stores.append(f"  store {code.vector} {value}, ptr %place.{kind}, align 8")
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
