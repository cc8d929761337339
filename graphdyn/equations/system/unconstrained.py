"""The bodies without their joints: A q̈ = B (paper, section 2.2), in the twist form q̈ = (r̈, ω̇).

Rotational rows are moments in body axes, so that A is symmetric (docs/deviations.md, A1).
"""

import numpy as np

from graphdyn.equations.kinematics import MaximalState
from graphdyn.layout import ANGULAR, LINEAR, Array, block_diagonal, stacked, stacked_rows
from graphdyn.model.spatial import apply, cross


def mass_blocks(state: MaximalState) -> Array:
    """A_i = diag(m_i E, J_i) of every body (n, 6, 6), Eq. (37) in twist form. Constant: the same in every state."""
    bodies = state.model.bodies
    blocks = np.zeros((len(bodies), 6, 6))
    for block, body in zip(blocks, bodies, strict=True):
        block[LINEAR, LINEAR] = body.mass * np.eye(3)
        block[ANGULAR, ANGULAR] = body.inertia
    return blocks


def mass_terms(state: MaximalState) -> Array:
    """A (6n, 6n), Eq. (39)."""
    return block_diagonal(mass_blocks(state))


def passive_terms(state: MaximalState, external_wrenches: Array) -> Array:
    """B without the actuators (…, n, 6): gravity, gyroscopic moment and external wrenches. Eq. (24)-(25), (30).

    external_wrenches: force and moment on each body, at O_j, in link axes of the body   (…, n, 6)  [N, N m]
    """
    model = state.model
    mass = np.array([body.mass for body in model.bodies])
    inertia = np.stack([body.inertia for body in model.bodies])
    centers = np.stack([body.center_of_mass for body in model.bodies])
    omega = state.velocity[..., ANGULAR]
    force, moment = external_wrenches[..., LINEAR], external_wrenches[..., ANGULAR]
    shape = np.broadcast_shapes(state.velocity.shape, external_wrenches.shape)
    b = np.empty(shape, dtype=state.velocity.dtype)
    b[..., LINEAR] = mass[:, None] * model.gravity + np.einsum("...iab,...ib->...ia", state.rotation, force)
    momentum = np.einsum("iab,...ib->...ia", inertia, omega)
    b[..., ANGULAR] = -cross(omega, momentum) + moment - cross(centers, force)  # moved to the center of mass
    return b


def actuator_terms(state: MaximalState) -> Array:
    """E (…, 6n, n) with B = passive terms + E τ: the joint force elements of the graph.

    A revolute actuator is a moment M^a_k = τ_k p_k, a prismatic one a force F^e_k = τ_k p_k at the joint; the
    resultants are F^ê = -S^e F^e (Eq. 14), M^ê = -Σ C^e × F^e (Eq. 19) and M^â = -S M^a (Eq. 26).
    """
    model, vertices = state.model, state.vertices
    s = model.graph.incidence()
    n = model.n_bodies
    columns = np.zeros((*state.position.shape[:-1], 6, n), dtype=state.position.dtype)
    for k, joint in enumerate(model.joints, start=1):
        axis = vertices.from_link(k, joint.axis[None])
        for i, point in ((joint.inside, joint.placement.translation), (k, np.zeros(3))):
            if i == 0:
                continue
            sign = -s[i - 1, k - 1]
            on_body = joint.axis if i == k else vertices.to_link(i, axis)[..., 0, :]
            if joint.is_prismatic:
                columns[..., i - 1, LINEAR, k - 1] = sign * axis[..., 0, :]
                on_body = cross(point - vertices.center[i], on_body)
            columns[..., i - 1, ANGULAR, k - 1] = sign * on_body
    return stacked_rows(columns)


def applied_terms(state: MaximalState, tau: Array, external_wrenches: Array) -> Array:
    """B (…, 6n), Eq. (37)-(39): passive terms and actuators."""
    actuators = actuator_terms(state)
    if state.model.couplings:
        actuators = actuators[..., list(state.model.degrees_of_freedom.independent)]
    return stacked(passive_terms(state, external_wrenches)) + apply(actuators, tau)
