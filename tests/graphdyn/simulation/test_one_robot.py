"""Arguments of simulate, its rows, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from random_trees import random_tree
from robots.mechanisms import four_bar
from robots.moving_robots import pendulum, slider
from shown.approved import approve_result

from graphdyn import (
    ComputedTorqueControl,
    Coupling,
    Event,
    Friction,
    GraphDynError,
    IntegrationFailed,
    InvalidInput,
    JointLimits,
    JointStops,
    PDControl,
    SingularMassMatrix,
    kr500,
    simulate,
)
from graphdyn.motion_laws import Polynomial, Rail
from graphdyn.simulation.integration import fixed
from graphdyn.simulation.torques import Torques, torques

FIXED = {"method": "rk4", "step": 0.1}


def test_rows_of_fixed_steps():
    motion = simulate(slider(), [0.0], [1.0], 1.0, **FIXED)
    assert motion.time == pytest.approx(np.arange(11) * 0.1)
    assert motion.q[:, 0] == pytest.approx(motion.time)
    some = simulate(slider(), [0.0], [1.0], 1.0, at=[0.2, 0.6, 1.0], **FIXED)
    assert some.time == pytest.approx([0.2, 0.6, 1.0])
    assert some.q[:, 0] == pytest.approx([0.2, 0.6, 1.0])


def test_rows_after_many_steps():
    """Asked for at every third step, which no chunk of steps begins with but the first."""
    at = np.append(np.arange(3.0, 9000.0, 999.0), 9000.0)
    motion = simulate(slider(), [0.0], [1.0], 9000.0, at=at, method="rk4", step=1.0)
    assert np.array_equal(motion.time, at)
    assert motion.q[:, 0] == pytest.approx(at, rel=1e-9)


@pytest.mark.parametrize("kind", ["none", "function", "held"])
@pytest.mark.parametrize("model", [pendulum(), four_bar()], ids=["tree", "loop"])
def test_rows_do_not_depend_on_chunks_of_steps(model, kind, monkeypatch):
    """Those of all steps, of which every third is asked for."""
    held = np.outer(np.arange(4.0), np.ones(model.nv))
    torque = {"none": None, "function": lambda t, q, v: np.cos(t) * np.ones(model.nv), "held": held}[kind]
    q, v = model.random_state(np.random.default_rng(0))
    given = {"torque": torque, "method": "euler", "step": 2.0**-10}
    whole = simulate(model, q, v, 60 / 1024, **given)
    for name in ("CHUNK_STEPS", "LOOP_CHUNK_STEPS"):
        monkeypatch.setattr(fixed, name, 8)
    some = simulate(model, q, v, 60 / 1024, at=whole.time[::3], **given)
    for name in ("time", "q", "v", "a", "tau", "passive"):
        assert np.array_equal(getattr(some, name), getattr(whole, name)[::3]), name


@pytest.mark.parametrize("settings", [{}, {"method": "rk4", "step": 0.125}], ids=["dop853", "rk4"])
@pytest.mark.parametrize("end", [0.5, 0.625, 0.3, 0.0625])
def test_rows_up_to_an_event(end, settings):
    """Its own is the last, and stands there once, also where it was asked for."""
    event, at = Event(lambda t, q, v: t - end), [0.0, 0.25, 0.5, 0.75, 1.0]
    motion = simulate(slider(), [0.0], [1.0], 1.0, at=at, events=event, **settings)
    assert motion.time == pytest.approx([*(time for time in at if time < end), end], abs=1e-12)
    assert np.all(np.diff(motion.time) > 1e-6)
    assert motion.q[:, 0] == pytest.approx(motion.time, abs=1e-12)


def test_rows_of_adaptive_steps():
    motion = simulate(pendulum(), [0.3], [0.0], 1.0)
    assert motion.time[0] == 0.0
    assert motion.time[-1] == 1.0
    assert np.all(np.diff(motion.time) > 0)
    assert motion.ended == ""


@pytest.mark.parametrize("settings", [{}, FIXED], ids=["dop853", "rk4"])
def test_torques_that_are_held(settings):
    """1 N for half of the time, then -1 N: a mass at rest again, moved by F t² / 4 m."""
    motion = simulate(slider(mass=2.0), [0.0], [0.0], 1.0, torque=[[1.0], [-1.0]], **settings)
    assert motion.v[-1, 0] == pytest.approx(0.0, abs=1e-12)
    assert motion.q[-1, 0] == pytest.approx(0.125, rel=1e-9)
    assert motion.tau[0, 0] == 1.0


def test_a_torque_holds_from_its_own_instant_on():
    """However the time of the instant is rounded."""
    for count in range(1, 60):
        values = np.arange(float(count))[:, None]
        held = Torques(slider(), 0.7, values=values)
        for row in range(count):
            assert held.tau_from(row * (0.7 / count), np.zeros(1), np.zeros(1)) == row


@pytest.mark.parametrize("torque", [[[1.0], [-1.0]], lambda t, q, v: np.ones(1) * t], ids=["held", "function"])
def test_the_row_of_an_event_has_the_torque_of_its_instant(torque):
    """Half a step before the torque that is held changes its sign; τ = t has been integrated to t³ / 12."""
    held = isinstance(torque, list)
    there = 0.45**2 / 4 if held else 0.45**3 / 12
    event = Event(lambda t, q, v: q[0] - there, "there")
    motion = simulate(slider(mass=2.0), [0.0], [0.0], 1.0, torque=torque, events=[event], **FIXED)
    assert motion.time[-1] == pytest.approx(0.45, abs=1e-9)
    assert motion.tau[-1, 0] == pytest.approx(1.0 if held else 0.45, abs=1e-8)
    assert motion.a[-1, 0] == pytest.approx(motion.tau[-1, 0] / 2)


def test_the_row_of_an_event_after_a_new_torque():
    """A mass of 2 kg has x = 1/16 m and v = 1/4 m/s when 1 N becomes -1 N; half a step later it brakes."""
    event = Event(lambda t, q, v: q[0] - (1 / 16 + 0.25 * 0.05 - 0.05**2 / 4), "there")
    motion = simulate(slider(mass=2.0), [0.0], [0.0], 1.0, torque=[[1.0], [-1.0]], events=[event], **FIXED)
    assert motion.time[-1] == pytest.approx(0.55, abs=1e-9)
    assert (motion.tau[-1, 0], motion.a[-1, 0], motion.v[-1, 0]) == pytest.approx((-1.0, -0.5, 0.225))


@pytest.mark.parametrize("settings", [{}, FIXED], ids=["dop853", "rk4"])
def test_a_sampled_controller_holds_its_torque(settings):
    """Discrete PD on a double integrator, by hand; its target moves, and is that of the sample."""
    mass, k, d, period = 2.0, 3.0, 4.0, 0.2
    motion = simulate(
        slider(mass=mass),
        [1.0],
        [0.0],
        1.0,
        torque=PDControl(k, d, [Polynomial((0.0, 0.5))], period=period),
        at=[0.2, 0.6, 1.0],
        **settings,
    )
    x, v, states = 1.0, 0.0, []
    for sample in range(5):
        a = (k * (0.5 * sample * period - x) + d * (0.5 - v)) / mass
        x, v = x + v * period + a * period**2 / 2, v + a * period
        states.append(x)
    assert motion.q[:, 0] == pytest.approx([states[0], states[2], states[4]], rel=1e-9)


HELD = [[3.0], [1.0], [-2.0]]


def after_thirds(duration, mass=2.0):
    """Where a mass at rest is after three torques of a third of the duration each."""
    x, v, third = 0.0, 0.0, duration / 3
    for ((force),) in HELD:
        x, v = x + v * third + force / mass * third**2 / 2, v + force / mass * third
    return x


@pytest.mark.parametrize(
    "more",
    [{"step": 1e-3}, {"step": 1e-2, "external_wrenches": lambda t, q, v: np.zeros((1, 6))}],
    ids=["compiled", "python"],
)
def test_torques_held_over_many_steps(more):
    """Several chunks of compiled steps, each of which begins with a torque of its own; the last torque stays."""
    motion = simulate(slider(mass=2.0), [0.0], [0.0], 9.0, torque=HELD, method="euler", at=[3.0, 9.0], **more)
    assert motion.q[-1, 0] == pytest.approx(after_thirds(9.0), rel=more["step"])
    assert motion.v[0, 0] == pytest.approx(4.5, rel=1e-9)
    assert motion.tau[:, 0].tolist() == [1.0, -2.0]


def test_a_base_that_moves_for_many_steps():
    """x₀ = t³ of the rail, against a force of inertia -6 m t on the slide along it."""
    rail = Rail((1.0, 0.0, 0.0), Polynomial((0.0, 0.0, 0.0, 1e-2)))
    motion = simulate(slider(), [0.0], [0.0], 6.0, base=rail, method="rk4", step=1e-3, at=[5.0, 6.0])
    assert motion.q[:, 0] == pytest.approx(-1e-2 * motion.time**3, rel=1e-12)
    assert motion.bodies.position[:, 0, 0] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("settings", [{}, {"method": "rk4", "step": 1e-3}], ids=["dop853", "rk4"])
def test_what_a_controller_believes(settings):
    """Of a mass twice as large: ẍ = 2 (k (x_d - x) - d ẋ), one robot after the other."""
    model, k, d = slider(mass=2.0), 9.0, 0.0
    for share in (2.0, 1.0, 0.5):
        control = ComputedTorqueControl(k, d, [0.0], nominal=slider(mass=2.0 * share))
        motion = simulate(model, [1.0], [0.0], 0.5, torque=control, **settings)
        assert motion.q[-1, 0] == pytest.approx(np.cos(np.sqrt(k * share) * 0.5), abs=5e-3 if settings else 1e-9)


def test_gains_targets_and_feedforward():
    """Laws as targets, and each gain at its own place: a moving target is followed behind by d v / k."""
    target = [Polynomial((0.5, 2.0))]
    control = PDControl(100.0, 30.0, target, feedforward=5.0)
    motion = simulate(slider(), [0.5], [2.0], 3.0, torque=control, at=[0.0, 3.0])
    assert motion.tau[0, 0] == pytest.approx(5.0)
    assert motion.q[-1, 0] == pytest.approx(0.5 + 2.0 * 3.0 + 5.0 / 100.0, abs=1e-6)
    damped = simulate(slider(), [0.0], [1.0], 1e-3, torque=PDControl(100.0, 30.0, [0.2], feedforward=5.0), at=[0.0])
    assert damped.tau[0, 0] == pytest.approx(100.0 * 0.2 - 30.0 + 5.0)


def test_reactions_and_recordings_of_loads_and_friction():
    """A wrench across the rail is what the joint bears; a recording has the torque of the actuator."""
    wrench = [[0.0, 7.0, 0.0, 0.0, 0.0, 0.0]]
    motion = simulate(slider(), [0.0], [1.0], 0.1, torque=[5.0], friction=Friction(2.0), external_wrenches=wrench)
    assert motion.reactions.joint_wrenches[:, 0, 1] == pytest.approx(-7.0)
    assert motion.reactions.tau[0, 0] == pytest.approx(5.0 - 2.0)
    assert np.array_equal(motion.recording().tau, motion.tau)


def test_progress_is_told():
    for settings in ({}, FIXED, {**FIXED, "coordinates": "maximal"}):
        told = []
        simulate(slider(), [0.0], [1.0], 1.0, progress=told.append, **settings)
        assert told
        assert told[-1] == pytest.approx(1.0)


def test_progress_within_a_long_stretch():
    told = []
    simulate(pendulum(), [1.0], [0.0], 20.0, progress=told.append)
    assert len(told) > 3
    assert told == sorted(told)


def test_massless_bodies():
    massless = slider(mass=0.0)
    with pytest.raises(SingularMassMatrix, match="joint 'rail' moves without inertia"):
        simulate(massless, [0.0], [0.0], 1.0)
    assert simulate(massless, [0.0], [0.0], 1.0, torque=[2.0], rotor_inertia=4.0).q[-1, 0] == pytest.approx(0.25)


def test_refused_couplings():
    coupled = replace(kr500(), couplings=(Coupling("O3", {"O2": 1.0, "O4": 2.0}),))
    with pytest.raises(InvalidInput, match=r"maximal coordinates do not know the couplings of robot 'kr500'"):
        simulate(coupled, np.zeros(5), np.zeros(5), 1.0, method="rk4", step=0.1, coordinates="maximal")
    control = ComputedTorqueControl(1.0, 1.0, np.zeros(6), nominal=coupled)
    with pytest.raises(InvalidInput, match="the nominal robot of the controller has 5 joints, 'kr500' 6"):
        simulate(kr500(), np.zeros(6), np.zeros(6), 1.0, torque=control)
    joints = tuple(replace(joint, friction=float(joint.name == "O3")) for joint in coupled.joints)
    with pytest.raises(InvalidInput, match=r"joint 'O3' has friction, and several joints drive it: .*Friction\(…\)"):
        Friction.of_model(replace(coupled, joints=joints))


def test_no_energy_balance_where_work_is_not_integrated():
    motion = simulate(slider(), [0.0], [0.0], 1.0, external_wrenches=np.ones((1, 6)))
    with pytest.raises(InvalidInput, match="work of a moving base and of external wrenches is not integrated"):
        _ = motion.energy


def test_numbers_that_overflow():
    with pytest.raises(IntegrationFailed, match=r"the integration failed at .* s .* too stiff or too large"):
        simulate(pendulum(), [0.1], [0.0], 100.0, torque=lambda t, q, v: v**2 * 1e3 + 1e3)
    source = torques(lambda t, q, v: q, pendulum(), 1.0)
    with pytest.raises(IntegrationFailed, match=r"at 0\.5 s the numbers are no longer finite; take smaller steps"):
        source.tau_at(0.5, np.array([np.inf]), np.zeros(1))


@pytest.mark.parametrize("name", ["q", "v"])
@pytest.mark.parametrize("number", [np.inf, np.nan])
def test_the_first_row_that_is_not_finite_is_told(name, number):
    times, rows = np.array([0.5, 0.75, 1.0]), {each: np.zeros((3, 2)) for each in "qv"}
    fixed._refuse_infinite(times, rows)
    rows[name][1:, 1] = number
    with pytest.raises(IntegrationFailed, match=r"at 0\.75 s the numbers are no longer finite; take smaller steps"):
        fixed._refuse_infinite(times, rows)


@pytest.mark.parametrize("settings", [{}, FIXED], ids=["dop853", "rk4"])
def test_external_wrenches_of_time(settings):
    """2 kg under 6 t newtons: x = t³ / 2."""

    def pulled(t, q, v):
        return [[6 * t, 0, 0, 0, 0, 0]]

    motion = simulate(slider(mass=2.0), [0.0], [0.0], 1.0, external_wrenches=pulled, **settings)
    assert motion.q[:, 0] == pytest.approx(motion.time**3 / 2, abs=1e-9)
    assert motion.a[:, 0] == pytest.approx(3 * motion.time, abs=1e-9)


def test_compiled_steps_that_overflow():
    with pytest.raises(IntegrationFailed, match=r"at 0\.\d s the numbers are no longer finite; take smaller steps"):
        simulate(slider(), [0.0], [1.0], 1.0, torque=PDControl(0.0, -1e200, [0.0]), **FIXED)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"duration": 0.0}, "duration is 0.0; give seconds above zero"),
        ({"method": "rk5"}, "method is 'rk5'; use one of dop853, rk8, rk4, euler"),
        ({"method": "rk4"}, "step is None; method 'rk4' takes steps of fixed width: give seconds above zero"),
        ({"step": 0.1}, "method 'dop853' chooses its steps; leave out step, or take 'rk8', 'rk4' or 'euler'"),
        ({"method": "rk4", "step": 0.3}, "the duration, 1 s, is no multiple of the step, 0.3 s; choose a step"),
        ({"rtol": 0.0}, "rtol is 0.0; give a tolerance above zero"),
        ({"at": [0.5, 0.2]}, "at must be increasing times (N,) between 0 and the duration, 1 s"),
        ({"at": [0.5, 2.0]}, "at must be increasing times"),
        ({"at": [0.05], **FIXED}, "time 0.05 s of at is no multiple of the step, 0.1 s; take such times, or method"),
        ({"torque": [1.0, 2.0]}, "torque has shape (2,), expected (1,) or (K, 1) for robot 'slider'"),
        ({"torque": [[1.0], [2.0], [3.0]], **FIXED}, "3 torques for 10 steps; give a number of rows that divides"),
        ({"torque": lambda t, q, v: [1.0, 2.0]}, "the function torque answers shape (2,) at 0 s; finite numbers of"),
        ({"torque": lambda t, q, v: [np.nan]}, "the function torque answers NaN or infinity at 0 s"),
        ({"external_wrenches": lambda t, q, v: 1.0}, "the function external_wrenches answers shape () at 0 s"),
        ({"q": [0.0, 1.0]}, "q has shape (2,), expected (…, 1) for the 1 joints of robot 'slider'"),
    ],
)
def test_refused(more, message):
    given = {"q": [0.0], "duration": 1.0, **more}
    with pytest.raises(InvalidInput) as caught:
        simulate(slider(), given.pop("q"), [0.0], given.pop("duration"), **given)
    assert str(caught.value).startswith(message)


def test_errors_are_those_of_the_package():
    assert issubclass(IntegrationFailed, GraphDynError)
    assert simulate(kr500(), np.zeros(6), np.zeros(6), 0.01).reactions.joint_wrenches.shape[1:] == (6, 6)


def test_whole():
    """A motion with all that a simulation knows, but for what energy has no balance of."""
    tree = random_tree(7, [0, 1, 1], ["revolute", "prismatic", "continuous"])
    bounded = (replace(joint, limits=JointLimits(-1.0, 0.45)) for joint in tree.joints[:2])
    model = replace(tree, joints=(*bounded, tree.joints[2]))
    motion = simulate(
        model,
        [0.4, 0.1, -0.5],
        [1.0, -0.2, 2.0],
        0.3,
        torque=PDControl([40.0, 60.0, 20.0], [4.0, 6.0, 2.0], np.zeros(3)),
        method="rk4",
        step=1e-3,
        at=np.linspace(0.0, 0.3, 13),
        friction=Friction(viscous=[0.1, 0.2, 0.3], coulomb=[0.2, 0.1, 0.3]),
        rotor_inertia=[0.1, 0.2, 0.3],
        limits=JointStops(1e4, 10.0),
        torque_limits=[15.0, 30.0, 10.0],
    )
    names = ("time", "q", "v", "a", "tau", "passive", "ended", "occurrences", "reactions", "energy")
    approve_result("simulation", {name: getattr(motion, name) for name in names})
