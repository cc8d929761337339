"""Maximal coordinates: projection closes the joints, Baumgarte keeps them nearly closed, nothing lets them drift."""

import numpy as np
import pytest
from random_trees import NAMED, random_state
from robots.moving_robots import slider

from graphdyn import Event, Friction, InvalidInput, simulate

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


def test_work_and_angles_beyond_a_turn():
    """A turning body passes π; its angle does not jump, and the work of a function of time is accounted for."""
    model = NAMED["one_revolute"].with_gravity(np.zeros(3))
    motion = simulate(model, [3.0], [2.0], 0.3, torque=lambda t, q, v: [t], at=[0.0, 0.15, 0.3], **SETTINGS)
    assert motion.q[-1, 0] > 3.5
    assert motion.energy.drift < 1e-8
    assert motion.energy.work[-1] > 0


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
