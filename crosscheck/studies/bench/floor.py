"""Limits of this machine: multiplications with additions, and bytes to and from memory, per second."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from crosscheck.referee.subject import tip
from crosscheck.studies.bench.states import REFERENCE
from graphdyn import RobotModel
from graphdyn._frame_choice import frame_choice
from graphdyn.kernels.aligned import aligned
from graphdyn.kernels.expressions import Program
from graphdyn.kernels.native import MachineCode, host_lanes
from graphdyn.kernels.programs import Request, record
from graphdyn.kernels.recursions import RECURSIONS
from graphdyn.kernels.running import chosen_backend, in_threads
from graphdyn.kernels.vector_code import VectorCode

CHAINS = 12
"""Number of independent sums: enough to keep every pipeline of a processor busy, fewer than AVX2 has registers."""

STEPS = 1_000_000
"""Additions to each sum in one measurement, which takes some milliseconds."""

STREAM = 4_000_000
"""Doubles that are copied in one measurement, 32 MB: more than second-level caches hold."""

TRIES = 5
"""Number of measurements, of which the fastest counts, because a limit is measured."""

REQUESTS = {
    "inverse_dynamics": Request("inverse_dynamics", ("tau",)),
    "forward_dynamics": Request("forward_dynamics", ("a",)),
    "everything": Request("forward_dynamics", ("body_accelerations", "multipliers")),
    "regressor": Request("joint_torque_regressor", ("joint_torque_regressor",)),
    **{
        name: Request(name, RECURSIONS[name].outputs)
        for name in (
            "inverse_dynamics_derivatives",
            "forward_dynamics_derivatives",
            "mass_matrix_inverse",
            "coriolis_matrix",
            "kinetic_energy",
            "frame_jacobian",
        )
    },
}
"""The compiled program of each work."""


@dataclass(frozen=True)
class Machine:
    """Measured limits."""

    lanes: int
    """Doubles in a vector."""

    threads: int
    """Threads at work together."""

    operations: float
    """Floating-point operations per second, a multiplication with an addition counted as two [1/s]."""

    bandwidth: float
    """Bytes read or written per second by a copy past the caches [1/s]."""


@dataclass(frozen=True)
class Floor:
    """What a sample of a work takes at least: of what takes longer, operations or bytes."""

    operations: int
    """Floating-point operations of a sample."""

    bytes: int
    """Bytes read and written per sample."""

    seconds: float
    """If every addition came with a multiplication and nothing ever waited [s]."""


def machine(threads: int) -> Machine | None:
    """Measure the machine; None where nothing can be compiled."""
    if chosen_backend() != "llvm":
        return None
    lanes = host_lanes()
    code = MachineCode(_code(lanes))
    add = code.function("add", ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_void_p))
    copy = code.function("copy", ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p))
    sums = [aligned((CHAINS, lanes)) for _ in range(threads)]
    streams = [(aligned((STREAM,)), aligned((STREAM,))) for _ in range(threads)]
    for pair in streams:
        for array in pair:
            array.fill(1.0)  # memory pages are allocated before the clock starts

    def added(first: int, _: int) -> None:
        add(STEPS, sums[first].ctypes.data)

    def copied(first: int, _: int) -> None:
        source, target = streams[first]
        copy(STREAM, source.ctypes.data, target.ctypes.data)

    operations = 2 * CHAINS * lanes * STEPS * threads / _best(added, threads)
    return Machine(lanes, threads, operations, 2 * 8 * STREAM * threads / _best(copied, threads))


def floor(model: RobotModel, work: str, on: Machine) -> Floor | None:
    """The floor of one work on this machine; None for works without a program of their own."""
    if work not in REQUESTS:
        return None
    request = REQUESTS[work]
    if RECURSIONS[request.recursion].of_frame:
        request = replace(request, frame=frame_choice(model, tip(model), REFERENCE))
    program = record(model, request)
    operations = floating_point_operations(program)
    columns = sum(program.inputs.values()) + sum(map(len, program.outputs.values()))
    return Floor(operations, 8 * columns, max(operations / on.operations, 8 * columns / on.bandwidth))


def floating_point_operations(program: Program) -> int:
    """Additions, multiplications and divisions per sample, including the polynomials of sine and cosine."""
    angles = {operands[0] for kind, *operands in program.operations if kind in ("sine", "cosine")}
    code = VectorCode(2)
    code.sine_and_cosine("%angle")
    of_an_angle = sum(any(name in line for name in ("fadd", "fsub", "fmul")) for line in code.lines)
    return sum(kind in "+-*/" for kind, *_ in program.operations) + of_an_angle * len(angles)


def _best(work: Callable[[int, int], Any], threads: int) -> float:
    ranges: Sequence[tuple[int, int]] = [(k, k + 1) for k in range(threads)]
    seconds = []
    for _ in range(TRIES + 1):
        start = time.perf_counter()
        in_threads(work, ranges, threads)
        seconds.append(time.perf_counter() - start)
    return min(seconds[1:])


def _code(lanes: int) -> str:
    """LLVM code. add(count, sums): x ← x y + z, count times for each sum. copy(count, from, to): around the caches."""
    code = VectorCode(lanes)
    phis = []
    for k in range(CHAINS):
        new = code.call("fma", f"%sum{k}", code.splat(0.999), code.splat(1e-3))
        phis.append(f"  %sum{k} = phi {code.vector} [ {code.splat(1.0)}, %entry ], [ {new}, %loop ]")
    loop = code.lines
    code.lines = []
    for k in range(CHAINS):
        new = phis[k].split("[ ")[-1].split(",")[0]
        code.store(f"{code.vector} {new}", "%sums", k * lanes)
    vector, size = code.vector, 8 * lanes
    return "\n".join(
        [
            *code.declarations,
            "define void @add(i64 %count, ptr %sums) {",
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
