"""Maximal coordinates: projection closes the joints, Baumgarte keeps them nearly closed, nothing lets them drift."""

import numpy as np
import pytest
from random_trees import NAMED, random_state
from robots.moving_robots import slider
from scipy.integrate import cumulative_simpson
from scipy.linalg import block_diag, null_space

from graphdyn import Event, Friction, InvalidInput, PDControl, maximal_state, simulate
from graphdyn.equations.system.constraints import constraints
from graphdyn.layout import stacked
from graphdyn.model.spatial import apply
from graphdyn.simulation.integration.events import InitialValueProblem
from graphdyn.simulation.integration.maximal import _least, _MaximalRun
from graphdyn.simulation.integration.steps import tableau
from graphdyn.simulation.plant import make_plant
from graphdyn.simulation.torques import torques

SETTINGS = {"method": "rk4", "step": 0.01, "coordinates": "maximal"}

CLOSED = 1e-14
"""Of projected joints, in m and as cosines; measured 6e-16."""


def closures(name, duration=0.6):
    model = NAMED[name]
    q, v, _ = random_state(model, 2)
    return {
        kind: simulate(model, q, v, duration, stabilization=kind, **SETTINGS).closure_error()
        for kind in ("projection", "baumgarte", "none")
    }


def test_projection_beats_baumgarte_beats_nothing():
    errors = closures("revolute_chain")
    assert errors["projection"].max() < CLOSED
    assert errors["none"][-1] > 5 * errors["none"][len(errors["none"]) // 4]  # it grows
    assert errors["projection"].max() < errors["baumgarte"][-1] < errors["none"][-1]


def test_projections_are_the_least_in_the_norm_of_the_masses():
    """What is needed and no motion of the joints besides: orthogonal, by A, to the null space of φ_q."""
    model = NAMED["mixed_chain"]
    state = maximal_state(model, *random_state(model, 3)[:2])
    phi_q, _ = constraints(state)
    right = np.random.default_rng(0).normal(size=len(phi_q))
    change = _least(state, phi_q, right)
    assert phi_q @ change == pytest.approx(right, abs=1e-12 * np.abs(phi_q).max() * np.abs(change).max())
    blocks = [block for body in model.bodies for block in (body.mass * np.eye(3), body.inertia)]
    along = null_space(phi_q).T @ block_diag(*blocks) @ change
    assert np.abs(along).max() < 1e-12 * np.abs(change).max()


@pytest.mark.parametrize("name", ["mixed_chain", "prismatic_inside_and_out"])
def test_the_same_motion_as_in_joint_coordinates(name):
    """Order 8 in both coordinates, with a torque and an external wrench."""
    model = NAMED[name]
    q, v, tau = random_state(model, 2)
    wrenches = np.ones((model.n_bodies, 6))
    given = {"torque": tau, "external_wrenches": wrenches, "method": "rk8", "step": 0.01}
    bodies = simulate(model, q, v, 0.1, coordinates="maximal", **given)
    joints = simulate(model, q, v, 0.1, **given)
    assert np.abs(bodies.q - joints.q).max() < 1e-11  # measured 8e-14
    assert np.abs(bodies.v - joints.v).max() < 1e-10
    assert np.abs(bodies.a - joints.a).max() < 1e-9 * np.abs(joints.a).max()
    assert bodies.closure_error().max() < CLOSED
    assert np.abs(bodies.reactions.multipliers - joints.reactions.multipliers).max() < 1e-8


def test_torques_and_wrenches_of_time():
    """m ẍ = 6 t + 6 t: a cubic, which order four follows exactly; in steps of more than a turn of an angle."""
    given = {"torque": lambda t, q, v: [6 * t], "external_wrenches": lambda t, q, v: [[6 * t, 0, 0, 0, 0, 0]]}
    motion = simulate(slider(mass=2.0), [0.0], [900.0], 0.2, **given, **SETTINGS)
    assert motion.q[:, 0] == pytest.approx(900.0 * motion.time + motion.time**3, abs=1e-10)


def test_torques_that_are_held():
    held = simulate(slider(mass=2.0), [0.0], [0.0], 0.2, torque=[[1.0], [-1.0]], **SETTINGS)
    assert held.q[-1, 0] == pytest.approx(0.2**2 / 8, rel=1e-12)
    assert held.tau[[0, 9, 10, -1], 0].tolist() == [1.0, 1.0, -1.0, -1.0]


def test_torques_are_within_their_limits():
    """100 N are asked of a drive that gives 3 N to 2 kg: x = 3/4 t²."""
    drive = {"torque": lambda t, q, v: [100.0], "torque_limits": 3.0}
    motion = simulate(slider(mass=2.0), [0.0], [0.0], 0.02, **drive, **SETTINGS)
    assert motion.q[-1, 0] == pytest.approx(0.75 * 0.02**2, rel=1e-12)
    assert motion.tau[:, 0].tolist() == [3.0] * 3


def test_a_controller_that_is_asked_now_and_then():
    """Its torque is held for five steps: x and v from sample to sample by hand."""
    mass, k, d, period = 2.0, 30.0, 4.0, 0.05
    motion = simulate(slider(mass=mass), [1.0], [0.0], 0.15, torque=PDControl(k, d, [0.0], period=period), **SETTINGS)
    x, v, states = 1.0, 0.0, []
    for _ in range(3):
        a = -(k * x + d * v) / mass
        x, v = x + v * period + a * period**2 / 2, v + a * period
        states.append(x)
    assert motion.q[[5, 10, 15], 0] == pytest.approx(states, rel=1e-12)


def test_angles_of_many_turns():
    model = NAMED["one_revolute"].with_gravity(np.zeros(3))
    motion = simulate(model, [0.0], [100.0], 0.2, **SETTINGS)
    assert motion.q[:, 0] == pytest.approx(100.0 * motion.time, rel=1e-2)


def test_baumgarte_damps_critically():
    """φ̈ is by -2 α φ̇ - α² φ another than without; α is one over twenty steps."""
    model = NAMED["revolute_chain"]
    q, v, tau = random_state(model, 2)
    problem = InitialValueProblem(make_plant(model), (q, v), 1.0, torques(tau, model, 1.0), None, (), False, print)
    found = {}
    for kind in ("baumgarte", "none"):
        run = _MaximalRun(problem, tableau("rk4"), 0.01, 1, kind)
        rng = np.random.default_rng(0)
        opened = run._pose.position + 1e-3 * rng.normal(size=run._pose.position.shape)
        state = run._state(run._pose._replace(position=opened, velocity=run._pose.velocity + 1e-2))
        found[kind] = run._acceleration(0.0, state, tau)
    phi_q, _ = constraints(state)
    changed = apply(phi_q, stacked(found["baumgarte"] - found["none"]))
    alpha = 1 / (20 * 0.01)
    expected = -2 * alpha * apply(phi_q, stacked(state.velocity)) - alpha**2 * stacked(state.constraint_residual())
    assert np.abs(changed - expected).max() < 1e-9 * np.abs(expected).max()


def test_work_and_angles_beyond_a_turn():
    """A turning body passes π; its angle does not jump, and the work of a function of time is accounted for."""
    model = NAMED["one_revolute"].with_gravity(np.zeros(3))
    motion = simulate(model, [3.0], [2.0], 0.3, torque=lambda t, q, v: [t], at=[0.0, 0.15, 0.3], **SETTINGS)
    assert motion.q[-1, 0] > 3.5
    assert motion.energy.drift < 1e-8
    assert motion.energy.work[-1] > 0


def test_work_that_is_taken_from_the_bodies():
    """A damper, a motor that brakes and a motor that drives: by ∫ τ v dt over the rows, and by the energies."""
    model = NAMED["mixed_chain"]
    q, v, _ = random_state(model, 2)
    gains = np.array([-2.0, 1.0, -0.5, -3.0])
    motion = simulate(
        model, q, v, 0.2, torque=lambda t, q, v: gains * v, method="rk8", step=0.01, coordinates="maximal"
    )
    power = (gains * motion.v**2).sum(axis=-1)
    assert motion.energy.work == pytest.approx(cumulative_simpson(power, x=motion.time, initial=0), abs=2e-4)
    assert motion.energy.work.min() < 0
    assert motion.energy.drift < 1e-6


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"friction": Friction(1.0)}, "maximal coordinates do not know friction; omit it, or use joint coordinates"),
        ({"limits": "stop", "rotor_inertia": 1.0}, "maximal coordinates do not know rotor_inertia, limits"),
        ({"events": Event(lambda t, q, v: 1.0)}, "maximal coordinates do not know events"),
        ({"method": "dop853", "step": None}, "maximal coordinates take steps of fixed width"),
        ({"stabilization": "springs"}, "stabilization is 'springs'; use 'projection', 'baumgarte' or 'none'"),
        ({"coordinates": "natural"}, "coordinates is 'natural'; use 'joint' or 'maximal'"),
    ],
)
def test_refused(more, message):
    with pytest.raises(InvalidInput) as caught:
        simulate(slider(), [0.0], [0.0], 1.0, **{**SETTINGS, **more})
    assert str(caught.value).startswith(message)
