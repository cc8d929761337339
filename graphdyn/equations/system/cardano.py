"""The system as the paper writes it, in q = (r, θ) with Cardano angles: a view of the twist form.

With ω = D θ̇ (Eq. 33) and ω̇ = D θ̈ + Ḋ θ̇: rotational rows times Dᵀ, columns times D (docs/deviations.md, A1, A3).
"""

import numpy as np

from graphdyn.equations.kinematics import MaximalState
from graphdyn.equations.system.kkt import KKTSystem
from graphdyn.errors import GimbalLock
from graphdyn.layout import ANGULAR, LINEAR, Array, block_diagonal, stacked
from graphdyn.model.spatial import apply, cardano_rate_matrix, cardano_rate_matrix_derivative, cos_beta

MIN_BETA_COSINE = 1e-4
"""|cos β| below which Cardano coordinates are refused: the error of the solution grows as eps / cos²β or faster,
to 3e-7 at 1e-4 (`graphdyn errata` measures it)."""


def cardano_system(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """Eq. (111) in (r̈, θ̈) from the twist form of the same state. Raises GimbalLock, naming the body."""
    cosines = cos_beta(state.rotation)
    if np.any(cosines < MIN_BETA_COSINE):
        body = int(np.argmin(cosines)) % state.model.n_bodies
        raise GimbalLock(
            f"body '{state.model.body_names[body]}' is at |cos β| = {cosines.min():.1e}, below {MIN_BETA_COSINE:g}: "
            "the Cardano angles do not determine its motion there; use coordinates='twist', regular in every pose"
        )
    return cardano_form(state, twist)


def cardano_form(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """As cardano_system, at any |cos β| > 0: for showing what happens near gimbal lock."""
    to_twist, drift = rate_map(state), cardano_drift(state)
    transposed = np.swapaxes(to_twist, -1, -2)
    return KKTSystem(
        mass=transposed @ twist.mass @ to_twist,
        constraint_jacobian=twist.constraint_jacobian @ to_twist,
        force=apply(transposed, twist.force - apply(twist.mass, drift)),
        zeta=twist.zeta - apply(twist.constraint_jacobian, drift),
        coordinates="cardano",
        n_chord_rows=twist.n_chord_rows,
    )


def rate_map(state: MaximalState) -> Array:
    """T = diag(E, D_1, …, E, D_n) (…, 6n, 6n): from (ṙ, θ̇) to (ṙ, ω), Eq. (33)."""
    blocks = np.zeros((*state.velocity.shape, 6))
    blocks[..., LINEAR, LINEAR] = np.eye(3)
    blocks[..., ANGULAR, ANGULAR] = cardano_rate_matrix(state.cardano)
    return block_diagonal(blocks)


def cardano_drift(state: MaximalState) -> Array:
    """Ṫ (ṙ, θ̇) (…, 6n): (r̈, ω̇) = T (r̈, θ̈) + this; its angular parts are Ḋ θ̇, Eq. (34)."""
    rates = state.cardano_rates
    drift = np.zeros_like(state.velocity)
    drift[..., ANGULAR] = apply(cardano_rate_matrix_derivative(state.cardano, rates), rates)
    return stacked(drift)
