"""Friction that sticks, limits, and events, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from random_trees import random_tree
from robots.moving_robots import G, pendulum, slider

from graphdyn import Event, Friction, InvalidInput, JointLimits, JointStops, kr500, simulate
from graphdyn.simulation.equations import Equations
from graphdyn.simulation.plant import make_plant

SETTINGS = [{}, {"method": "rk4", "step": 1e-3}]
IDS = ["dop853", "rk4"]

STEP_LATE = 2e-3
"""Fixed steps notice that a joint stops or breaks loose at most one step late; twice that is allowed."""


@pytest.fixture(params=SETTINGS, ids=IDS)
def settings(request):
    return request.param


def late(settings):
    return STEP_LATE if settings else 1e-9


def test_no_creep(settings):
    """An arm that dry friction holds stays where it is for ten seconds, bit for bit."""
    model, q = kr500(), np.array([0.2, 0.5, -0.3, 0.4, 0.6, -0.2])
    motion = simulate(model, q, np.zeros(6), 10.0, friction=Friction(coulomb=1e5), **settings)
    assert np.array_equal(motion.q, np.broadcast_to(q, motion.q.shape))
    assert not motion.v.any()
    assert not motion.a.any()
    assert np.abs(motion.passive - motion.reactions.tau).max() < 1e-9  # friction holds the weight: 1e4 N m


def test_slides_to_rest_and_stays(settings):
    """A mass slides to rest by dry friction: v² / (2 F/m), and then does not move."""
    mass, speed, dry = 2.0, 3.0, 5.0
    motion = simulate(slider(mass=mass), [0.0], [speed], 4.0, friction=Friction(coulomb=dry), **settings)
    stop = speed * mass / dry
    assert motion.q[-1, 0] == pytest.approx(speed**2 * mass / (2 * dry), abs=late(settings) * speed * 1e-2)
    resting = motion.time > stop + late(settings)
    assert resting.any()
    assert not motion.v[resting].any()
    assert len(set(motion.q[resting, 0])) == 1
    assert motion.energy.loss[-1] == pytest.approx(-mass * speed**2 / 2, rel=1e-5)


def test_breaks_loose_when_the_torque_exceeds_friction(settings):
    """The force grows as 2 t; the mass moves from t = F_c / 2 on."""
    dry, mass = 3.0, 2.0
    motion = simulate(
        slider(mass=mass),
        [0.0],
        [0.0],
        2.0,
        torque=lambda t, q, v: [2 * t],
        friction=Friction(coulomb=dry),
        at=[1.0, 1.5, 2.0],
        **settings,
    )
    assert motion.q[:2, 0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert motion.q[2, 0] == pytest.approx(0.5**3 / 3 / mass, rel=10 * late(settings) + 1e-8)


def test_slides_the_way_it_is_pushed(settings):
    """From rest, beyond F_c, either way: (τ - F_c) t² / 2 m."""
    for side in (1.0, -1.0):
        motion = simulate(slider(), [0.0], [0.0], 1.0, torque=[side * 3.0], friction=Friction(coulomb=1.0), **settings)
        assert motion.q[-1, 0] == pytest.approx(side * (3.0 - 1.0) / 2.0 / 2, rel=1e-9)


@pytest.mark.parametrize("torque", [[-2.0], lambda t, q, v: [-2.0]], ids=["held", "function"])
def test_a_reversal_without_dry_friction(settings, torque):
    """m v̇ = τ - d v: the velocity passes zero between two steps as if nothing were there."""
    mass, d, speed = 2.0, 3.0, 0.7
    given = {**settings, "step": 0.05} if settings else settings
    motion = simulate(slider(mass=mass), [0.0], [speed], 1.0, torque=torque, friction=Friction(viscous=d), **given)
    expected = -2.0 / d + (speed + 2.0 / d) * np.exp(-d / mass * motion.time)
    assert np.abs(motion.v[:, 0] - expected).max() < 1e-6
    assert motion.v[-1, 0] < 0 < motion.v[1, 0]


def crossed_slides(first, second):
    """A carriage on a rail across another, of these masses."""
    below, above = slider(mass=first), slider((0.0, 1.0, 0.0), mass=second)
    body, joint = replace(above.bodies[0], name="upper"), replace(above.joints[0], name="cross", inside=1)
    return replace(below, bodies=(*below.bodies, body), joints=(*below.joints, joint))


def test_each_joint_stops_and_breaks_loose_by_its_own_friction(settings):
    """v² m / 2 F_c each; the second stops first, and breaks loose when 2 t has grown beyond its F_c."""
    model, dry = crossed_slides(3.0, 1.0), np.array([2.0, 4.0])
    motion = simulate(model, [0.0, 0.0], [1.0, -1.0], 3.0, friction=Friction(coulomb=dry), **settings)
    expected = [4.0 / (2 * 2.0), -1.0 / (2 * 4.0)]
    assert motion.q[-1] == pytest.approx(expected, abs=2 * late(settings))
    assert not motion.v[-1].any()
    if settings:
        return
    pushed = simulate(
        model, [0.0, 0.0], [0.0, 0.0], 2.5, torque=lambda t, q, v: [0.0, 2 * t], friction=Friction(coulomb=dry)
    )
    assert pushed.q[-1] == pytest.approx([0.0, 0.5**3 / 3], abs=1e-8)


def test_one_joint_has_dry_friction_and_another_none(settings):
    """3 kg run freely while 1 kg on them rests under less than its F_c."""
    friction = Friction(coulomb=[0.0, 4.0])
    motion = simulate(
        crossed_slides(2.0, 1.0), [0, 0], [1.0, 0.0], 0.5, torque=[0.0, 3.0], friction=friction, **settings
    )
    assert motion.q[-1] == pytest.approx([0.5, 0.0], abs=1e-12)


def test_which_joints_begin_to_slide():
    """Coulomb's law at every joint: what is held needs no more than F_c, what slides does so against its friction.

    In a third of these cases a joint would begin to slide, and does not once another does.
    """
    model, driven_back = random_tree(0, (0, 1, 2), ("revolute", "prismatic", "revolute")), 0
    for seed in range(0, 60, 2):
        rng = np.random.default_rng(seed)
        dry = rng.uniform(0, 20, 3)
        equations = Equations(make_plant(model, friction=Friction(coulomb=dry)))
        q, rest, tau = rng.uniform(-1, 1, 3), np.zeros(3), rng.uniform(-30, 30, 3)
        contact = equations.contact(0.0, q, rest, tau, passes=20)
        rates = equations.rates(0.0, q, rest, tau, contact)
        assert (np.where(contact.free, -rates.a * contact.sign, np.abs(rates.held) - dry) < 1e-7).all()
        driven_back += bool((equations.contact(0.0, q, rest, tau).free & ~contact.free).any())
    assert driven_back > 5


def test_stops_push_and_never_pull(settings):
    """Beyond its limit and fast on its way back, a joint moves freely: the damper would hold it."""
    model = slider(limits=JointLimits(-1.0, 1.0))
    for side in (1.0, -1.0):
        motion = simulate(
            model, [side * 1.1], [-side * 10.0], 0.1, limits=JointStops(50.0, 100.0), at=[0.0, 0.1], **settings
        )
        assert motion.q[-1, 0] == pytest.approx(side * 0.1, abs=1e-9)
        assert not motion.passive.any()


def test_only_the_loaded_joint_slips():
    """Of a heavy arm whose second joint cannot hold the weight, only that one moves; the others stand still."""
    model, q = kr500(), np.array([0.0, 0.4, 0.0, 0.0, 0.0, 0.0])
    coulomb = np.array([1e5, 10.0, 1e5, 1e5, 1e5, 1e5])
    for settings in SETTINGS:
        motion = simulate(model, q, np.zeros(6), 0.2, friction=Friction(coulomb=coulomb), **settings)
        moved = np.abs(motion.q[-1] - q)
        assert moved[1] > 0.01
        assert not moved[[0, 2, 3, 4, 5]].any()


def test_viscous_friction_of_the_file():
    model = pendulum(damping=0.4)
    free = model.with_gravity(np.zeros(3))
    inertia = 1.3 * 0.7**2
    motion = simulate(free, [0.0], [1.0], 2.0, friction="model", at=[2.0])
    assert motion.v[0, 0] == pytest.approx(np.exp(-0.4 * 2.0 / inertia), rel=1e-8)
    assert simulate(free, [0.0], [1.0], 2.0, at=[2.0]).v[0, 0] == 1.0


def test_friction_of_identified_parameters():
    friction = Friction.identified(kr500(), {"FV_2": 3.0, "FC_1": 4.0, "OFF_6": -1.0, "M_1": 7.0})
    assert friction.viscous.tolist() == [0, 3, 0, 0, 0, 0]
    assert friction.coulomb.tolist() == [4, 0, 0, 0, 0, 0]
    assert friction.offset.tolist() == [0, 0, 0, 0, 0, -1]


def test_stops_at_a_limit(settings):
    """A mass falls onto its lower limit after sqrt(2 h / g)."""
    model = slider(direction=(0.0, 0.0, 1.0), limits=JointLimits(-0.3, 1.0))
    motion = simulate(model, [0.0], [0.0], 2.0, limits="stop", **settings)
    assert motion.ended == "lower limit of joint 'rail'"
    assert motion.time[-1] == pytest.approx(np.sqrt(2 * 0.3 / G), rel=1e-9)
    assert motion.q[-1, 0] == pytest.approx(-0.3, rel=1e-12)
    assert motion.v[-1, 0] == pytest.approx(-np.sqrt(2 * 0.3 * G), rel=1e-9)
    assert len(motion.occurrences) == 1


def test_springs_at_a_limit(settings):
    """It rests on the spring of its limit, m g / k below."""
    model = slider(direction=(0.0, 0.0, 1.0), limits=JointLimits(-0.3, 1.0))
    motion = simulate(model, [-0.3], [0.0], 4.0, limits=JointStops(2000.0, 100.0), **settings)
    assert motion.q[-1, 0] == pytest.approx(-0.3 - 2.0 * G / 2000.0, rel=1e-7)
    assert motion.passive[-1, 0] == pytest.approx(2.0 * G, rel=1e-6)


def test_torque_limits(settings):
    motion = simulate(slider(), [0.0], [0.0], 1.0, torque=[50.0], torque_limits=3.0, **settings)
    assert motion.q[-1, 0] == pytest.approx(3.0 / 2.0 / 2, rel=1e-9)
    assert np.all(motion.tau == 3.0)
    efforts = slider(limits=JointLimits(effort=4.0))
    assert np.all(simulate(efforts, [0.0], [0.0], 1.0, torque=[-50.0], torque_limits="model", **settings).tau == -4.0)
    for nothing in (None, 0.0):
        free = slider(limits=JointLimits(effort=nothing))
        assert np.all(simulate(free, [0.0], [0.0], 0.2, torque=[-50.0], torque_limits="model", **settings).tau == -50.0)


def test_events_are_recorded_and_stop(settings):
    """A pendulum passes the bottom every half period, and the third passage ends the simulation."""
    passages = Event(lambda t, q, v: q[0], "bottom", stop=False)
    end = Event(lambda t, q, v: t - 2.0, "two seconds")
    motion = simulate(pendulum(), [0.1], [0.0], 5.0, events=[passages, end], at=np.linspace(0, 5, 51), **settings)
    found = [occurrence.time for occurrence in motion.occurrences if occurrence.name == "bottom"]
    period = 2 * np.pi * np.sqrt(0.7 / G) * (1 + 0.1**2 / 16)
    assert found == pytest.approx([period / 4, 3 * period / 4, 5 * period / 4][: len(found)], rel=1e-5)
    assert len(found) == 2 or len(found) == 3
    assert motion.ended == "two seconds"
    assert motion.time[-1] == pytest.approx(2.0, abs=1e-12)


def test_direction_of_an_event():
    falling = Event(lambda t, q, v: q[0], "falling", stop=False, direction=-1)
    for settings in SETTINGS:
        motion = simulate(pendulum(), [0.1], [0.0], 3.3, events=falling, **settings)
        assert all(occurrence.v[0] < 0 for occurrence in motion.occurrences)
        assert len(motion.occurrences) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"friction": "file"}, "friction is 'file'; give a Friction, 'model' for that of the file, or None"),
        ({"limits": "bounce"}, "limits is 'bounce'; give 'stop', a JointStops, or None"),
        ({"torque_limits": -1.0}, "torque_limits are largest magnitudes; give zero or more"),
        ({"torque_limits": "file"}, "torque_limits is 'file'; give numbers, 'model', or None"),
        ({"rotor_inertia": -1.0}, "rotor_inertia is negative; give zero or more"),
        ({"rotor_inertia": [1.0, 2.0]}, "rotor_inertia has shape (2,), expected () or (1,) for the 1 joints"),
        ({"rotor_inertia": np.nan}, "rotor_inertia contains NaN or infinity"),
        ({"external_wrenches": [1.0, 2.0]}, "external_wrenches has shape (2,), expected (1, 6)"),
    ],
)
def test_refused(arguments, message):
    with pytest.raises(InvalidInput) as caught:
        simulate(slider(), [0.0], [0.0], 1.0, **arguments)
    assert str(caught.value).startswith(message)


def test_refused_friction_and_stops():
    with pytest.raises(InvalidInput, match=r"viscous friction is negative \(-1\); give zero or more"):
        Friction(viscous=-1.0)
    with pytest.raises(InvalidInput, match="stiffness of the stops is negative"):
        JointStops(-1.0)
    with pytest.raises(InvalidInput, match="coulomb friction contains NaN or infinity"):
        Friction(coulomb=np.inf)
    model = slider(limits=JointLimits(-0.3, 1.0))
    with pytest.raises(InvalidInput, match=r"joint 'rail' starts at 2, outside its limits -0.3 … 1; start inside"):
        simulate(model, [2.0], [0.0], 1.0, limits="stop")
