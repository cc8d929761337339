"""LLVM code that closes the loops of robots after a step, by the Newton steps of graphdyn.simulation.equations.

Where a lane comes near a singular pose, or its loops do not close, it is lost: its state stays as it was before the
step, and the caller takes this step otherwise. A lane whose q is not a number stays as it is. What a lane does depends
on no other lane.
"""

from __future__ import annotations

from collections.abc import Sequence

from graphdyn.compiler.llvm.vector_code import ALIGNED_STACK, VectorCode
from graphdyn.compiler.stepping.layout import ClosingCode, Columns, StepCode
from graphdyn.scalars.expressions import Program


def doubt(code: VectorCode, memory: Columns, certain: Sequence[str]) -> None:
    """Marks the lanes in which one of these is not above zero as lost."""
    lost, one = memory.load("lost", 0), code.splat(1.0)
    for value in certain:
        # ule holds for NaN too
        lost = code.select("ule", value, code.splat(0.0), one, lost)
    memory.store("lost", 0, lost)


def closing_functions(what: StepCode, closing: ClosingCode, lanes: int) -> list[str]:
    """close_position(at, memory), one Newton step of the lanes that are open, and close_velocity(at, memory)."""
    return [*_position_function(what, closing.position, lanes), *_velocity_function(what, closing.velocity, lanes)]


def _position_function(what: StepCode, program: Program, lanes: int) -> list[str]:
    code, n = VectorCode(lanes), what.n
    at, memory, zero = Columns(code, "%at", what.state), Columns(code, "%memory", what.memory), code.splat(0.0)
    q, still_open = at.columns("q", n), memory.load("open", 0)
    values = code.values(program, lambda name: q)
    for j, number in enumerate(program.outputs["q"]):
        at.store("q", j, code.select("ogt", still_open, zero, values[number], q[j]))
    rest = zero
    for number in program.outputs["closed"]:
        rest = code.select("ogt", values[number], zero, rest, still_open)
    memory.store("open", 0, rest)
    doubt(code, memory, [values[number] for number in program.outputs["certain"]])
    return _function("close_position", code)


def _velocity_function(what: StepCode, program: Program, lanes: int) -> list[str]:
    code, n = VectorCode(lanes), what.n
    at, memory = Columns(code, "%at", what.state), Columns(code, "%memory", what.memory)
    given = {name: at.columns(name, n) for name in "qv"}
    values = code.values(program, lambda name: given[name])
    for j, number in enumerate(program.outputs["v"]):
        at.store("v", j, values[number])
    doubt(code, memory, [values[number] for number in program.outputs["certain"]])
    return _function("close_velocity", code)


def _function(name: str, code: VectorCode) -> list[str]:
    header = f"define internal void @{name}(ptr noalias %at, ptr noalias %memory) noinline {ALIGNED_STACK} {{"
    return [header, *code.lines, "  ret void", "}"]


def closed_state(code: VectorCode, what: StepCode, closing: ClosingCode, after: Sequence[str]) -> list[str]:
    """The state after a step closed, and as before it where the lane is lost; %all.closed says that none is."""
    memory, before = Columns(code, "%memory", what.memory), Columns(code, "%state", what.state)
    at, zero, one = memory.address("stage"), code.splat(0.0), code.splat(1.0)
    stage = Columns(code, at, what.state)
    for column, value in enumerate(after):
        stage.store("q", column, value)
    first = before.load("q", 0)
    memory.store("open", 0, code.select("ord", first, first, one, zero))
    code.do("br label %closing")
    code.label("closing")
    code.do("br label %close")
    code.label("close")
    code.do("%pass = phi i64 [ 0, %closing ], [ %pass.next, %close ]")
    code.do(f"call void @close_position(ptr {at}, ptr %memory)")
    some = code.any(code.let(f"fcmp ogt {code.vector} {memory.load('open', 0)}, {zero}"))
    code.do("%pass.next = add i64 %pass, 1")
    code.do(f"%pass.left = icmp slt i64 %pass.next, {closing.passes}")
    code.do(f"%pass.more = and i1 {some}, %pass.left")
    code.do("br i1 %pass.more, label %close, label %closed")
    code.label("closed")
    code.do(f"call void @close_velocity(ptr {at}, ptr %memory)")
    # what is still open now does not close
    lost = code.select("ogt", memory.load("open", 0), zero, one, memory.load("lost", 0))
    lost = code.select("ord", first, first, lost, zero)
    memory.store("lost", 0, lost)
    some = code.any(code.let(f"fcmp ogt {code.vector} {lost}, {zero}"))
    code.do(f"%all.closed = xor i1 {some}, true")
    return [
        code.select("ogt", lost, zero, before.load("q", column), stage.load("q", column))
        for column in range(len(after))
    ]
