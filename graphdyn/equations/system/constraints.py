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
        k = vectors.held.shape[-2]
        for body, sign, turning in ((i, 1.0, _with_inside), (j, -1.0, _with_outside)):
            angular = turning(vectors, vertices, body)
            if body == 0:
                zeta[..., joint_rows(j)] -= _prescribed(vectors.held, vertices.from_link(0, angular), state.ground)
                continue
            block = phi_q[..., joint_rows(j), body_rows(body)]
            block[..., :k, LINEAR] = sign * vectors.held
            block[..., ANGULAR] = sign * angular
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


# What φ̇ gains by ω_i, and by -ω_j, in link axes:
# d(u·gap)/dt = u·(ṙ_i + ω_i × c_ij - ṙ_j - ω_j × c_jj) + (ω_i × u)·gap and d(a·b)/dt = (ω_i - ω_j)·(a × b).
# What is fixed in the body keeps the digits of the model: a force along c_jj has no moment, and the moments t_1 and t_2
# have no share along p, in which a light wrist would show their rounding.


def _with_inside(vectors: JointVectors, vertices: Vertices, i: int) -> Array:
    """(…, 5, 3), in the link axes of i."""
    arm, a = vectors.on_i[:1], vectors.on_i[1:]
    if vectors.held_turns:
        arm = arm - vertices.to_link(i, vectors.gap[..., None, :])
    turning = cross(arm, vertices.to_link(i, vectors.held)), cross(a, vertices.to_link(i, vectors.outside))
    return np.concatenate(turning, axis=-2)


def _with_outside(vectors: JointVectors, vertices: Vertices, j: int) -> Array:
    """(…, 5, 3), in the link axes of j."""
    arm, b = vectors.on_j[:1], vectors.on_j[1:]
    turning = cross(arm, vertices.to_link(j, vectors.held)), cross(vertices.to_link(j, vectors.inside), b)
    return np.concatenate(turning, axis=-2)


def _prescribed(held: Array, turning: Array, ground: Ground | None) -> Array:
    """The part of φ̈ that the prescribed acceleration of the ground gives (…, 5): ∂²φ/∂t² on the right of Eq. (108)."""
    assert ground is not None
    part = apply(turning, ground.acceleration[..., ANGULAR])
    part[..., : held.shape[-2]] += apply(held, ground.acceleration[..., LINEAR])
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
