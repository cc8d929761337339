"""Joint wrenches from the wrenches on the bodies: the path matrix read as a sum of forces.

A wrench here is force and moment in world axes, the moment about the joint O_j.
"""

import numpy as np

from graphdyn.equations.kinematics import MaximalState, joint_axes, levers
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.spatial import cross


def transmitted_wrenches(state: MaximalState, body_wrenches: Array) -> Array:
    """Wrench of the inside body on body j that balances all bodies outside joint j (…, n, 6) [N, N m].

    body_wrenches: per body what its inside and outside joints must supply, force in world axes and moment in body
    axes about the center of mass                                                           (…, n, 6)  [N, N m]
    Eq. (15) solved with T = -S⁻¹, and the same for the moments.
    """
    t = state.model.graph.path_matrix()
    force = body_wrenches[..., LINEAR]
    moment = np.einsum("...iab,...ib->...ia", state.rotation, body_wrenches[..., ANGULAR])
    at_joint = moment[..., None, :, :] + cross(levers(state), force[..., None, :, :])
    return np.concatenate([t @ force, np.einsum("ki,...kia->...ka", t, at_joint)], axis=-1)


def reaction_basis(state: MaximalState) -> Array:
    """Q (…, n, 6, 6): orthonormal columns; wrench on body j = Q_j (λ_j1 … λ_j5, τ_j).

    Revolute: forces along the world axes, moments about t_1, t_2 and p. Prismatic: forces along t_1, t_2, moments
    about t_1, t_2, p, and the force along p.
    """
    model, vertices = state.model, state.vertices
    axes = joint_axes(state)
    basis = np.zeros((*axes.shape[:-1], 6, 6), dtype=axes.dtype)
    for k, joint in enumerate(model.joints):
        in_world = vertices.rotation[..., joint.inside, :, :] @ joint.placement.rotation
        t_1, t_2 = (in_world @ t for t in joint.axis_normals)
        triad = np.stack([t_1, t_2, axes[..., k, :]], axis=-1)
        if joint.is_prismatic:
            basis[..., k, LINEAR, 0:2] = triad[..., :2]
            basis[..., k, ANGULAR, 2:5] = triad
            basis[..., k, LINEAR, 5] = triad[..., 2]
        else:
            basis[..., k, LINEAR, 0:3] = np.eye(3)
            basis[..., k, ANGULAR, 3:6] = triad
    return basis


def split_reactions(state: MaximalState, wrenches: Array) -> tuple[Array, Array]:
    """multipliers λ (…, n, 5) and actuator torques or forces τ (…, n) of world wrenches (…, n, 6)."""
    components = np.einsum("...wc,...w->...c", reaction_basis(state), wrenches)
    return components[..., :5], components[..., 5]


def join_reactions(state: MaximalState, multipliers: Array, tau: Array) -> Array:
    """World wrenches (…, n, 6) of multipliers and actuator torques: the inverse of split_reactions."""
    components = np.concatenate([multipliers, tau[..., None]], axis=-1)
    wrenches: Array = np.einsum("...wc,...c->...w", reaction_basis(state), components)
    return wrenches


def in_link_axes(state: MaximalState, wrenches: Array) -> Array:
    """World wrenches (…, n, 6) at O_j in the link axes of body j (Pinocchio's data.f)."""
    return np.concatenate(
        [np.einsum("...iba,...ib->...ia", state.rotation, wrenches[..., part]) for part in (LINEAR, ANGULAR)], axis=-1
    )
