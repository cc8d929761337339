"""Mechanisms with loops in motion: published ones, closed forms, what carries over from trees and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from long_check import few
from robots.loop_motions import four_bars, space_linkage, squeezed
from robots.mechanisms import four_bar, n_four_bar, palletizer
from scipy.integrate import DOP853, solve_ivp
from shared_data import DATA, existing

import graphdyn
from graphdyn import ComputedTorqueControl, Event, Friction, InconsistentState, InvalidInput, PDControl, simulate
from graphdyn.simulation.equations import LoopEquations
from graphdyn.simulation.integration import events
from graphdyn.simulation.integration.steps import LoopSteps, joints_of, tableau
from graphdyn.simulation.plant import make_plant

ADAPTIVE = {"rtol": 1e-10, "atol": 1e-10}
CRANK = four_bar()
START = graphdyn.assemble(CRANK, [0.7, 0.0, 1.0], [1.0, 0, 0], hold=["a"])


def test_published_mechanisms():
    existing(DATA / "loops")
    motion, error = squeezed(method="rk8", step=2e-4)
    assert error < 2e-9  # measured 9e-10; with steps of 1e-4 s 1.6e-12: tests/tools/dynamics/published_loops.py
    assert motion.closure_error().max() < 1e-14
    motion, error = space_linkage(method="rk8", step=0.05)
    assert error < 1e-11
    assert motion.energy.drift < 1e-11
    assert np.isnan(motion.reactions.multipliers).all()


@pytest.mark.parametrize("settings", [ADAPTIVE, {"method": "rk4", "step": 0.01}], ids=["dop853", "rk4"])
def test_the_first_row_is_closed_to_rounding(settings):
    """A start that is open by less than counts is closed before anything else."""
    q, v = START
    motion = simulate(CRANK, q + np.array([0, 2e-9, 0]), v + np.array([0, 0, 2e-9]), 0.02, **settings)
    assert motion.closure_error().max() < 1e-14
    jacobian = CRANK.loops.jacobian(CRANK.loops.links(motion.q[0]))
    assert np.abs(jacobian @ motion.v[0]).max() < 1e-14
    assert motion.q[0] == pytest.approx(q, abs=1e-8)


def test_through_singular_poses():
    motion, error = four_bars(1.0, method="rk8", step=1e-2)  # at 0.715 s
    assert motion.q[-1, 0] < -0.1
    assert error < 1e-8
    assert motion.energy.drift < 1e-9
    adaptive, error = four_bars(1.0, **ADAPTIVE)
    assert error < 1e-7
    assert adaptive.closure_error().max() < 1e-14


def test_the_palletizer_moves_as_its_closed_form():
    model, k = palletizer(existing(DATA / "loops").parent)
    motors = [model.joint_names.index(name) for name in model.actuated]
    u, rate, torque = np.array([0.3, 0.2, -0.1, 0.5]), np.array([0.5, -0.4, 0.3, 1.0]), np.zeros(10)
    torque[motors] = [100.0, -300.0, 200.0, 1.0]
    friction = Friction(10.0)
    motion = simulate(model, k @ u, k @ rate, 0.1, torque=torque, friction=friction, rotor_inertia=2.0, **ADAPTIVE)
    tree = replace(model, chords=(), actuated=None)

    def rates(t, y):
        q, v = k @ y[:4], k @ y[4:]
        driving = torque - 10.0 * v - graphdyn.bias_torque(tree, q, v)
        mass = graphdyn.mass_matrix(tree, q) + 2.0 * np.eye(10)
        return [*y[4:], *np.linalg.solve(k.T @ mass @ k, k.T @ driving)]

    end = solve_ivp(rates, (0, 0.1), [*u, *rate], "DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    assert np.abs(motion.q[-1] - k @ end[:4]).max() < 1e-9
    assert np.abs(motion.v[-1] - k @ end[4:]).max() < 1e-9
    assert motion.energy.drift < 1e-9
    found = motion.reactions
    assert np.isfinite(found.multipliers[0]).sum() + np.isfinite(found.chord_multipliers[0]).sum() == 32


def test_a_divided_step_is_its_parts_one_after_the_other():
    """Their errors add up, and the nearest of them to a singular pose tells how near the step came."""
    equations = LoopEquations(make_plant(CRANK))
    steps = LoopSteps(equations, tableau("rk8"), errors=np.array([DOP853.E3[:12], DOP853.E5[:12]]))
    y, tau = np.concatenate([*START, np.zeros(2)]), np.array([5.0, 0.0, 0.0])
    first = steps._divided(0.0, y, [0.1], lambda t, q, v: tau)
    second = steps._divided(0.1, first.y, [0.2], lambda t, q, v: tau)
    both = steps._divided(0.0, y, [0.1, 0.2], lambda t, q, v: tau)
    assert np.array_equal(both.y, second.y)
    assert both.errors == pytest.approx(np.abs(first.errors) + np.abs(second.errors), rel=1e-12)
    assert both.distance == min(first.distance, second.distance)
    states = [joints_of(part)[0] for part in (y, first.y, second.y)]
    ends = [distance_of_the_crank(q) for q in states]
    assert first.distance == pytest.approx(min(ends[:2]), rel=0.1)
    assert second.distance == pytest.approx(min(ends[1:]), rel=0.1)
    shortest = steps._divided(0.0, y, [1e-9, 1e-9], lambda t, q, v: tau)
    assert shortest.distance == pytest.approx(ends[0], rel=1e-6)


def distance_of_the_crank(q):
    """By the singular values of d/dq (e(q₁) + 2 e(q₁ + q₂) - 1.5 e(q₃))."""
    a, b, c = q
    turning = np.array([[np.cos(x), np.sin(x)] for x in (a, a + b, c)])
    motions = [turning[0] + 2 * turning[1], 2 * turning[1], -1.5 * turning[2]]
    largest, smallest = np.linalg.svd(motions)[1]
    return smallest / largest


def test_how_far_a_regular_pose_is_from_a_singular_one():
    """Care is taken at a tenth of it."""
    equations, usual = LoopEquations(make_plant(CRANK)), distance_of_the_crank(CRANK.regular_pose)
    assert equations.usual_distance == pytest.approx(usual)
    assert LoopSteps(equations, tableau("rk8")).wary == pytest.approx(0.1 * usual)


LOOP_SETTINGS = {"dop853": ADAPTIVE, "rk8": {"method": "rk8", "step": 0.02}}

PARALLELOGRAM = four_bar(1.0, 2.0, 1.0, 2.0).with_gravity(np.zeros(3))
"""The crank turns, the rocker with it, and the coupler keeps its direction: a double integrator."""

CRANK_INERTIA = 1 / 3 + 1 / 3 + 1
"""Both rods about their ends, and the mass of the coupler at the crank's [kg m²]."""


def drawn(angle, rate=0.0):
    """q and v of the parallelogram."""
    return np.array([angle, -angle, angle]), np.array([rate, -rate, rate])


def on_course(motion, start, rate):
    """Whether φ̈ = 60 t / I has come out, with closed velocities."""
    t = motion.time
    assert np.abs(motion.q - np.outer(start + rate * t + 10 * t**3 / CRANK_INERTIA, [1, -1, 1])).max() < 1e-9
    assert np.abs(motion.v - np.outer(rate + 30 * t**2 / CRANK_INERTIA, [1, -1, 1])).max() < 1e-9
    regular = np.abs(motion.q[:, 0]) > 0.02
    assert np.abs((motion.v @ [[1, 0], [1, 1], [0, 1]])[regular]).max() < 1e-12


@pytest.mark.parametrize("settings", few(LOOP_SETTINGS, "rk8"))
def test_torques_of_time_in_loops(settings):
    """Through the flat pose."""
    motion = simulate(
        PARALLELOGRAM, *drawn(-0.03, 1.0), 0.06, torque=lambda t, q, v: [60 * t, 0, 0], **LOOP_SETTINGS[settings]
    )
    on_course(motion, -0.03, 1.0)


def test_wrenches_of_time_in_loops():
    turned = np.zeros((3, 6))
    turned[0, 5] = 60
    motion = simulate(
        PARALLELOGRAM, *drawn(0.5), 0.06, external_wrenches=lambda t, q, v: t * turned, method="rk4", step=0.03
    )
    on_course(motion, 0.5, 0.0)


@pytest.mark.parametrize("settings", LOOP_SETTINGS.values(), ids=LOOP_SETTINGS)
def test_held_torques_and_rotors_in_loops(settings):
    """A torque for half of the time, then its opposite; friction, rotors and reactions from the balance of momentum."""
    viscous, rotor, torque, duration = 3.0, 0.4, 2.0, 0.08
    held = [[torque, 0, 0], [-torque, 0, 0]]
    motion = simulate(PARALLELOGRAM, *drawn(0.8), duration, torque=held, rotor_inertia=rotor, **settings)
    rate = torque / (CRANK_INERTIA + 3 * rotor)
    assert motion.q[-1, 0] - 0.8 == pytest.approx(rate * duration**2 / 4, rel=1e-9)
    assert motion.v[-1, 0] == pytest.approx(0.0, abs=1e-9)
    motion = simulate(
        PARALLELOGRAM, *drawn(0.8), 0.1, torque=held[0], friction=Friction(viscous), rotor_inertia=rotor, **settings
    )
    lag = (CRANK_INERTIA + 3 * rotor) / (3 * viscous)
    v = torque / (3 * viscous) * (1 - np.exp(-motion.time / lag))
    assert np.abs(motion.v[:, 0] - v).max() < 1e-9
    assert np.abs(motion.reactions.tau[:, 2] + viscous * v + rotor * motion.a[:, 0]).max() < 1e-9
    # the ground's forces on crank and rocker, in axes of the ground, move the centers of mass
    forces = np.linalg.norm(motion.reactions.joint_wrenches[:, [0, 2], :2].sum(axis=1), axis=-1)
    assert forces == pytest.approx((0.5 + 1.0 + 0.5) * np.hypot(v**2, motion.a[:, 0]), rel=1e-9)


def test_steps_of_loops_are_as_many_as_of_the_pendulum_they_are():
    """The parallelogram under gravity is a pendulum; the error of all three joints is that of one."""
    model, weight = PARALLELOGRAM.with_gravity(np.array([0, -9.81, 0])), 9.81 * (0.5 + 1.0 + 0.5)
    for tolerance in (1e-4, 1e-9):
        tight = {"rtol": tolerance, "atol": tolerance}
        motion = simulate(model, *drawn(0.4), 0.5, **tight)
        plain = solve_ivp(
            lambda t, y: [y[1], -weight * np.cos(y[0]) / CRANK_INERTIA], (0, 0.5), [0.4, 0.0], "DOP853", **tight
        )
        assert abs(len(motion.time) - len(plain.t)) <= 3
        assert np.abs(motion.q[-1, 0] - plain.y[0, -1]) < 100 * tolerance


@pytest.mark.parametrize("settings", LOOP_SETTINGS.values(), ids=LOOP_SETTINGS)
def test_events_may_call_verbs(settings, monkeypatch):
    """They are asked at closed states alone."""
    monkeypatch.setattr(events, "PIECES_OF_DURATION", 2)
    weight = graphdyn.inverse_dynamics(CRANK, START[0], 0 * START[1], 0 * START[1]).tau[0]

    def lighter(t, q, v):
        return graphdyn.inverse_dynamics(CRANK, q, 0 * v, 0 * v).tau[0] - 0.99 * weight

    motion = simulate(CRANK, *START, 0.04, events=Event(lighter, "lighter"), **settings)
    assert motion.ended == "lighter"
    assert lighter(0.0, motion.q[-1], motion.v[-1]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("settings", LOOP_SETTINGS.values(), ids=LOOP_SETTINGS)
def test_controllers_events_and_rows(settings):
    hold = PDControl([50.0, 0, 0], [10.0, 0, 0], START[0], period=0.04)
    passing = Event(lambda t, q, v: q[0] - START[0][0] - 0.02, "passing", stop=False, direction=1)
    ended = Event(lambda t, q, v: t - 0.25, "time")
    motion = simulate(CRANK, *START, 0.4, torque=hold, at=[0.1, 0.2, 0.4], events=[passing, ended], **settings)
    assert motion.time == pytest.approx([0.1, 0.2, 0.25])
    assert [occurrence.name for occurrence in motion.occurrences] == ["passing", "time"]
    assert motion.occurrences[0].q[0] == pytest.approx(START[0][0] + 0.02, abs=1e-6)
    assert motion.ended == "time"
    assert motion.closure_error().max() < 1e-14
    assert not motion.tau[:, 1:].any()


def test_torque_functions_are_asked_at_closed_states():
    def weight(t, q, v):
        return graphdyn.inverse_dynamics(CRANK, q, 0 * v, 0 * v).tau

    motion = simulate(CRANK, START[0], np.zeros(3), 0.2, torque=weight, method="rk4", step=0.05)
    assert np.abs(motion.q - START[0]).max() < 1e-13
    stop = replace(
        CRANK,
        joints=tuple(replace(j, limits=graphdyn.JointLimits(-3.0, START[0][0] + 0.01)) for j in CRANK.joints[:1])
        + CRANK.joints[1:],
    )
    motion = simulate(stop, *START, 1.0, limits="stop", **ADAPTIVE)
    assert motion.ended == "upper limit of joint 'a'"
    assert motion.q[-1, 0] == pytest.approx(START[0][0] + 0.01, abs=1e-13)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"friction": Friction(1.0, 1.0)}, "has loops, in which dry friction is not simulated"),
        ({"torque": ComputedTorqueControl(1.0, 1.0, START[0])}, "ComputedTorqueControl does not know the loops"),
        ({"coordinates": "maximal", "method": "rk4", "step": 0.1}, "coordinates='maximal' does not know the loops"),
    ],
)
def test_refused(more, message):
    with pytest.raises(InvalidInput, match=message):
        simulate(CRANK, *START, 1.0, **more)


def test_refused_states_and_answers():
    with pytest.raises(InconsistentState, match="the loop of chord 'closing' is open by"):
        simulate(CRANK, [0.0, 0.5, 0.0], np.zeros(3), 1.0)
    with pytest.raises(InvalidInput, match=r"'n-four-bar' starts in a singular pose of its loops, .*; start beside it"):
        simulate(n_four_bar(2), np.zeros(5), np.zeros(5), 1.0)
    motion = simulate(CRANK, *START, 0.1, method="rk4", step=0.05)
    with pytest.raises(InvalidInput, match="a recording does not know the loops of robot 'four-bar'; take time, q"):
        motion.recording()
    with pytest.raises(graphdyn.IntegrationFailed, match=r"take smaller steps, or smaller torques"):
        simulate(CRANK, *START, 10.0, torque=[1e6, 0, 0], method="euler", step=1.0)
    with pytest.raises(graphdyn.IntegrationFailed, match=r"failed at 0 s: steps have become too narrow"):
        simulate(CRANK, *START, 1.0, rtol=1e-60, atol=1e-60)
