"""The velocity torques c(q, v) as the sums that codes compute, so that a wrong factor on one term can be found.

As a whole, and in three decompositions: spatial vectors, Lagrange, and squares and products of joint velocities. That
of Newton and Euler is in the recursion itself (crosscheck.judging.faults.recursion).
"""

from __future__ import annotations

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from graphdyn import MaximalState, RobotModel, maximal_state
from graphdyn.equations import null_space
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model import apply, cross

Terms = dict[str, Array]
"""Torques (N, n) by the name of the term; their sum is c."""


def velocity_terms(model: RobotModel, q: Array, v: Array) -> tuple[Terms, ...]:
    """c(q, v) as a whole, and in three decompositions; q, v: (N, n)."""
    whole = _velocity_torque(model, q, v)
    return {"all velocity terms": whole}, _spatial(model, q, v, whole), *_christoffel(model, q, v)


def _velocity_torque(model: RobotModel, q: Array, v: Array) -> Array:
    weightless = DynamicsCode.of(model).but(gravity=np.zeros(3))
    (torque,) = torques_of([weightless], (q, v, np.zeros_like(v)))
    return torque  # type: ignore[no-any-return]


def _spatial(model: RobotModel, q: Array, v: Array, whole: Array) -> Terms:
    """v ×* I v of every body, v its twist at the link origin, and the rest, from v × S q̇ in the accelerations."""
    state = maximal_state(model, q, v)
    omega = state.velocity[..., ANGULAR]
    center, masses = np.stack([body.center_of_mass for body in model.bodies]), _masses(model)
    at_center = np.einsum("...iba,...ib->...ia", state.rotation, state.velocity[..., LINEAR])
    at_origin = at_center - cross(omega, center)
    momentum = masses * at_center
    tensors = np.stack([body.inertia for body in model.bodies])
    spin = np.einsum("iab,...ib->...ia", tensors, omega) + cross(center, momentum)  # about the link origin
    force = cross(omega, momentum)
    moment = cross(omega, spin) + cross(at_origin, momentum) - cross(center, force)  # about the center
    bias = _project(state, _in_world(state, force), moment)
    return {"the bias wrenches v ×* I v": bias, "the terms v × S q̇ in the accelerations": whole - bias}


def _christoffel(model: RobotModel, q: Array, v: Array) -> tuple[Terms, Terms]:
    """Ṁ v and the gradient of the kinetic energy; squares and products of the joint velocities.

    c_i = Σ Γ_ijk v_j v_k, from c at unit velocities and their sums: exact, since c is quadratic.
    """
    n = model.n_bodies
    unit = np.eye(n)
    pairs = (unit[:, None] + unit[None, :]).reshape(-1, n)
    repeated = np.repeat(q, n * n, axis=0)
    sums = _velocity_torque(model, repeated, np.tile(pairs, (len(q), 1))).reshape(len(q), n, n, n)
    singles = np.einsum("sjji->sji", sums) / 4  # c(2 e_j) = 4 c(e_j)
    symbols = np.moveaxis((sums - singles[:, :, None] - singles[:, None, :]) / 2, -1, 1)  # (N, i, j, k)
    whole = np.einsum("sijk,sj,sk->si", symbols, v, v)
    gradient = np.einsum("sjik,sj,sk->si", symbols, v, v)
    squares = np.einsum("sijj,sj->si", symbols, v**2)
    return (
        {"the term Ṁ v": whole + gradient, "the gradient of the kinetic energy, -½ ∂(vᵀ M v)/∂q": -gradient},
        {"the squares v_j²": squares, "the products v_j v_k": whole - squares},
    )


def _project(state: MaximalState, force: Array, moment: Array) -> Array:
    """Nᵀ of forces at the centers of mass in world axes and moments in body axes: torques (N, n)."""
    wrench = np.concatenate([force, moment], axis=-1)
    return apply(np.swapaxes(null_space(state), -1, -2), wrench.reshape(len(wrench), -1))


def _in_world(state: MaximalState, x: Array) -> Array:
    world: Array = np.einsum("...iab,...ib->...ia", state.rotation, x)
    return world


def _masses(model: RobotModel) -> Array:
    return np.array([body.mass for body in model.bodies])[:, None]
