"""Chords as equations in maximal coordinates: their rows of φ_q and ζ, below those of joints and couplings.

The rows of a chord are those of a joint between its bodies: relative motions of body i to body j, so that its
multipliers are the reaction of body i on body j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.equations.kinematics import MaximalState
from graphdyn.equations.system.constraints import constraints
from graphdyn.layout import ANGULAR, BODY_DOF, JOINT_CONSTRAINTS, LINEAR, Array, body_rows
from graphdyn.model.chord import Chord
from graphdyn.model.spatial import apply, cross


@dataclass(frozen=True, eq=False)
class _End:
    """One end of a chord, in world axes.

    point: its origin on that body                          (…, 3)
    rate, curvature: ṙ and r̈ of it, at ω̇ = 0 and r̈ = 0 of the center of mass   (…, 3)
    omega: of the body                                      (…, 3)
    """

    point: Array
    rate: Array
    curvature: Array
    omega: Array


def chord_rows(state: MaximalState) -> tuple[Array, Array]:
    """Rows of φ_q (…, m, 6n) and of ζ (…, m)."""
    model, vertices, ground = state.model, state.vertices, state.ground
    assert ground is not None
    batch, number = state.position.shape[:-2], state.velocity.dtype
    rows = np.zeros((*batch, model.n_chord_rows, BODY_DOF * model.n_bodies), dtype=number)
    zeta = np.zeros((*batch, model.n_chord_rows), dtype=number)
    first = 0
    for chord in model.chords:
        own = slice(first, first := first + len(chord.rows))
        end_i, end_j = (
            _end(state, body, placement.translation)
            for body, placement in ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j))
        )
        linear, angular = _directions(state, chord, end_i, end_j)
        for body, sign in ((chord.body_i, 1.0), (chord.body_j, -1.0)):
            lever = end_j.point - vertices.position[..., body, :]
            turning = np.concatenate([cross(lever[..., None, :], linear), angular], axis=-2)
            moving = np.concatenate([linear, np.zeros_like(angular)], axis=-2)
            if body == 0:
                prescribed = apply(moving, ground.acceleration[..., LINEAR])
                zeta[..., own] -= sign * (prescribed + apply(turning, ground.acceleration[..., ANGULAR]))
                continue
            block = rows[..., own, body_rows(body)]
            block[..., LINEAR] = sign * moving
            block[..., ANGULAR] = sign * (turning @ vertices.rotation[..., body, :, :])
        zeta[..., own] -= _curvature(chord, linear, angular, end_i, end_j)
    return rows, zeta


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


def _end(state: MaximalState, body: int, translation: Array) -> _End:
    vertices = state.vertices
    arm, omega = vertices.arm(body, translation), vertices.angular_velocity[..., body, :]
    spin = cross(omega, arm)
    return _End(
        point=vertices.position[..., body, :] + arm,
        rate=vertices.velocity[..., body, :] + spin,
        curvature=cross(omega, spin),
        omega=omega,
    )


def _directions(state: MaximalState, chord: Chord, end_i: _End, end_j: _End) -> tuple[Array, Array]:
    """World directions of the linear and the angular rows (…, k, 3)."""
    if chord.kind == "distance":
        line = end_i.point - end_j.point
        unit = line / np.sqrt((line * line).sum(axis=-1, keepdims=True))
        return unit[..., None, :], unit[..., None, :][..., :0, :]
    on_i = state.vertices.rotation[..., chord.body_i, :, :] @ (chord.placement_i.rotation @ chord.triad)
    t_1, t_2, p = (on_i[..., k] for k in range(3))
    none = np.zeros((*t_1.shape[:-1], 0, 3))
    chosen: dict[str, tuple[list[Array], list[Array]]] = {
        "hinge": ([t_1, t_2, p], [t_1, t_2]),
        "ball": ([t_1, t_2, p], []),
        "slide": ([t_1, t_2], [t_1, t_2, p]),
        "weld": ([t_1, t_2, p], [t_1, t_2, p]),
    }
    linear, angular = (np.stack(axes, axis=-2) if axes else none for axes in chosen[chord.kind])
    return linear, angular


def _curvature(chord: Chord, linear: Array, angular: Array, end_i: _End, end_j: _End) -> Array:
    """φ̈ (…, rows) at q̈ = 0."""
    apart, rate = end_i.point - end_j.point, end_i.rate - end_j.rate
    curved = apply(linear, end_i.curvature - end_j.curvature)
    if chord.kind == "distance":
        across = (rate * rate).sum(axis=-1, keepdims=True) - apply(linear, rate) ** 2
        return np.asarray(curved + across / apply(linear, apart))
    omega = end_i.omega[..., None, :]
    u_dot = cross(omega, linear)
    curved = curved + 2 * apply(u_dot, rate) + apply(cross(omega, u_dot), apart)
    return np.concatenate([curved, apply(cross(omega, angular), end_i.omega - end_j.omega)], axis=-1)
