"""MuJoCo as a third witness of frames, momentum, energies and derivatives, where it has the quantity."""

import numpy as np
import pytest
from planting import mixed_tree

import urdf
from crosscheck.reference.mujoco_model import MujocoModel
from graphdyn import (
    center_of_mass,
    center_of_mass_jacobian,
    center_of_mass_velocity,
    centroidal_map,
    frame_jacobian,
    frame_jacobian_derivative,
    inverse_dynamics_derivatives,
    kinetic_energy,
    momentum,
    potential_energy,
)

mujoco = pytest.importorskip("mujoco", reason="the package mujoco is not installed")

CLOSE = 1e-12
"""MuJoCo keeps orientations as quaternions and inertias in principal axes; relative to the largest entry."""

DIFFERENCES = 2e-7
"""Of mjd_inverseFD, whose differences are one-sided; relative to the largest entry."""

STEP = 1e-7


@pytest.fixture(scope="module", params=["ur5", "tree"])
def model(request):
    return urdf.load("ur5") if request.param == "ur5" else mixed_tree()


@pytest.fixture(scope="module")
def state(model):
    rng = np.random.default_rng(5)
    q, v = model.random_state(rng)
    return q, v, rng.normal(size=q.shape)


@pytest.fixture(scope="module")
def there(model, state):
    """MuJoCo's model and data at the state, joints in our order."""
    tested = MujocoModel(model)
    native, data = tested._native, tested._data
    assert np.array_equal(tested._columns, np.arange(model.n_bodies))
    data.qpos[:], data.qvel[:], data.qacc[:] = state
    mujoco.mj_fwdPosition(native, data)
    mujoco.mj_fwdVelocity(native, data)
    return native, data


def assert_close(ours, theirs, bound=CLOSE):
    assert np.abs(ours - theirs).max() <= bound * np.abs(ours).max()


def matrices(native, count=2):
    return [np.zeros((3, native.nv)) for _ in range(count)]


def test_frame_jacobian(model, state, there):
    """Of all bodies together: the derivative for the first one may be zero."""
    q, v, _ = state
    native, data = there
    jacobians, changes = [], []
    for k in range(model.n_bodies):
        number = native.body(f"body_{k}").id
        jacobian, change = matrices(native), matrices(native)
        mujoco.mj_jac(native, data, *jacobian, data.xpos[number], number)
        mujoco.mj_jacDot(native, data, *change, data.xpos[number], number)
        jacobians.append(np.concatenate(jacobian))
        changes.append(np.concatenate(change))
    aligned = {"reference": "local_world_aligned"}
    names = [body.name for body in model.bodies]
    assert_close(np.array([frame_jacobian(model, q, name, **aligned) for name in names]), np.array(jacobians))
    ours = np.array([frame_jacobian_derivative(model, q, v, name, **aligned) for name in names])
    assert_close(ours, np.array(changes))


def test_momentum(model, state, there):
    q, v, _ = state
    native, data = there
    mass = sum(body.mass for body in model.bodies)
    mujoco.mj_subtreeVel(native, data)
    assert_close(center_of_mass(model, q), data.subtree_com[0])
    assert_close(center_of_mass_velocity(model, q, v), data.subtree_linvel[0])
    about_center = np.concatenate([mass * data.subtree_linvel[0], data.subtree_angmom[0]])
    assert_close(momentum(model, q, v).about_center_of_mass, about_center)
    linear, angular = matrices(native)
    mujoco.mj_jacSubtreeCom(native, data, linear, 0)
    mujoco.mj_angmomMat(native, data, angular, 0)
    assert_close(center_of_mass_jacobian(model, q), linear)
    assert_close(centroidal_map(model, q), np.concatenate([mass * linear, angular]))


def test_energies(model, state, there):
    q, v, _ = state
    native, data = there
    mujoco.mj_energyPos(native, data)
    mujoco.mj_energyVel(native, data)
    assert_close(potential_energy(model, q), data.energy[0])
    assert_close(kinetic_energy(model, q, v), data.energy[1])


def test_derivatives_of_inverse_dynamics(model, state, there):
    """MuJoCo's are differences, and hold the torques in columns."""
    native, data = there
    by_q, by_v, by_a = (np.zeros((native.nv, native.nv)) for _ in range(3))
    data.qacc[:] = state[2]
    mujoco.mjd_inverseFD(native, data, STEP, 0, by_q, by_v, by_a, None, None, None, None)
    ours = inverse_dynamics_derivatives(model, *state)
    for here, differences in ((ours.dtau_dq, by_q), (ours.dtau_dv, by_v), (ours.dtau_da, by_a)):
        assert_close(here, differences.T, DIFFERENCES)
