"""The joints as equations: φ = 0 (in vertices), its Jacobian φ_q and the right side ζ of φ_q q̈ = ζ (Eq. 105-109).

The Jacobian is taken with respect to the twist (ṙ, ω), regular in every pose.
"""

import numpy as np

from graphdyn.arguments.base_motion import Ground
from graphdyn.equations.kinematics import MaximalState
from graphdyn.equations.system.unconstrained import actuator_terms
from graphdyn.equations.vertices import JointVectors, Vertices, joint_vectors
from graphdyn.layout import ANGULAR, JOINT_CONSTRAINTS, LINEAR, Array, body_rows, joint_rows
from graphdyn.model.spatial import apply, cross


def constraints(state: MaximalState) -> tuple[Array, Array]:
    """φ_q (…, 5n, 6n) and ζ (…, 5n), Eq. (107), (109).

    With A q̈ - B + φ_qᵀλ = 0 the multipliers λ_j are the reaction of the inside body on body j at O_j.
    """
    model, vertices = state.model, state.vertices
    n, batch = model.n_bodies, state.position.shape[:-2]
    phi_q = np.zeros((*batch, JOINT_CONSTRAINTS * n, 6 * n), dtype=state.position.dtype)
    zeta = np.zeros((*batch, JOINT_CONSTRAINTS * n), dtype=state.velocity.dtype)
    for j, joint in enumerate(model.joints, start=1):
        i = joint.inside
        vectors = joint_vectors(model, vertices, j)
        omega_i, omega_j = vertices.angular_velocity[..., i, :], vertices.angular_velocity[..., j, :]
        if i == 0:
            zeta[..., joint_rows(j)] -= _prescribed(vectors, state.ground)
        for body, sign in ((i, 1.0), (j, -1.0)):
            if body == 0:
                continue
            block = phi_q[..., joint_rows(j), body_rows(body)]
            block[..., : vectors.held.shape[-2], LINEAR] = sign * vectors.held
            block[..., ANGULAR] = sign * _turning(joint_vectors(model, vertices, j, axes=body), of_inside=body == i)
        zeta[..., joint_rows(j)] -= np.concatenate(
            [_gap_curvature(vectors, vertices, i, j), _angle_curvature(vectors, omega_i, omega_j)], axis=-1
        )
    return phi_q, zeta


def coupling_rows(state: MaximalState) -> Array:
    """φ_q (…, n_couplings, 6n) of q_driven - Σ ratio q = offset, the driven joint negative as body j is in Eq. (65).

    Times body velocities: Σ ratio v less the rate of the driven joint, all relative to the inside bodies. Their
    multipliers are then what the couplings supply to the joints that they drive [N m or N].
    """
    rows: Array = -state.model.degrees_of_freedom.rows @ np.swapaxes(actuator_terms(state), -1, -2)
    return rows


def _turning(vectors: JointVectors, of_inside: bool) -> Array:
    """What φ̇ gains by ω_i, or by -ω_j (…, 5, 3), in the axes of the vectors. A body is seen in its own: the moment of a
    force along c_ij vanishes exactly there, and does not shake a light wrist.

    d(u·gap)/dt = u·(ṙ_i + ω_i × c_ij - ṙ_j - ω_j × c_jj) + (ω_i × u)·gap; d(a·b)/dt = (ω_i - ω_j)·(a × b).
    """
    arm = vectors.arm_i if of_inside else vectors.arm_j
    if of_inside and vectors.held_turns:
        arm = arm - vectors.gap
    return np.concatenate([cross(arm[..., None, :], vectors.held), cross(vectors.inside, vectors.outside)], axis=-2)


def _prescribed(vectors: JointVectors, ground: Ground | None) -> Array:
    """The part of φ̈ that the prescribed acceleration of the ground gives (…, 5): ∂²φ/∂t² on the right of Eq. (108)."""
    assert ground is not None
    part = apply(_turning(vectors, of_inside=True), ground.acceleration[..., ANGULAR])
    part[..., : vectors.held.shape[-2]] += apply(vectors.held, ground.acceleration[..., LINEAR])
    return part


def _gap_curvature(vectors: JointVectors, vertices: Vertices, i: int, j: int) -> Array:
    """d²(u·gap)/dt² at q̈ = 0: ü·gap + 2 u̇·ġap + u·g̈ap (…, k)."""
    omega_i, omega_j = vertices.angular_velocity[..., i, :], vertices.angular_velocity[..., j, :]
    spin_i, spin_j = cross(omega_i, vectors.arm_i), cross(omega_j, vectors.arm_j)
    gap_acceleration = cross(omega_i, spin_i) - cross(omega_j, spin_j)
    curvature: Array = np.einsum("...ka,...a->...k", vectors.held, gap_acceleration)
    if vectors.held_turns:
        gap_rate = vertices.velocity[..., i, :] + spin_i - vertices.velocity[..., j, :] - spin_j
        u_dot = cross(omega_i[..., None, :], vectors.held)
        u_ddot = cross(omega_i[..., None, :], u_dot)
        curvature = curvature + np.einsum("...ka,...a->...k", u_ddot, vectors.gap)
        curvature = curvature + 2 * np.einsum("...ka,...a->...k", u_dot, gap_rate)
    return curvature


def _angle_curvature(vectors: JointVectors, omega_i: Array, omega_j: Array) -> Array:
    """d²(a·b)/dt² at q̈ = 0: (ω_i - ω_j)·(ȧ × b + a × ḃ) (…, 5-k)."""
    a, b = vectors.inside, vectors.outside
    a_dot = cross(omega_i[..., None, :], a)
    b_dot = cross(omega_j[..., None, :], b)
    curvature: Array = np.einsum("...a,...ka->...k", omega_i - omega_j, cross(a_dot, b) + cross(a, b_dot))
    return curvature
