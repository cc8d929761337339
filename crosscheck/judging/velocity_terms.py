"""The velocity torques c(q, v) as the sums that codes compute, so that a wrong factor on one term can be found.

Four decompositions: classical Newton-Euler, spatial vectors, Lagrange, and squares and products of joint velocities.
"""

from __future__ import annotations

import numpy as np

from crosscheck.judging.experiments import TrialStates, torques
from graphdyn import MaximalState, RobotModel, maximal_state
from graphdyn._kinematics import bias_acceleration, joint_axes, link_origins, null_space
from graphdyn._linear import apply, cross
from graphdyn.layout import ANGULAR, LINEAR, Array

Terms = dict[str, Array]
"""Torques (N, n) by the name of the term; their sum is c."""


def velocity_terms(model: RobotModel, trial: TrialStates) -> tuple[Terms, ...]:
    """c(q, v) as a whole, and in four decompositions."""
    whole = _velocity_torque(model, trial.q, trial.v)
    return (
        {"all velocity terms": whole},
        _newton_euler(model, trial),
        _spatial(model, trial, whole),
        *_christoffel(model, trial),
    )


def _velocity_torque(model: RobotModel, q: Array, v: Array) -> Array:
    own = torques(model.with_gravity(np.zeros(3)))
    return own(q, v, np.zeros_like(v))


def _newton_euler(model: RobotModel, trial: TrialStates) -> Terms:
    """ω × (ω × r), ω × q̇ p in ω̇, ω × I ω, and 2 ω × ṡ of sliding joints: r̈ summed along the path to each body."""
    state = maximal_state(model, trial.q, trial.v)
    omega, alpha = (
        _in_world(state, x[..., ANGULAR]) for x in (state.velocity, bias_acceleration(model, trial.q, trial.v))
    )
    origins, axes = link_origins(state), joint_axes(state)
    at_origin = {name: np.zeros_like(origins) for name in ("centripetal", "angular", "sliding")}
    for k, joint in enumerate(model.joints):
        inside = joint.inside - 1
        if inside < 0:
            continue
        arm = origins[:, k] - origins[:, inside]
        turning, sliding = omega[:, inside], trial.v[:, k, None] * axes[:, k] * joint.is_prismatic
        at_origin["centripetal"][:, k] = at_origin["centripetal"][:, inside] + cross(turning, cross(turning, arm))
        at_origin["angular"][:, k] = at_origin["angular"][:, inside] + cross(alpha[:, inside], arm)
        at_origin["sliding"][:, k] = at_origin["sliding"][:, inside] + 2 * cross(turning, sliding)
    lever = state.position - origins
    at_origin["centripetal"] += cross(omega, cross(omega, lever))
    at_origin["angular"] += cross(alpha, lever)
    tensors, masses = np.stack([body.inertia for body in model.bodies]), _masses(model)
    local = state.velocity[..., ANGULAR]
    gyroscopic = cross(local, np.einsum("iab,...ib->...ia", tensors, local))
    local_alpha = np.einsum("...iba,...ib->...ia", state.rotation, alpha)
    zero = np.zeros_like(origins)
    return {
        "the centripetal accelerations ω × (ω × r)": _project(state, masses * at_origin["centripetal"], zero),
        "the terms ω × q̇ p in the angular accelerations": _project(
            state, masses * at_origin["angular"], np.einsum("iab,...ib->...ia", tensors, local_alpha)
        ),
        "the gyroscopic moments ω × I ω": _project(state, zero, gyroscopic),
        "the Coriolis accelerations 2 ω × ṡ of sliding joints": _project(state, masses * at_origin["sliding"], zero),
    }


def _spatial(model: RobotModel, trial: TrialStates, whole: Array) -> Terms:
    """v ×* I v of every body, v its twist at the link origin, and the rest, from v × S q̇ in the accelerations."""
    state = maximal_state(model, trial.q, trial.v)
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


def _christoffel(model: RobotModel, trial: TrialStates) -> tuple[Terms, Terms]:
    """Ṁ v and the gradient of the kinetic energy; squares and products of the joint velocities.

    c_i = Σ Γ_ijk v_j v_k, from c at unit velocities and their sums: exact, since c is quadratic.
    """
    n, v = model.n_bodies, trial.v
    unit = np.eye(n)
    pairs = (unit[:, None] + unit[None, :]).reshape(-1, n)
    q = np.repeat(trial.q, n * n, axis=0)
    sums = _velocity_torque(model, q, np.tile(pairs, (len(trial.q), 1))).reshape(len(trial.q), n, n, n)
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
