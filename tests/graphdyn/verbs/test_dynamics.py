"""graphdyn.gravity_torque, the gradient of the potential energy, and static_torque, which holds loads too.

Of a base that moves only the placement counts.
"""

import numpy as np
import pytest
from random_trees import NAMED, random_base_motion, random_rotation, random_state, random_wrenches
from witnesses import derivative, potential_energy, relative_error, twists_at_origins

import graphdyn
from graphdyn import BaseMotion, InvalidInput, Placement

DIFFERENCE = 1e-11
"""Sixth-order central differences of the energy, relative to the largest wrench: measured 1.5e-13."""

IDENTITY = 1e-13
"""Two sums of the same terms in another order, relative to the largest wrench: measured 7.8e-16."""

SINGLE_METHODS = ("dense", "projected", "recursive")

robots = pytest.mark.parametrize("model", NAMED.values(), ids=NAMED)
methods = pytest.mark.parametrize("method", SINGLE_METHODS)


def at_rest(model, q):
    """Joint wrenches without motion: what the torque is a part of."""
    zero = np.zeros_like(q)
    return graphdyn.inverse_dynamics(model, q, zero, zero).joint_wrenches


@robots
@methods
def test_it_is_the_gradient_of_the_potential_energy(model, method):
    q, _, _ = random_state(model, 5)
    gradient = np.array([derivative(lambda t, e=e: potential_energy(model, q + t * e)) for e in np.eye(model.n_bodies)])
    found = graphdyn.gravity_torque(model, q, method=method)
    assert np.abs(found).max() > 0.1
    assert relative_error(found, gradient, at_rest(model, q), potential_energy(model, q)) < DIFFERENCE


@robots
@methods
def test_it_is_the_bias_torque_without_velocity(model, method):
    q, _, _ = random_state(model, 6, (5,))
    found = graphdyn.gravity_torque(model, q, method=method)
    expected = graphdyn.bias_torque(model, q, 0 * q, method=method)
    assert relative_error(found, expected, at_rest(model, q)) < IDENTITY


@robots
@methods
def test_of_a_moving_base_only_the_placement_counts(model, method, rng):
    q, _, _ = random_state(model, 7, (3,))
    rotation = random_rotation(rng)
    moving = BaseMotion(rotation, rng.normal(size=3), rng.normal(size=6), rng.normal(size=6))
    placed = model.with_base(Placement(rotation) @ model.base)
    found = graphdyn.gravity_torque(model, q, base=moving, method=method)
    assert relative_error(found, graphdyn.gravity_torque(placed, q), at_rest(placed, q)) < IDENTITY
    assert relative_error(found, graphdyn.gravity_torque(model, q), at_rest(model, q)) > 1e-3


@robots
@methods
def test_static_torque_balances_gravity_and_loads(model, method):
    """In every virtual motion δq: τ·δq + the work of the loads = the change of the potential energy."""
    q, motion, _ = random_state(model, 9)
    loads = random_wrenches(model, 10)
    gained = derivative(lambda t: potential_energy(model, q + t * motion))
    work = loads * twists_at_origins(graphdyn.maximal_state(model, q, motion))
    found = graphdyn.static_torque(model, q, loads, method=method)
    assert relative_error(found @ motion, gained - work.sum(), work, potential_energy(model, q)) < DIFFERENCE


@robots
@methods
def test_static_torque_is_inverse_dynamics_at_rest(model, method):
    q, _, _ = random_state(model, 11, (3,))
    loads, moving = random_wrenches(model, 12, (3,)), random_base_motion(13)
    placed = BaseMotion(moving.rotation, moving.translation)
    expected = graphdyn.inverse_dynamics(model, q, 0 * q, 0 * q, loads, base=placed)
    found = graphdyn.static_torque(model, q, loads, base=moving, method=method)
    assert relative_error(found, expected.tau, expected.joint_wrenches) < IDENTITY
    unloaded = graphdyn.static_torque(model, q, base=moving, method=method)
    assert np.array_equal(unloaded, graphdyn.gravity_torque(model, q, base=moving, method=method))


@methods
def test_without_gravity_it_is_zero(method):
    model = NAMED["kr500"].with_gravity([0.0, 0.0, 0.0])
    assert not graphdyn.gravity_torque(model, random_state(model, 8)[0], method=method).any()


def test_another_number_of_joints_is_refused():
    with pytest.raises(InvalidInput, match=r"q has shape \(5,\), expected \(…, 6\) for the 6 joints of robot 'kr500'"):
        graphdyn.gravity_torque(NAMED["kr500"], np.zeros(5))
