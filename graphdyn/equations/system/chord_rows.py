"""Chords as equations in maximal coordinates: their rows of φ_q and ζ, below those of joints and couplings.

The rows of a chord are those of a joint between its bodies: relative motions of body i to body j, so that its
multipliers are the reaction of body i on body j.
"""

from __future__ import annotations

import numpy as np

from graphdyn.equations.kinematics import MaximalState, joint_axes
from graphdyn.equations.system.constraints import constraints
from graphdyn.layout import ANGULAR, BODY_DOF, JOINT_CONSTRAINTS, LINEAR, Array, body_rows
from graphdyn.model.loops import Links
from graphdyn.model.spatial import apply, cross


def chord_rows(state: MaximalState) -> tuple[Array, Array]:
    """Rows of φ_q (…, m, 6n) and of ζ (…, m)."""
    model, vertices, ground = state.model, state.vertices, state.ground
    assert ground is not None
    batch, number = state.position.shape[:-2], state.velocity.dtype
    rows = np.zeros((*batch, model.n_chord_rows, BODY_DOF * model.n_bodies), dtype=number)
    zeta = np.zeros((*batch, model.n_chord_rows), dtype=number)
    first = 0
    links = _link_motions(state)
    for end in model.loops.ends(links):
        chord = end.chord
        own = slice(first, first := first + len(chord.rows))
        linear, angular = end.directions[..., : end.n_linear, :], end.directions[..., end.n_linear :, :]
        for body, sign in ((chord.body_i, 1.0), (chord.body_j, -1.0)):
            lever = end.point_j - vertices.position[..., body, :]
            turning = np.concatenate([cross(lever[..., None, :], linear), angular], axis=-2)
            moving = np.concatenate([linear, np.zeros_like(angular)], axis=-2)
            if body == 0:
                prescribed = apply(moving, ground.acceleration[..., LINEAR])
                zeta[..., own] -= sign * (prescribed + apply(turning, ground.acceleration[..., ANGULAR]))
                continue
            block = rows[..., own, body_rows(body)]
            block[..., LINEAR] = sign * moving
            block[..., ANGULAR] = sign * (turning @ vertices.rotation[..., body, :, :])
    return rows, zeta + model.loops.bias(links)


def pin_rows(state: MaximalState) -> tuple[Array, Array]:
    """φ_q and ζ of the joints (system.constraints) with forces along t_1, t_2, p instead of the world's axes.

    Which reactions loops determine shows along the axes of the pins only.
    """
    model, vertices = state.model, state.vertices
    phi_q, zeta = constraints(state)
    phi_q, zeta = phi_q.copy(), zeta.copy()
    for j, joint in enumerate(model.joints, start=1):
        if joint.is_prismatic:
            continue
        in_world = vertices.rotation[..., joint.inside, :, :] @ joint.placement.rotation
        to_pin = np.stack([in_world @ axis for axis in (*joint.axis_normals, joint.axis)], axis=-2)
        own = slice(JOINT_CONSTRAINTS * (j - 1), JOINT_CONSTRAINTS * (j - 1) + 3)
        phi_q[..., own, :] = to_pin @ phi_q[..., own, :]
        zeta[..., own] = apply(to_pin, zeta[..., own])
    return phi_q, zeta


def _link_motions(state: MaximalState) -> Links:
    """The link frames in the world, with their accelerations at q̈ = 0: what rotation about centers of mass leaves."""
    vertices = state.vertices
    arm = -np.einsum("...iab,ib->...ia", vertices.rotation, vertices.center)
    spin = cross(vertices.angular_velocity, arm)
    return Links(
        rotation=vertices.rotation,
        origin=vertices.position + arm,
        axis=joint_axes(state),
        linear=vertices.velocity + spin,
        angular=vertices.angular_velocity,
        linear_drift=cross(vertices.angular_velocity, spin),
        angular_drift=np.zeros_like(spin),
    )
