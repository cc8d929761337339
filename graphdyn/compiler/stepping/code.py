"""LLVM code of a whole simulation: the loop over the steps of a Runge-Kutta method, one robot per lane.

All memory is in columns, one vector per column, so that nothing is transposed inside the loop. The rates at one state
(accelerations under torque, friction and springs at the limits) are one function, which every stage calls: its code
stays in the first-level cache.

Each step: torque (held from tick to tick), which joints stick, the stages, and zero for a velocity that has changed
its sign against dry friction. graphdyn.simulation.integration.steps says the same in Python.
"""

from __future__ import annotations

from collections.abc import Sequence

from graphdyn.compiler.llvm.vector_code import ALIGNED_STACK, VectorCode
from graphdyn.compiler.stepping.closing import closed_state, closing_functions, doubt
from graphdyn.compiler.stepping.layout import BRISTLE_CONSTANTS, HOLDING_SHARE, Columns, StepCode
from graphdyn.layout import Array


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
    if what.bristles:
        passive = [code.arithmetic("fsub", passive[j], memory.load("dry", j)) for j in range(n)]
    if what.stops:
        passive = [code.arithmetic("fadd", passive[j], _stop_force(code, constants, j, q[j], v[j])) for j in range(n)]
    applied = [code.arithmetic("fadd", tau[j], passive[j]) for j in range(n)]

    def columns(name: str) -> Sequence[str]:
        if name == "ground":
            return [
                code.broadcast(code.load("double", "%ground", column))
                for column in range(what.accelerations.inputs[name])
            ]
        # free is 1 or 0 in memory; external wrenches, parameters and rotors are constants of the run
        given = {"q": q, "v": v, "tau": applied}
        if name in given:
            return given[name]
        return (memory if name == "free" else constants).columns(name, what.accelerations.inputs[name])

    values = code.values(what.accelerations, columns)
    a = [values[k] for k in what.accelerations.outputs["a"]]
    if what.closing is not None:
        doubt(code, memory, [values[k] for k in what.accelerations.outputs["certain"]])
    if what.sticking:
        # the torque that bodies and rotor take, which differs from the applied one where a joint is locked
        required = [values[k] for k in what.accelerations.outputs["required"]]
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
    pointers = ", ".join(f"ptr noalias %{name}" for name in ("at", "rates", "memory", "constants"))
    header = f"define internal void @rates({pointers}, ptr %ground) noinline {ALIGNED_STACK} {{"
    return [header, *code.lines, "  ret void", "}"]


def _friction(code: VectorCode, constants: Columns, j: int, v: str, sign: str) -> str:
    """-(F_v v + F_c sign + offset)."""
    viscous = code.arithmetic("fmul", constants.load("viscous", j), v)
    dry = code.arithmetic("fmul", constants.load("coulomb", j), sign)
    together = code.arithmetic("fadd", code.arithmetic("fadd", viscous, dry), constants.load("offset", j))
    return code.let(f"fneg nsz {code.vector} {together}")


def _stop_force(code: VectorCode, constants: Columns, j: int, q: str, v: str) -> str:
    """Stop force of the spring and damper beyond a limit; it pushes, and never pulls."""
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
        pushing = code.select(towards, force, zero, force, zero)
        forces.append(code.select(outside, beyond, zero, pushing, zero))
    return code.arithmetic("fadd", *forces)


def emit_steps(code: StepCode, lanes: int) -> str:
    """The function steps(count, start, done, every, hold, h, state, constants, control, noise, ground, record, memory).

    Steps start + done … start + count - 1 of width h. The torque changes at multiples of hold; control and noise begin
    with the tick in force at start, ground with that step (a row per stage). Multiples of every are recorded, before
    the step. It returns how many steps from start on are done then: with loops, fewer than count where some lanes are
    lost in the last of them (graphdyn.compiler.stepping.closing).
    """
    functions = rates_function(code, lanes)
    if code.closing is not None:
        functions += closing_functions(code, code.closing, lanes)
    return "\n".join([*VectorCode(lanes).declarations, *functions, *_steps_function(code, lanes)])


def _steps_function(what: StepCode, lanes: int) -> list[str]:
    code = VectorCode(lanes, "s")
    vectors = {name: sum(getattr(what, name).values()) for name in ("control", "record")}
    width = code.broadcast("%h")
    # numbers of the tick in force at start, and of the first step at or after start that is recorded
    code.do("%tick.first = udiv i64 %start, %hold")
    code.do("%record.before = add i64 %start, %every")
    code.do("%record.up = sub i64 %record.before, 1")
    code.do("%record.first = udiv i64 %record.up, %every")
    code.do("%end = add i64 %start, %count")
    code.do("%from = add i64 %start, %done")
    code.do("br label %loop")
    code.label("loop")
    code.do("%step = phi i64 [ %from, %entry ], [ %next, %after ]")
    # ticks, records and stages are counted from start: where their blocks begin in memory
    code.do("%step.own = sub i64 %step, %start")
    code.do("%tick.rest = urem i64 %step, %hold")
    code.do("%is.tick = icmp eq i64 %tick.rest, 0")
    code.do("br i1 %is.tick, label %tick, label %decide")
    code.label("tick")
    code.do("%tick.all = udiv i64 %step, %hold")
    code.do("%tick.own = sub i64 %tick.all, %tick.first")
    if what.late:
        code.do("%is.first = icmp eq i64 %step, 0")
    _tick(code, what, vectors["control"])
    code.do("br label %decide")
    code.label("decide")
    if what.closing is not None:
        Columns(code, "%memory", what.memory).store("lost", 0, code.splat(0.0))
    if what.friction:
        _decide(code, what)
    if what.bristles:
        _bristles(code, what, width)
    _call_rates(code, what, 0, "%state")
    # behind the first stage, whose accelerations and passive torques are written too
    code.do("%record.rest = urem i64 %step, %every")
    code.do("%is.recorded = icmp eq i64 %record.rest, 0")
    code.do("br i1 %is.recorded, label %write, label %stages")
    code.label("write")
    code.do("%record.all = udiv i64 %step, %every")
    code.do("%record.own = sub i64 %record.all, %record.first")
    _write(code, what, vectors["record"])
    code.do("br label %stages")
    code.label("stages")
    _stages(code, what, width)
    code.do("br label %after")
    code.label("after")
    # the state after the last step is not recorded here
    code.do("%next = add i64 %step, 1")
    code.do("%more = icmp slt i64 %next, %end")
    if what.closing is None:
        code.do("br i1 %more, label %loop, label %exit")
    else:
        code.do("%go = and i1 %more, %all.closed")
        code.do("br i1 %go, label %loop, label %exit")
    code.label("exit")
    code.do("%reached = sub i64 %next, %start")
    pointers = ("state", "constants", "control", "noise", "ground", "record", "memory")
    arguments = ", ".join([*(f"i64 %{name}" for name in ("count", "start", "done", "every", "hold")), "double %h"])
    header = f"define i64 @steps({arguments}, {', '.join(f'ptr noalias %{name}' for name in pointers)}) {{"
    return [header, "entry:", *code.lines, "  fence seq_cst", "  ret i64 %reached", "}"]


def _block(code: VectorCode, pointer: str, number: str, vectors: int) -> str:
    """Address of the block of this number, of so many vectors."""
    return code.let(f"getelementptr double, ptr {pointer}, i64 {code.let(f'mul i64 {number}, {vectors * code.lanes}')}")


def _tick(code: VectorCode, what: StepCode, vectors: int) -> None:
    """A new torque, from memory or from the law."""
    n = what.n
    memory = Columns(code, "%memory", what.memory)
    constants = Columns(code, "%constants", what.constants)
    control = Columns(code, _block(code, "%control", "%tick.own", vectors), what.control)
    if what.law is None:
        tau = control.columns("tau", n)
    else:
        law, state = what.law, Columns(code, "%state", what.state)
        measured = {name: state.columns(name, n) for name in "qv"}
        if what.noisy:
            # the law sees the state with noise, the dynamics the state itself
            noise = Columns(code, _block(code, "%noise", "%tick.own", 2 * n), {"q": n, "v": n})
            for name, exact in measured.items():
                measured[name] = [code.arithmetic("fadd", x, noise.load(name, j)) for j, x in enumerate(exact)]
        if what.rounded:
            measured["q"] = [_rounded(code, x, constants.load("resolution", j)) for j, x in enumerate(measured["q"])]

        def columns(name: str) -> Sequence[str]:
            if name in measured:
                return measured[name]
            return (control if name == "reference" else constants).columns(name, law.inputs[name])

        values = code.values(law, columns)
        tau = [values[k] for k in law.outputs["tau"]]
    if what.late:
        first = code.broadcast(code.let("uitofp i1 %is.first to double"))
    for j, torque in enumerate(tau):
        if what.clamped:
            most, least = constants.load("largest_torque", j), constants.load("least_torque", j)
            # select, not minimum and maximum: NaN stays NaN
            torque = code.select("ogt", torque, most, most, torque)
            torque = code.select("olt", torque, least, least, torque)
        if what.late:
            # the torque of the last tick acts now; that of the first tick acts at once
            before = code.select("oeq", first, code.splat(1.0), torque, memory.load("ordered", j))
            memory.store("ordered", j, torque)
            torque = before
        memory.store("tau", j, torque)


def _rounded(code: VectorCode, value: str, resolution: str) -> str:
    """The nearest multiple of the resolution; the value itself where that is zero."""
    zero, one = code.splat(0.0), code.splat(1.0)
    unit = code.select("oeq", resolution, zero, one, resolution)
    whole = code.arithmetic("fmul", code.call("rint", code.arithmetic("fdiv", value, unit)), unit)
    return code.select("oeq", resolution, zero, value, whole)


def _bristles(code: VectorCode, what: StepCode, h: str) -> None:
    """The deflection z after the step, and the torque σ₀ z + σ₁ ż, which is held during it.

    An implicit step, stable however stiff: z = (z_before + h v) / (1 + h σ₀ |v| / g), and g as in Bristles.
    """
    memory = Columns(code, "%memory", what.memory)
    constants = Columns(code, "%constants", what.constants)
    state, one = Columns(code, "%state", what.state), code.splat(1.0)
    for j in range(what.n):
        coulomb, breakaway, velocity, stiffness, damping = (constants.load(name, j) for name in BRISTLE_CONSTANTS)
        v, before = state.load("v", j), memory.load("deflection", j)
        share = code.arithmetic("fdiv", v, velocity)
        falling = code.arithmetic("fadd", one, code.arithmetic("fmul", share, share))
        extra = code.arithmetic("fdiv", code.arithmetic("fsub", breakaway, coulomb), falling)
        most = code.arithmetic("fadd", coulomb, extra)
        rate = code.arithmetic("fdiv", code.arithmetic("fmul", stiffness, code.call("fabs", v)), most)
        slipping = code.arithmetic("fadd", one, code.arithmetic("fmul", h, rate))
        moved = code.arithmetic("fadd", before, code.arithmetic("fmul", h, v))
        after = code.arithmetic("fdiv", moved, slipping)
        change = code.arithmetic("fdiv", code.arithmetic("fsub", after, before), h)
        spring, damper = code.arithmetic("fmul", stiffness, after), code.arithmetic("fmul", damping, change)
        memory.store("deflection", j, after)
        memory.store("dry", j, code.arithmetic("fadd", spring, damper))


def _decide(code: VectorCode, what: StepCode) -> None:
    """Which joints slide, and in which direction; a joint at rest sticks unless the torque exceeds its dry friction."""
    n, zero, one = what.n, code.splat(0.0), code.splat(1.0)
    memory = Columns(code, "%memory", what.memory)
    constants = Columns(code, "%constants", what.constants)
    state = Columns(code, "%state", what.state)
    # lanes that are at rest and have dry friction, joint by joint; there friction has no direction yet
    resting = []
    for j in range(n):
        v = state.load("v", j)
        # sign(v): -1, 0 or 1
        sign = code.select("ogt", v, zero, one, code.select("olt", v, zero, code.splat(-1.0), zero))
        memory.store("sign", j, sign)
        if what.sticking:
            still = code.let(f"fcmp oeq {code.vector} {v}, {zero}")
            dry = code.let(f"fcmp ogt {code.vector} {constants.load('coulomb', j)}, {zero}")
            resting.append(code.let(f"and <{code.lanes} x i1> {still}, {dry}"))
            free = code.let(f"select <{code.lanes} x i1> {resting[-1]}, {code.vector} {zero}, {code.vector} {one}")
            memory.store("free", j, free)
    if not what.sticking:
        return
    anywhere = resting[0]
    for joint in resting[1:]:
        anywhere = code.let(f"or <{code.lanes} x i1> {anywhere}, {joint}")
    # where no robot has a joint at rest, the trial below is skipped
    some = code.any(anywhere)
    code.do(f"br i1 {some}, label %resting, label %decided")
    code.label("resting")
    _call_rates(code, what, 0, "%state")
    for j in range(n):
        # a trial with the resting joints locked: held is the torque that keeps them so; beyond F_c they begin to slide
        held, dry = memory.load("held", j), constants.load("coulomb", j)
        size = code.call("fabs", held)
        most = code.arithmetic("fmul", dry, code.splat(HOLDING_SHARE))
        slips = code.let(f"fcmp ogt {code.vector} {size}, {most}")
        begins = code.let(f"and <{code.lanes} x i1> {resting[j]}, {slips}")
        # friction points as held did, so that the joint moves the other way
        away = code.select("ogt", held, zero, code.splat(-1.0), one)
        for name, value in (("sign", away), ("free", one)):
            either = f"select <{code.lanes} x i1> {begins}, {code.vector} {value}, {code.vector}"
            memory.store(name, j, code.let(f"{either} {memory.load(name, j)}"))
    code.do("br label %decided")
    code.label("decided")


def _call_rates(code: VectorCode, what: StepCode, stage: int, at: str) -> None:
    memory = Columns(code, "%memory", what.memory)
    # rates of all stages lie one after the other, each with those of q, v, work and loss
    rates = memory.address("rates", stage * (2 * what.n + 2))
    ground = "%ground"
    if "ground" in what.accelerations.inputs:
        # the base moves: a row of ground for every stage of every step
        first = code.let(f"mul i64 %step.own, {what.stages}")
        row = code.let(f"add i64 {first}, {stage}")
        place = code.let(f"mul i64 {row}, {what.accelerations.inputs['ground']}")
        ground = code.let(f"getelementptr double, ptr %ground, i64 {place}")
    code.do(f"call void @rates(ptr {at}, ptr {rates}, ptr %memory, ptr %constants, ptr {ground})")


def _write(code: VectorCode, what: StepCode, vectors: int) -> None:
    memory = Columns(code, "%memory", what.memory)
    state = Columns(code, "%state", what.state)
    record = Columns(code, _block(code, "%record", "%record.own", vectors), what.record)
    for name, width in what.record.items():
        for j in range(width):
            if name in what.state:
                value = state.load(name, j)
            else:  # the first stage is at the state itself
                value = memory.load("rates", what.n + j) if name == "a" else memory.load(name, j)
            record.store(name, j, value)


def _stages(code: VectorCode, what: StepCode, h: str) -> None:
    """Stages 2 … s and the step; the first stage is done."""
    n, width = what.n, 2 * what.n + 2
    memory = Columns(code, "%memory", what.memory)
    state = Columns(code, "%state", what.state)

    def moved(column: int, weights: Array) -> str:
        """Column of the state, advanced by the step width times the weighted rates."""
        total = None
        for stage, weight in enumerate(weights):
            if weight:
                part = code.arithmetic("fmul", memory.load("rates", stage * width + column), code.splat(float(weight)))
                total = part if total is None else code.arithmetic("fadd", total, part)
        assert total is not None
        return code.arithmetic("fadd", state.load("q", column), code.arithmetic("fmul", h, total))

    # k_s = f(x + h Σ a_st k_t), then x + h Σ b_s k_s; work and loss are integrated with the state, and enter no stage
    for stage in range(1, what.stages):
        for column in range(2 * n):
            memory.store("stage", column, moved(column, what.a[stage, :stage]))
        _call_rates(code, what, stage, memory.address("stage"))
    after = [moved(column, what.b) for column in range(width)]
    if what.friction:
        zero, constants = code.splat(0.0), Columns(code, "%constants", what.constants)
        for j in range(n):
            # a velocity against its sign of sliding has passed zero: the joint stops there, where it has dry friction
            along = code.arithmetic("fmul", after[n + j], memory.load("sign", j))
            turned = code.select("olt", along, zero, zero, after[n + j])
            after[n + j] = code.select("ogt", constants.load("coulomb", j), zero, turned, after[n + j])
    if what.closing is not None:
        after = closed_state(code, what, what.closing, after)
    for column, value in enumerate(after):
        state.store("q", column, value)
