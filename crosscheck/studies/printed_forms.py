"""Forms of the equations as the paper prints them where they are wrong (docs/deviations.md). Revolute joints only.

Each takes the correct system and puts one error back; only `crosscheck.studies.errata` uses them.
"""

import numpy as np

from graphdyn import MaximalState
from graphdyn._cardano import cardano_drift, cardano_form, rate_map
from graphdyn._constraints import constraints
from graphdyn._kkt import KKTSystem
from graphdyn._linear import apply
from graphdyn._rotation import skew
from graphdyn.layout import ANGULAR, Array, body_rows, joint_rows, stacked


def without_d_transposed(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """A1: Eq. (111) with A and B of Eq. (37), whose rotational rows are moments, beside φ_qᵀλ conjugate to θ."""
    form = cardano_form(state, twist)
    return KKTSystem(
        mass=twist.mass @ rate_map(state),
        constraint_jacobian=form.constraint_jacobian,
        force=twist.force - apply(twist.mass, cardano_drift(state)),
        zeta=form.zeta,
    )


def with_unit_d33(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """A4: entry (3,3) of Ḋ equal to 1 in B (Eq. 34, 37), while ζ keeps the right one."""
    form = cardano_form(state, twist)
    excess = np.zeros_like(state.velocity)
    excess[..., 5] = state.cardano_rates[..., 2]  # Ḋ_33 γ̇
    moment = apply(twist.mass, stacked(excess))
    return KKTSystem(
        mass=form.mass,
        constraint_jacobian=form.constraint_jacobian,
        force=form.force - apply(np.swapaxes(rate_map(state), -1, -2), moment),
        zeta=form.zeta,
    )


def world_axis_rows(state: MaximalState) -> Array:
    """A2: φ_q (…, 5n, 6n) with the axis rows of Eq. (71), (72), world x and y components of p_i - p_j."""
    phi_q, _ = constraints(state)
    model, rotation = state.model, state.vertices.rotation
    for j, joint in enumerate(model.joints, start=1):
        axis = rotation[..., joint.inside, :, :] @ (joint.placement.rotation @ joint.axis)
        for body, sign in ((joint.inside, -1.0), (j, 1.0)):  # d(R p)/dt = ω × p = -p̃ R ω^(body)
            if body > 0:
                rows = phi_q[..., joint_rows(j), body_rows(body)]
                rows[..., 3:, ANGULAR] = (sign * skew(axis) @ rotation[..., body, :, :])[..., :2, :]
    return phi_q
