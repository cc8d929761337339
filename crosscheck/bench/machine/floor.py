"""Limits of this machine: multiplications with additions, and bytes to and from memory, per second.

How long a program takes at least follows from its instructions: a product and a sum may be one.
"""

from __future__ import annotations

import ctypes
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from crosscheck.bench.machine.clocks import clock_of, elapsed
from crosscheck.bench.states import JACOBIAN_REFERENCE
from crosscheck.quantities import QUANTITIES
from crosscheck.reference.subject import tip
from graphdyn import RobotModel
from graphdyn.arguments import frame_choice
from graphdyn.compiler import MachineCode, Request, VectorCode, aligned, chosen_backend, host_lanes, in_threads, trace
from graphdyn.recursions import RECURSIONS
from graphdyn.scalars import Program
from graphdyn.verbs import VERBS

REGISTER_PATTERN, CONTRACT_FLAG = r"%[\w.]+", " contract "
"""Names of values in LLVM code; the mark of sums that may take in a product."""


def floating_point_operations(program: Program) -> int:
    """Additions, multiplications and divisions per sample, including the polynomials of sine and cosine."""
    return len(_kinds(_arithmetic(program)[0]))


def fused_instructions(program: Program) -> tuple[int, int]:
    """Additions, multiplications and divisions with each product fused into the sum that is its only use; and those
    among them that multiply or divide."""
    code, values = _arithmetic(program)
    uses = Counter(re.findall(REGISTER_PATTERN, " ".join(line.split("=", 1)[1] for line in code)))
    uses.update(values[k] for numbers in program.outputs.values() for k in numbers)
    kinds, single = _kinds(code), set()
    for line, kind in kinds:
        if kind == "fmul" and uses[line.split()[0]] == 1:
            single.add(line.split()[0])
    sums = [line for line, kind in kinds if kind in ("fadd", "fsub") and CONTRACT_FLAG in line]
    fused = sum(not single.isdisjoint(re.findall(REGISTER_PATTERN, line.split("=", 1)[1])) for line in sums)
    return len(kinds) - fused, sum(kind in ("fmul", "fdiv") for _, kind in kinds)


def _arithmetic(program: Program) -> tuple[list[str], list[str]]:
    """The lines of its code, and the names of its values."""
    code = VectorCode(2)
    values = code.values(program, lambda name: [f"%{name}.{k}" for k in range(program.inputs[name])])
    return code.lines, values


def _kinds(code: Sequence[str]) -> list[tuple[str, str]]:
    """Lines that add, multiply or divide, and what they do."""
    found = [(line, line.split("=", 1)[1].split()[0]) for line in code]
    return [(line, kind) for line, kind in found if kind in ("fadd", "fsub", "fmul", "fdiv")]


N_INDEPENDENT_SUMS = 12
"""Number of independent sums: enough to keep every pipeline of a processor busy, fewer than AVX2 has registers."""

MIXED_SUMS = {8: (12, 12), 4: (7, 7), 2: (7, 7)}
"""Sums of products and plain sums that go on together, by lanes: some processors have pipelines for both."""

STEPS_PER_MEASUREMENT = 1_000_000
"""Additions to each sum in one measurement, which takes some milliseconds."""

STREAM_DOUBLES = 4_000_000
"""Doubles that are copied in one measurement, 32 MB: more than second-level caches hold."""

N_MEASUREMENTS = 5
"""Number of measurements, of which the fastest counts, because a limit is measured."""

_VERBS = {
    "inverse_dynamics": "joint_torques",
    "forward_dynamics": "joint_accelerations",
    **{
        name: name
        for name in (
            "solve_kkt",
            "joint_torque_regressor",
            "inverse_dynamics_derivatives",
            "forward_dynamics_derivatives",
            *(name for name, row in QUANTITIES.items() if row.benchmark),
        )
    },
}
"""The verb that answers what a work computes, and no more."""

REQUESTS = {work: Request(VERBS[verb].recursion, VERBS[verb].outputs) for work, verb in _VERBS.items()}
"""The compiled program of each work."""


@dataclass(frozen=True)
class Machine:
    """Measured limits.

    lanes: doubles in a vector
    threads: at work together
    operations: floating-point operations per second, a multiplication with an addition counted as two [1/s]
    instructions: additions, multiplications, and both fused, times the doubles in a vector, in the best mixture [1/s]
    bandwidth: bytes read or written per second by a copy past the caches [1/s]
    """

    lanes: int
    threads: int
    operations: float
    instructions: float
    bandwidth: float


@dataclass(frozen=True)
class Floor:
    """What a sample of a work takes at least: of what takes longer, operations or bytes.

    operations: floating-point operations of a sample
    instructions: what they take: a product and the sum that is its only use are one
    products: instructions that multiply or divide
    bytes: read and written per sample
    seconds: if nothing ever waited: the longest of all instructions, those that multiply, and the bytes, in loops that
        took turns with the work [s]
    """

    operations: int
    instructions: int
    products: int
    bytes: int
    seconds: float


def machine(threads: int) -> Machine | None:
    """Measure the machine; None where nothing can be compiled."""
    if chosen_backend() != "llvm":
        return None
    loops = [FloorLoops() for _ in range(threads)]
    lanes = host_lanes()
    work = lanes * STEPS_PER_MEASUREMENT * threads
    operations = 2 * N_INDEPENDENT_SUMS * work / _best(lambda k, _: loops[k].multiply(STEPS_PER_MEASUREMENT), threads)
    instructions = max(
        operations / 2, sum(MIXED_SUMS[lanes]) * work / _best(lambda k, _: loops[k].mix(STEPS_PER_MEASUREMENT), threads)
    )
    copied = 2 * 8 * STREAM_DOUBLES * threads / _best(lambda k, _: loops[k].copy(STREAM_DOUBLES), threads)
    return Machine(lanes, threads, operations, instructions, copied)


def floor(model: RobotModel, work: str, on: Machine) -> Floor | None:
    """The floor of one work on this machine as it was measured; None for works without a program of their own."""
    if work not in REQUESTS:
        return None
    request = REQUESTS[work]
    if RECURSIONS[request.recursion].of_frame:
        request = replace(request, frame=frame_choice(model, tip(model), JACOBIAN_REFERENCE))
    program = trace(model, request)
    instructions, products = fused_instructions(program)
    size = 8 * (sum(program.inputs.values()) + sum(map(len, program.outputs.values())))
    seconds = max(_needed(instructions, products, size, on).values())
    return Floor(floating_point_operations(program), instructions, products, size, seconds)


def _needed(instructions: int, products: int, size: int, on: Machine) -> dict[str, float]:
    """Seconds that all instructions, those that multiply, and the bytes take at least, by the loop that takes them."""
    return {
        "mix": instructions / on.instructions,
        "multiply": 2 * products / on.operations,
        "copy": size / on.bandwidth,
    }


def limit(floor: Floor, on: Machine) -> Callable[[int], None]:
    """run(samples) takes the least time of as many samples: a loop of what takes longest on this machine."""
    loops = FloorLoops()
    needed = _needed(floor.instructions, floor.products, floor.bytes, on)
    longest = max(needed, key=lambda name: needed[name])
    if longest == "mix" and on.operations / 2 >= on.instructions:  # one kind of pipeline for all
        return lambda samples: loops.multiply(round(floor.instructions * samples / (N_INDEPENDENT_SUMS * on.lanes)))
    if longest == "mix":
        return lambda samples: loops.mix(round(floor.instructions * samples / (sum(MIXED_SUMS[on.lanes]) * on.lanes)))
    if longest == "multiply":
        return lambda samples: loops.multiply(round(floor.products * samples / (N_INDEPENDENT_SUMS * on.lanes)))
    return lambda samples: loops.copy(round(floor.bytes * samples / (2 * 8)))


class FloorLoops:
    """Loops that never wait, with memory of their own: for one thread."""

    def __init__(self) -> None:
        lanes, pointer = host_lanes(), ctypes.c_void_p
        self._code = _machine_code(lanes)
        prototype = ctypes.CFUNCTYPE(None, ctypes.c_int64, pointer)
        self._add, self._mixed = (self._code.function(name, prototype) for name in ("add", "mixed"))
        self._copy = self._code.function("copy", ctypes.CFUNCTYPE(None, ctypes.c_int64, pointer, pointer))
        self._sums = aligned((sum(MIXED_SUMS[lanes]), lanes))
        self._streams = aligned((STREAM_DOUBLES,)), aligned((STREAM_DOUBLES,))
        for array in self._streams:
            array.fill(1.0)  # memory pages are allocated before the clock starts

    def multiply(self, steps: int) -> None:
        """So many products with sums, times N_INDEPENDENT_SUMS and lanes."""
        self._add(steps, self._sums.ctypes.data)

    def mix(self, steps: int) -> None:
        """So many products with sums and plain sums, times MIXED_SUMS and lanes."""
        self._mixed(steps, self._sums.ctypes.data)

    def copy(self, count: int) -> None:
        """So many doubles, up to STREAM_DOUBLES at a time."""
        source, target = (array.ctypes.data for array in self._streams)
        for first in range(0, count, STREAM_DOUBLES):
            self._copy(min(STREAM_DOUBLES, count - first), source, target)


@cache
def _machine_code(lanes: int) -> MachineCode:
    return MachineCode(_code(lanes))


def _best(work: Callable[[int, int], Any], threads: int) -> float:
    """Seconds of the fastest of several runs."""
    ranges: Sequence[tuple[int, int]] = [(k, k + 1) for k in range(threads)]
    _, *others = (elapsed(lambda: in_threads(work, ranges, threads)) for _ in range(N_MEASUREMENTS + 1))
    return min(run.of_one(clock_of(threads)) for run in others)


def _code(lanes: int) -> str:
    """LLVM code. add(count, sums): x ← x y + z, count times for each sum; mixed: and y ← y + z for others.
    copy(count, from, to): around the caches."""
    vector, size = VectorCode(lanes).vector, 8 * lanes
    return "\n".join(
        [
            *VectorCode(lanes).declarations,
            *_sums("add", N_INDEPENDENT_SUMS, 0, lanes),
            *_sums("mixed", *MIXED_SUMS[lanes], lanes),
            "define void @copy(i64 %count, ptr noalias %from, ptr noalias %to) {",
            "entry:",
            "  br label %loop",
            "loop:",
            "  %i = phi i64 [ 0, %entry ], [ %next, %loop ]",
            "  %source = getelementptr double, ptr %from, i64 %i",
            "  %target = getelementptr double, ptr %to, i64 %i",
            f"  %value = load {vector}, ptr %source, align {size}",
            f"  store {vector} %value, ptr %target, align {size}, !nontemporal !0",
            f"  %next = add i64 %i, {lanes}",
            "  %more = icmp slt i64 %next, %count",
            "  br i1 %more, label %loop, label %exit",
            "exit:",
            "  fence seq_cst",
            "  ret void",
            "}",
            "!0 = !{i32 1}",
        ]
    )


def _sums(name: str, products: int, plain: int, lanes: int) -> list[str]:
    """A loop over so many sums of products and so many plain ones, none of which waits for another."""
    code, phis, results = VectorCode(lanes), [], []
    for k in range(products + plain):
        if k < products:
            new = code.call("fma", f"%sum{k}", code.splat(0.999), code.splat(1e-3))
        else:
            new = code.let(f"fadd {code.vector} %sum{k}, {code.splat(1e-3)}")
        results.append(new)
        phis.append(f"  %sum{k} = phi {code.vector} [ {code.splat(1.0)}, %entry ], [ {new}, %loop ]")
    loop, code.lines = code.lines, []
    for k, new in enumerate(results):
        code.store(f"{code.vector} {new}", "%sums", k * lanes)
    return [
        f"define void @{name}(i64 %count, ptr %sums) {{",
        "entry:",
        "  br label %loop",
        "loop:",
        "  %i = phi i64 [ 0, %entry ], [ %next, %loop ]",
        *phis,
        *loop,
        "  %next = add i64 %i, 1",
        "  %more = icmp slt i64 %next, %count",
        "  br i1 %more, label %loop, label %exit",
        "exit:",
        *code.lines,
        "  ret void",
        "}",
    ]
