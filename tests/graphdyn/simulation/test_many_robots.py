"""Many robots at once: compiled steps against the same steps in Python, and what makes runs differ."""

from dataclasses import replace

import numpy as np
import pytest
from long_check import few
from random_trees import NAMED, random_state, random_wrenches
from robots.moving_robots import slider

import graphdyn
from graphdyn import (
    Bristles,
    ComputedTorqueControl,
    Coupling,
    Friction,
    InvalidInput,
    Joint,
    JointLimits,
    JointStops,
    MeasurementNoise,
    PDControl,
    kr500,
    rollout,
    simulate,
)
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.simulated import Inputs, record_accelerations
from graphdyn.compiler.stepping import code as stepping_code
from graphdyn.model.spatial import apply
from graphdyn.motion_laws import ConstantAcceleration, FourierSeries, Rail, Turntable
from graphdyn.simulation import many_robots
from graphdyn.simulation.integration import compiled, fixed

ROUNDING = 1e-12
"""Of compiled steps against Python, relative to the largest number of a column; measured 5e-14 (computed torque)."""

COLUMNS = ("q", "v", "a", "tau", "passive")

WITH_LIMITS = replace(
    kr500(),
    joints=tuple(
        Joint(j.name, "revolute", j.inside, j.placement, j.axis, JointLimits(-0.5, 0.52)) for j in kr500().joints
    ),
)

RNG = np.random.default_rng(5)
FRICTION = Friction(100.0, np.array([5000.0, 3000.0, 200.0, 20.0, 20.0, 3.0]), 1.0)
WAVES = [FourierSeries(0.5, [1.0], [0.5])] * 6
TRACKING = ComputedTorqueControl(100.0, 20.0, WAVES, period=4e-3)
HOLDING = PDControl(1e4, np.array([[1e3] * 6, [2e3] * 6, [3e3] * 6]), np.zeros(6), feedforward=10.0)

CASES = {
    "free swing": {},
    "torques": {"controls": RNG.normal(size=(3, 10, 6)) * 1e3, "period": 2e-3},
    "PD": {"controls": HOLDING, "friction": FRICTION},
    "computed torque": {"controls": TRACKING, "torque_limits": 2e4},
    "noise": {"controls": TRACKING, "noise": MeasurementNoise(1e-4, 1e-2), "seed": 3},
    "encoder": {"controls": TRACKING, "noise": MeasurementNoise(0.0, 0.0, [1e-3, 0, 1e-3, 0, 1e-2, 1e-3])},
    "late": {"controls": replace(TRACKING, period=2e-3), "late": True},
    "parameters": {"parameters": kr500().inertial_parameters * RNG.uniform(0.9, 1.1, size=(3, 60))},
    "rotors": {"rotor_inertia": np.linspace(1, 10, 18).reshape(3, 6), "friction": FRICTION},
    "stops": {"model": WITH_LIMITS, "limits": JointStops(1e6, 1e4)},
    "wrenches": {"external_wrenches": random_wrenches(kr500(), 1, (3,)) * 100},
    "base": {"base": [Rail((1, 0, 0), ConstantAcceleration(2.0)), Turntable((0, 0, 1), FourierSeries(1, [1], [1]))]},
}


def arguments(case, **more):
    given = {"model": kr500(), "step": 1e-3, **CASES[case], **more}
    if "period" not in given:
        given["duration"] = 0.02
    return given


def run(case, **more):
    q = np.array([0.2, 0.5, -0.3, 0.4, 0.49, -0.2]) * np.array([[1.0], [0.9], [1.05]])
    v = np.array([[0.5, -0.4, 0.0, 0.6, 0.0, 1.0]])
    given = arguments(case, **more)
    return rollout(given.pop("model"), q, np.repeat(v, 3, axis=0), given.pop("controls", None), **given)


@pytest.mark.parametrize("case", CASES)
def test_compiled_steps_agree_with_python(case, monkeypatch):
    here = run(case)
    monkeypatch.setattr(many_robots, "can_compile", lambda plant: False)
    there = run(case)
    for name in COLUMNS:
        size = np.abs(getattr(there, name)).max() or 1.0
        assert np.abs(getattr(here, name) - getattr(there, name)).max() <= ROUNDING * size, name


@pytest.mark.parametrize("method", ["euler", "rk8"])
def test_other_methods_agree_with_python(method, monkeypatch):
    here = run("PD", method=method)
    monkeypatch.setattr(many_robots, "can_compile", lambda plant: False)
    there = run("PD", method=method)
    assert np.abs(here.q - there.q).max() <= ROUNDING


@pytest.mark.parametrize("name", few([*NAMED], "mixed_chain", "branched"))
def test_trees_agree_with_python(name):
    model = NAMED[name]
    q, v, tau = random_state(model, 4)
    settings = {"torque": tau, "method": "rk4", "step": 1e-3, "friction": Friction(0.1, 1.0), "rotor_inertia": 0.3}
    here = simulate(model, q, v, 0.02, **settings)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fixed, "can_compile", lambda plant: False)
        there = simulate(model, q, v, 0.02, **settings)
    for column in COLUMNS:
        size = np.abs(getattr(there, column)).max()
        assert np.abs(getattr(here, column) - getattr(there, column)).max() <= ROUNDING * size
    assert here.energy.work[-1] == pytest.approx(there.energy.work[-1], rel=1e-9)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_do_not_matter(threads):
    model, rng = kr500(), np.random.default_rng(1)
    q, v = rng.normal(size=(2, 30, 6))
    settings = {"step": 1e-3, "duration": 0.01, "noise": MeasurementNoise(1e-4, 1e-3), "every": 10}
    one = rollout(model, q, v, TRACKING, threads=1, **settings)
    many = rollout(model, q, v, TRACKING, threads=threads, **settings)
    alone = rollout(model, q[:1], v[:1], TRACKING, **settings)
    for name in COLUMNS:
        assert np.array_equal(getattr(one, name), getattr(many, name))
        assert np.array_equal(getattr(alone, name)[0], getattr(one, name)[0])


def test_noise_depends_on_seed_and_run():
    settings = {"step": 1e-3, "duration": 0.01, "noise": MeasurementNoise(1e-4, 1e-3)}
    q = np.zeros((2, 6))
    first, again = (rollout(kr500(), q, q, TRACKING, **settings) for _ in range(2))
    other = rollout(kr500(), q, q, TRACKING, seed=1, **settings)
    assert np.array_equal(first.tau, again.tau)
    assert not np.array_equal(first.tau, other.tau)
    assert not np.array_equal(first.tau[0], first.tau[1])


def test_runs_of_several_blocks():
    """Each run has its own torques, in their order, and its own noise: m v = Σ τ h."""
    torques = np.random.default_rng(4).normal(size=(30, 5, 1))
    motion = rollout(slider(mass=2.0), [0.0], [0.0], torques, step=0.1)
    assert motion.v[:, -1, 0] == pytest.approx(torques.sum(axis=(1, 2)) * 0.1 / 2.0)
    assert motion.tau[:, :, 0] == pytest.approx(torques[:, [0, 1, 2, 3, 4, 4], 0])
    velocities = np.cumsum(np.concatenate([np.zeros((30, 1)), torques[:, :, 0] * 0.05], axis=1), axis=1)
    assert motion.q[:, -1, 0] == pytest.approx((velocities[:, :-1] + velocities[:, 1:]).sum(axis=1) * 0.05)
    held = PDControl(1.0, 1.0, [0.0])
    noisy = rollout(slider(), np.zeros((30, 1)), [0.0], held, step=0.1, duration=0.1, noise=MeasurementNoise(1.0, 1.0))
    assert len(np.unique(noisy.tau[:, 0])) == 30


def test_noise_is_as_large_as_stated():
    """Of each joint, of positions by K_p and of velocities by K_d alone."""
    noise, zeros = MeasurementNoise([1e-3] * 5 + [5e-3], [0.02] * 5 + [0.1]), np.zeros((300, 6))
    for gains, sizes in (((10.0, 0.0), [1e-2] * 5 + [5e-2]), ((0.0, 10.0), [0.2] * 5 + [1.0])):
        law = PDControl(*gains, np.zeros(6))
        motion = rollout(kr500(), zeros, zeros, law, step=1e-3, duration=1e-3, noise=noise)
        assert motion.tau[:, 0].std(axis=0) == pytest.approx(sizes, rel=0.2)


def test_what_is_compiled_depends_on_all_there_is():
    """One robot under one thing after the other moves as a robot that has seen nothing else."""
    law, limits = PDControl(20.0, 1.0, [0.6]), JointLimits(-0.2, 0.2, effort=1.0)
    used = slider(limits=limits)
    cases = [
        {},
        {"friction": Friction(1.0, 0.3)},
        {"limits": JointStops(100.0, 1.0)},
        {"torque_limits": "model"},
        {"noise": MeasurementNoise(0.1, 0.1)},
        {"noise": MeasurementNoise(resolution=0.1)},
        {"late": True},
        {"bristles": Bristles(1.0, 1.5, 0.1, 100.0)},
        {"rotor_inertia": 2.0},
        {"external_wrenches": [[1.0, 0, 0, 0, 0, 0]]},
        {"method": "euler"},
        {"controls": ComputedTorqueControl(20.0, 1.0, [0.6])},
        {"controls": ComputedTorqueControl(20.0, 1.0, [0.6], nominal=slider(mass=5.0))},
    ]
    ends = []
    for case in cases:
        more = {"controls": law, **case}
        controls = more.pop("controls")
        for model in (used, slider(limits=limits)):
            ends.append(rollout(model, [0.3], [1.0], controls, step=0.05, duration=0.5, **more).q[0, -1, 0])
    assert ends[::2] == ends[1::2]
    assert len(set(ends)) == len(cases)


def test_rollout_is_simulate():
    """The same numbers, bit for bit, as one robot alone."""
    model, q, v = kr500(), np.full(6, 0.1), np.zeros(6)
    many = rollout(model, q, v, TRACKING, step=1e-3, duration=0.05)
    one = simulate(model, q, v, 0.05, torque=TRACKING, method="rk4", step=1e-3)
    for name in COLUMNS:
        assert np.array_equal(getattr(many, name)[0], getattr(one, name))


def test_other_parameters_need_no_compiling(monkeypatch):
    model, rng = kr500(), np.random.default_rng(2)
    settings = {"step": 1e-3, "duration": 0.01}
    rollout(model, np.zeros(6), np.zeros(6), parameters=model.inertial_parameters, **settings)

    def refuse(*_):
        raise AssertionError("compiled again")

    monkeypatch.setattr(compiled, "CompiledSteps", refuse)
    parameters = model.inertial_parameters * rng.uniform(0.9, 1.1, 60)
    here = rollout(model, np.zeros(6), np.zeros(6), parameters=parameters, **settings)
    monkeypatch.undo()
    there = rollout(model.with_inertial_parameters(parameters), np.zeros(6), np.zeros(6), **settings)
    assert np.abs(here.q - there.q).max() < ROUNDING


def test_what_overflows_stays_in_its_run():
    model, torques = kr500(), np.zeros((3, 20, 6))
    torques[1] = 1e300
    motion = rollout(model, np.zeros(6), np.zeros(6), torques, step=1e-3)
    clean = rollout(model, np.zeros(6), np.zeros(6), torques[:1], step=1e-3)
    assert not np.isfinite(motion.q[1, -1]).all()
    assert np.array_equal(motion.q[[0, 2], -1], np.broadcast_to(clean.q[0, -1], (2, 6)))


def test_numpy_back_end(monkeypatch):
    monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")
    slow = rollout(slider(), [[0.0], [1.0]], [0.0], np.ones((5, 1)), step=0.1)
    monkeypatch.setenv("GRAPHDYN_BACKEND", "llvm")
    quick = rollout(slider(), [[0.0], [1.0]], [0.0], np.ones((5, 1)), step=0.1)
    assert np.abs(slow.q - quick.q).max() < 1e-15
    assert slow.q[:, -1, 0] == pytest.approx([0.0625, 1.0625])


def test_every_row():
    all_rows = rollout(slider(), [0.0], [1.0], step=0.1, duration=1.0)
    some = rollout(slider(), [0.0], [1.0], step=0.1, duration=1.0, every=3)
    assert some.time == pytest.approx([0.0, 0.3, 0.6, 0.9])
    assert np.array_equal(some.q, all_rows.q[:, ::3])


def test_the_code_has_one_vector_for_every_column():
    """No transposition inside the loop: the code loads and stores whole vectors, and scalars of the base alone."""
    steps = compiled.compiled_steps(many_robots.make_plant(slider()), "rk4", None, lanes=4)
    text = stepping_code.emit_steps(steps.what, 4)
    assert "load <4 x double>" in text
    assert "load double" not in text


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"method": "dop853", "duration": 1.0}, "method is 'dop853'; use one of rk8, rk4, euler"),
        ({"step": 0.0, "duration": 1.0}, "step is 0.0; give seconds above zero"),
        ({"every": 0, "duration": 1.0}, "every is 0; give a number of steps from 1 on"),
        ({}, "duration is None; give seconds above zero"),
        ({"duration": 0.25}, "the duration, 0.25 s, is no multiple of the step, 0.1 s; choose a step that divides it"),
        ({"controls": np.zeros(1), "duration": 1.0}, "controls has shape (1,), expected (T, 1) or (R, T, 1)"),
        ({"controls": np.zeros((5, 1)), "duration": 1.0}, "the torques say how long it lasts"),
        ({"controls": np.zeros((2, 5, 1))}, "numbers of runs differ: q and v 3, controls 2"),
        (
            {"controls": PDControl(1.0, [[1.0]] * 2, [0.0]), "duration": 1.0},
            "numbers of runs differ: q and v 3, the gains 2",
        ),
        (
            {"controls": PDControl(1.0, 1.0, [0.0]), "duration": 1.0, "period": 1.0},
            "a controller has a period of its own",
        ),
        (
            {"controls": PDControl(1.0, 1.0, [0.0], period=-1.0), "duration": 1.0},
            "period is -1.0; give seconds above zero",
        ),
        (
            {"controls": PDControl(1.0, 1.0, [0.0], period=0.15), "duration": 1.0},
            "the period of the controller, 0.15 s",
        ),
        ({"controls": PDControl(1.0, np.inf, [0.0]), "duration": 1.0}, "velocity_gain contains NaN or infinity"),
        (
            {"controls": PDControl(1.0, 1.0, [0.0, 1.0]), "duration": 1.0},
            "target has shape (2,), expected (1,) for robot",
        ),
        (
            {"controls": PDControl(1.0, 1.0, WAVES), "duration": 1.0},
            "6 laws for the target of 1 joints; give one motion law",
        ),
        (
            {"controls": ComputedTorqueControl(1.0, 1.0, [0.0], nominal=kr500()), "duration": 1.0},
            "the nominal robot of the controller has 6 joints, 'slider' 1",
        ),
        ({"parameters": np.ones(9), "duration": 1.0}, "parameters has shape (9,), expected (10,) or (3, 10)"),
        ({"threads": 0, "duration": 1.0}, "threads is 0; give a number from 1, or None for all cores"),
    ],
)
def test_refused(more, message):
    given = {"step": 0.1, **more}
    with pytest.raises(InvalidInput) as caught:
        rollout(slider(), np.zeros((3, 1)), np.zeros(1), given.pop("controls", None), **given)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("period", [None, 0.02, 0.05])
def test_torques_last_for_all_of_their_periods(period):
    """2 kg under 2 N, then -4 N, then 6 N: the velocity is the sum of what each has given."""
    held = period or 0.01
    found = rollout(slider(mass=2.0), [0.0], [0.0], [[2.0], [-4.0], [6.0]], step=0.01, period=period)
    assert found.time == pytest.approx(np.arange(round(3 * held / 0.01) + 1) * 0.01)
    wanted = [np.interp(t, held * np.arange(4), held * np.array([0.0, 1.0, -1.0, 2.0])) for t in found.time]
    assert found.v[0, :, 0] == pytest.approx(wanted, abs=1e-14)


@pytest.mark.parametrize("couplings", [(), (Coupling("joint4", {"joint1": -0.5}),)], ids=["free", "coupled"])
def test_what_moves_and_holds_each_joint(couplings):
    """(M + R) a + h, which is τ where a joint is free, and holds it at a = 0 where it is not."""
    model = replace(NAMED["mixed_chain"], couplings=couplings)
    n, rng = model.nv, np.random.default_rng(0)
    q, v, tau, rotor = rng.normal(size=(4, 3, n))
    free = np.array([[1.0] * n, [1.0, 0.0, 1.0, 0.0][:n], [0.0] * n])
    rotor, v = np.abs(rotor), v * free
    columns = {"q": q, "v": v, "tau": tau, "rotor": rotor, "free": free}
    found = {"a": np.empty((3, n)), "required": np.empty((3, n))}
    program = record_accelerations(model, Inputs(rotor=True, free=True))
    Interpreter(program).bind(columns, found)(0, 3)
    mass = graphdyn.mass_matrix(model, q, method="projected") + rotor[:, None] * np.eye(n)
    needed = apply(mass, found["a"]) + graphdyn.bias_torque(model, q, v, method="projected")
    assert found["required"] == pytest.approx(needed, rel=1e-11, abs=1e-10)
    assert found["required"][free == 1] == pytest.approx(tau[free == 1], rel=1e-11, abs=1e-10)
    assert not found["a"][free == 0].any()


def test_bristles():
    """A mass drawn through standstill: the same steps of z and v, written out; it is held below the breakaway."""
    bristles, h, pulls = Bristles(2.0, 3.0, 0.05, 1e3, 40.0), 1e-3, np.repeat([1.0, 4.0, -4.0], 300)
    found = rollout(slider(), [0.0], [0.0], pulls[:, None], step=h, method="euler", bristles=bristles)
    q, v, z, course = 0.0, 0.0, 0.0, []
    for pull in pulls:
        g = 2.0 + 1.0 / (1 + (v / 0.05) ** 2)
        after = (z + h * v) / (1 + h * 1e3 * abs(v) / g)
        dry = 1e3 * after + 40.0 * (after - z) / h
        course.append((q, v, -dry))
        q, v, z = q + h * v, v + h * (pull - dry) / 2.0, after
    for name, column in zip(("q", "v", "passive"), np.array(course).T, strict=True):
        assert getattr(found, name)[0, :-1, 0] == pytest.approx(column, abs=1e-12)
    assert abs(found.v[0, 299, 0]) < 1e-2
    assert found.v[0, 599, 0] > 0.1


@pytest.mark.parametrize("change", [{"coulomb": 0.0}, {"velocity": 0.0}, {"stiffness": 0.0}, {"damping": -1.0}])
def test_refused_bristles(change):
    said = "negative" if "damping" in change else "zero; give numbers above zero"
    with pytest.raises(InvalidInput, match=f"{next(iter(change))} of the bristles is {said}"):
        Bristles(**{"coulomb": 1.0, "breakaway": 2.0, "velocity": 0.1, "stiffness": 100.0} | change)


def test_bristles_need_compiled_steps(monkeypatch):
    monkeypatch.setattr(many_robots, "can_compile", lambda plant: False)
    with pytest.raises(InvalidInput, match="bristles need compiled steps of a tree, which robot 'slider' has not here"):
        rollout(slider(), [0.0], [0.0], step=0.1, duration=0.1, bristles=Bristles(1.0, 1.0, 0.1, 1.0))
