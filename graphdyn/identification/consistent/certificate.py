"""Bound on the distance of a cost from its minimum, from convexity alone, independent of the solver.

For a convex f, bodies S_i ⪰ margin · E, rows G u ≥ h and any multipliers λ ≥ 0,
    f(u) - f(u*) ≤ (∇f - Gᵀλ)·(u - u*) + λ·(G u - h).
Let Z_i be the part of the slope ∇f - Gᵀλ that belongs to S_i. A body contributes ⟨Z_i, S_i - S_i*⟩, which is at most
⟨Z_i, S_i - margin · E⟩ if Z_i ⪰ 0. The negative part of Z_i, and the slope of the further columns, are multiplied by
the size of u itself, as if u* were no larger.
"""

import numpy as np

from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS
from graphdyn.identification.consistent.polishing import Cost
from graphdyn.layout import BODY_PARAMETERS, Array


def suboptimality(cost: Cost, u: Array, rows: Array, right: Array, multipliers: Array, margin: float) -> float:
    """Bound on f(u) - f(u*); rows: G (m, p), right: h (m,), multipliers: λ ≥ 0 (m,)."""
    c, unit = cost.coordinates, np.eye(4)
    s, slope = c.symmetric(u), cost.gradient(u) - rows.T @ multipliers
    z = np.einsum("ijk,nk->nij", SYMMETRIC_BASIS, slope[: c.width].reshape(-1, BODY_PARAMETERS))
    slack = np.abs(np.sum(z * (s - margin * unit), axis=(1, 2)))
    lacking = np.maximum(0.0, -np.linalg.eigvalsh(z)[:, 0]) * np.trace(s, axis1=1, axis2=2)
    further = np.abs(slope[c.width :] * u[c.width :])
    return float(slack.sum() + lacking.sum() + further.sum() + abs(multipliers @ (rows @ u - right)))
