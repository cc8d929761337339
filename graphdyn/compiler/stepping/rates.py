"""LLVM code of the rates at one state: accelerations under torque, friction and springs at the limits."""

from __future__ import annotations

from collections.abc import Sequence

from graphdyn.compiler.llvm.vector_code import ALIGNED_STACK, VectorCode
from graphdyn.compiler.stepping.layout import Columns, StepCode, everywhere, select


def rates_function(what: StepCode, lanes: int) -> list[str]:
    """rates(at, rates, memory, constants, ground): of q, v, work and loss at the q and v there."""
    code, n = VectorCode(lanes), what.n
    memory = Columns(code, "%memory", what.memory)
    constants = Columns(code, "%constants", what.constants)
    at = Columns(code, "%at", {"q": n, "v": n})
    rates = Columns(code, "%rates", what.state)
    zero = code.splat(0.0)
    q, v, tau = at.columns("q", n), at.columns("v", n), memory.columns("tau", n)
    # torques on the joints that no actuator gives
    passive = [zero] * n
    if what.friction:
        signs = memory.columns("sign", n)
        passive = [_friction(code, constants, j, v[j], signs[j]) for j in range(n)]
    if what.stops:
        passive = [code.arithmetic("fadd", passive[j], _stop_force(code, constants, j, q[j], v[j])) for j in range(n)]
    applied = [code.arithmetic("fadd", tau[j], passive[j]) for j in range(n)]

    def columns(name: str) -> Sequence[str]:
        if name == "ground":
            return [everywhere(code, "%ground", column) for column in range(what.accelerations.inputs[name])]
        # free is 1 or 0 in memory; external wrenches, parameters and rotors are constants of the run
        given = {"q": q, "v": v, "tau": applied}
        if name in given:
            return given[name]
        return (memory if name == "free" else constants).columns(name, what.accelerations.inputs[name])

    values = code.values(what.accelerations, columns)
    # required: the torque that bodies and rotor take, which differs from the applied one where a joint is locked
    a, required = ([values[k] for k in what.accelerations.outputs[name]] for name in ("a", "required"))
    if what.sticking:
        for j in range(n):
            # where free is 0, dry friction supplies what is missing: required - applied
            locked = code.arithmetic("fsub", code.splat(1.0), memory.load("free", j))
            held = code.arithmetic("fmul", code.arithmetic("fsub", required[j], applied[j]), locked)
            memory.store("held", j, held)
            passive[j] = code.arithmetic("fadd", passive[j], held)
    for j in range(n):
        rates.store("q", j, v[j])
        rates.store("v", j, a[j])
        memory.store("passive", j, passive[j])
    # dW/dt = Σ τ v of the actuators, and of friction and stops
    for name, torque in (("work", tau), ("loss", passive)):
        power = code.arithmetic("fmul", torque[0], v[0])
        for j in range(1, n):
            power = code.arithmetic("fadd", power, code.arithmetic("fmul", torque[j], v[j]))
        rates.store(name, 0, power)
    arguments = (
        "ptr noalias %at",
        "ptr noalias %rates",
        "ptr noalias %memory",
        "ptr noalias %constants",
        "ptr %ground",
    )
    header = f"define internal void @rates({', '.join(arguments)}) noinline {ALIGNED_STACK} {{"
    return [header, *code.lines, "  ret void", "}"]


def _friction(code: VectorCode, constants: Columns, j: int, v: str, sign: str) -> str:
    """-(F_v v + F_c sign + offset)."""
    viscous = code.arithmetic("fmul", constants.load("viscous", j), v)
    dry = code.arithmetic("fmul", constants.load("coulomb", j), sign)
    together = code.arithmetic("fadd", code.arithmetic("fadd", viscous, dry), constants.load("offset", j))
    return code.let(f"fneg nsz {code.vector} {together}")


def _stop_force(code: VectorCode, constants: Columns, j: int, q: str, v: str) -> str:
    """Of the spring and damper beyond a limit; it pushes, and never pulls."""
    zero = code.splat(0.0)
    stiffness, damping = constants.load("stiffness", j), constants.load("damping", j)
    resisting = code.arithmetic("fmul", damping, v)
    above = code.arithmetic("fsub", q, constants.load("upper", j))
    below = code.arithmetic("fsub", q, constants.load("lower", j))
    forces = []
    # -(k (q - limit) + d v) where q is outside, and only while it points back inside
    for beyond, towards, outside in ((above, "olt", "ogt"), (below, "ogt", "olt")):
        pushed = code.arithmetic("fadd", code.arithmetic("fmul", stiffness, beyond), resisting)
        force = code.let(f"fneg nsz {code.vector} {pushed}")
        pushing = select(code, towards, force, zero, force, zero)
        forces.append(select(code, outside, beyond, zero, pushing, zero))
    return code.arithmetic("fadd", *forces)
