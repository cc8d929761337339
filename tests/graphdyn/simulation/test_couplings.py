"""Joints that drive others, in motion: Kᵀ f(K u + o) of the robot without couplings is the reference."""

from dataclasses import replace

import numpy as np
import pytest
from random_trees import NAMED
from robots.moving_robots import G, slider
from scipy.integrate import solve_ivp

import graphdyn
from graphdyn import (
    ComputedTorqueControl,
    Coupling,
    Friction,
    JointLimits,
    JointStops,
    MeasurementNoise,
    PDControl,
    bias_torque,
    mass_matrix,
    rollout,
    simulate,
)
from graphdyn.motion_laws import ConstantAcceleration, FourierSeries, Rail
from graphdyn.simulation import many_robots
from graphdyn.simulation.plant import effort_limits, make_plant

ROUNDING = 1e-12
"""Of compiled steps against Python, relative to the largest number of a column; measured 2e-14."""

NAMES = NAMED["branched"].joint_names
ROBOT = replace(
    NAMED["branched"],
    couplings=(Coupling(NAMES[1], {NAMES[3]: 1.5, NAMES[0]: -0.5}, 0.3), Coupling(NAMES[3], {NAMES[2]: -1.0}, -0.1)),
)
RNG = np.random.default_rng(0)
U, RATE, TORQUE = RNG.normal(size=(3, ROBOT.nv))


def test_the_projected_robot_moves_alike():
    k, free = ROBOT.degrees_of_freedom.matrix, ROBOT.uncoupled

    def acceleration(t, u, rate):
        q, v = ROBOT.joint_positions(u), rate @ k.T
        velocity_terms = (bias_torque(free, q, v)) @ k
        return np.linalg.solve(k.T @ mass_matrix(free, q) @ k, TORQUE - velocity_terms)

    n = ROBOT.nv
    wanted = solve_ivp(
        lambda t, y: [*y[n:], *acceleration(t, y[:n], y[n:])], (0, 0.3), [*U, *RATE], "DOP853", rtol=1e-13, atol=1e-13
    ).y[:, -1]
    adaptive = simulate(ROBOT, U, RATE, 0.3, torque=TORQUE, rtol=1e-13, atol=1e-13)
    fixed = simulate(ROBOT, U, RATE, 0.3, torque=TORQUE, method="rk8", step=4e-3)
    for motion in (adaptive, fixed):
        assert np.abs(np.concatenate([motion.q[-1], motion.v[-1]]) - wanted).max() < 1e-10  # measured 2e-12
        assert motion.energy.drift < 1e-10  # measured 4e-13
        assert motion.closure_error().max() < 1e-14
        assert motion.reactions.coupling_multipliers.shape == (len(motion.time), 2)
    recording = fixed.recording()
    np.testing.assert_allclose(recording.q, ROBOT.joint_positions(fixed.q), atol=1e-15)


CASES = {
    "computed torque": {
        "controls": ComputedTorqueControl(100.0, 20.0, [FourierSeries(0.5, [0.3], [0.1])] * 4, period=4e-3),
        "noise": MeasurementNoise(1e-4, 1e-3),
        "base": Rail((1, 0, 0), ConstantAcceleration(2.0)),
        "duration": 0.02,
    },
    "friction, rotors, parameters": {
        "controls": np.ones((1, 20, 4)),
        "friction": Friction(0.1, [50.0, 0.1, 0.1, 0.1]),
        "rotor_inertia": 0.3,
        "parameters": ROBOT.inertial_parameters * np.linspace(0.9, 1.1, 3)[:, None],
        "external_wrenches": np.ones((6, 6)),
    },
}


CASES["friction of the last joint"] = {
    **CASES["friction, rotors, parameters"],
    "friction": Friction(0.1, [0.1] * 3 + [50]),
}


@pytest.mark.parametrize("case", CASES)
def test_compiled_steps_agree_with_python(case, monkeypatch):
    more = dict(CASES[case])
    held = 3 if case == "friction of the last joint" else 0
    moving = np.arange(4) != held
    arguments = (ROBOT, U * np.linspace(0.9, 1.1, 3)[:, None], RATE * moving, more.pop("controls"))
    here = rollout(*arguments, step=1e-3, **more)
    monkeypatch.setattr(many_robots, "can_compile", lambda plant: False)
    there = rollout(*arguments, step=1e-3, **more)
    assert (here.v[:, :, held] == 0).all() == (case != "computed torque")  # dry friction holds the joint
    for name in ("q", "v", "a", "tau", "passive"):
        size = np.abs(getattr(there, name)).max() or 1.0
        assert np.abs(getattr(here, name) - getattr(there, name)).max() <= ROUNDING * size, name


def lift(**of_driven):
    """A moving base on a horizontal rail that lifts another by half its way; the second has limits and friction."""
    first, second = slider(friction=1.0), slider((0.0, 0.0, 1.0))
    joint = replace(second.joints[0], name="lift", inside=0, **of_driven)
    return replace(
        first,
        bodies=(*first.bodies, replace(second.bodies[0], name="load")),
        joints=(*first.joints, joint),
        couplings=(Coupling("lift", {"rail": 0.5}),),
    )


def test_friction_of_the_file_takes_as_much_power_as_at_its_joint():
    """A joint that moves at -0.5 of the rate of another: d (0.5 v)² and F_c 0.5 |v|."""
    model = replace(lift(damping=8.0, friction=4.0), couplings=(Coupling("lift", {"rail": -0.5}),))
    friction, rate = Friction.of_model(model), 3.0
    assert friction.viscous * rate**2 == pytest.approx([8.0 * (0.5 * rate) ** 2])
    assert friction.coulomb * rate == pytest.approx([1.0 * rate + 4.0 * 0.5 * rate])


def test_friction_efforts_and_stops_of_joints_behind_a_driven_one():
    """The second of three joints is driven: numbers of the third are at its own place."""
    kr500 = graphdyn.kr500()
    limits = [JointLimits(-0.1 * k, 0.1 * k, effort=float(k)) for k in range(1, 7)]
    joints = tuple(replace(j, kind="revolute", limits=x) for j, x in zip(kr500.joints, limits, strict=True))
    model = replace(kr500, joints=joints, couplings=(Coupling("O2", {"O1": 1.0}),))
    assert effort_limits(model).tolist() == [1.0, 3.0, 4.0, 5.0, 6.0]
    stops = make_plant(model, limits=JointStops(1.0)).constants
    assert stops["upper"] == pytest.approx([0.1, 0.3, 0.4, 0.5, 0.6])
    assert stops["lower"] == pytest.approx([-0.1, -0.3, -0.4, -0.5, -0.6])
    found = Friction.identified(model, {"FV_3": 3.0, "FC_6": 4.0, "OFF_1": -1.0, "FV_2": 9.0})
    assert found.viscous.tolist() == [0, 3, 0, 0, 0]
    assert found.coulomb.tolist() == [0, 0, 0, 0, 4]
    assert found.offset.tolist() == [-1, 0, 0, 0, 0]


@pytest.mark.parametrize("settings", [{}, {"method": "rk4", "step": 1e-3}], ids=["dop853", "rk4"])
def test_friction_and_limits_of_driven_joints(settings):
    model = lift(friction=4.0, limits=JointLimits(-1.0, 1.0))
    motion = simulate(model, [0.0], [0.0], 5.0, torque=[20.0], friction="model", limits="stop", **settings)
    acceleration = (20.0 - 0.5 * 2.0 * G - 3.0) / (2.0 + 0.25 * 2.0)
    np.testing.assert_allclose(motion.a[:-1], acceleration, rtol=1e-12)
    assert motion.ended == "upper limit of joint 'lift'"
    assert motion.time[-1] == pytest.approx(np.sqrt(2 * 2.0 / acceleration), rel=1e-9)
    np.testing.assert_allclose(motion.energy.loss[-1], -3.0 * 2.0, rtol=1e-9)
    assert simulate(model, [0.0], [0.0], 1.0, torque=[0.5 * 2.0 * G + 2.9], friction="model", **settings).v[-1] == 0.0
    push = PDControl(100.0, 10.0, [1.0], feedforward=0.5 * 2.0 * G)
    assert simulate(model, [0.0], [0.0], 20.0, torque=push, **settings).q[-1, 0] == pytest.approx(1.0, abs=1e-9)
