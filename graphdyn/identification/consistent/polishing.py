"""Newton steps from the answer of a cone solver to the last digits, and a bound on what is left.

The steps are for bodies that are off their margin. There the cost f(u) = ‖A u - b‖² + strength · d(u) is smooth, and
the inequalities that hold with equality are known: those whose multiplier exceeds their slack. Newton's method on the
optimality conditions of the rest,

    ∇f(u) = Gᵀλ,  G u = h  (active rows),

doubles the digits in every step. If it would leave the margin, it changes nothing.

The bound on the distance of a cost from its minimum follows from convexity alone, whatever the solver. For a convex f,
bodies S_i ⪰ margin · E, rows G u ≥ h and any multipliers λ ≥ 0,
    f(u) - f(u*) ≤ (∇f - Gᵀλ)·(u - u*) + λ·(G u - h).
Let Z_i be the part of the slope ∇f - Gᵀλ that belongs to S_i. A body contributes ⟨Z_i, S_i - S_i*⟩, which is at most
⟨Z_i, S_i - margin · E⟩ if Z_i ⪰ 0. The negative part of Z_i, and the slope of the further columns, are multiplied by
the size of u itself, as if u* were no larger.

There are two distances d of physically consistent bodies, whose P are the positive definite 4×4 matrices, from a prior:

    entropic    d = tr(P₀⁻¹ P) - log det(P₀⁻¹ P) - 4        Bregman divergence of -log det
    pullback    d = ½ tr((P₀⁻¹ (P - P₀))²)                  its second-order part at P₀, a quadratic form in P

Both are ≥ 0, vanish at P₀ alone, and are invariant to changes of link frame or units: P → G P Gᵀ, P₀ → G P₀ Gᵀ.

Lee, Wensing and Park, "Geometric robot dynamic identification: a convex programming approach", IEEE Transactions on
Robotics 36(2), 2020, Eq. (22) and (26); Lee and Park, "A geometric algorithm for robust multibody inertial parameter
identification", IEEE Robotics and Automation Letters 3(3), 2018.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS, PriorCoordinates
from graphdyn.layout import BODY_PARAMETERS, Array

Metric = Literal["entropic", "pullback"]

FURTHER_COLUMN_WEIGHT = 1e-6
"""Weight of the squares of the further columns relative to the distance of the bodies: if the data cannot distinguish
friction or a rotor from a link, the link stays at its prior."""

MAX_NEWTON_STEPS = 20

MAX_ACTIVE_SETS = 20
"""Largest number of sets of active rows that are tried."""

NEWTON_TOLERANCE = 1e-12
"""Size of a step, relative to u, at which Newton's method stops."""

MIN_STEP_SHARE = 1e-3
"""Smallest fraction to which steps are halved if they would leave the margin."""


@dataclass(frozen=True, eq=False)
class Cost:
    """f(u) = ‖A u - b‖² + strength · d(u), its gradient and its Hessian.

    d: distance of the bodies, and the weak squares of the further columns
    """

    coordinates: PriorCoordinates
    metric: Metric
    strength: float

    def value(self, u: Array) -> float:
        c = self.coordinates
        # in the coordinates of the prior, each of its bodies is E; u: ten entries of each S, then further columns
        distance = entropic_divergence if self.metric == "entropic" else pullback_distance
        bodies = distance(c.symmetric(u), np.eye(4)).sum() + FURTHER_COLUMN_WEIGHT / 2 * np.sum(u[c.width :] ** 2)
        return float(np.sum((c.matrix @ u - c.right) ** 2) + self.strength * bodies)

    def gradient(self, u: Array) -> Array:
        c, width = self.coordinates, self.coordinates.width
        s, unit = c.symmetric(u), np.eye(4)
        # ∂/∂S of tr S - log det S is E - S⁻¹, of ½ ‖S - E‖² it is S - E; then the chain rule with S = Σ B_k s_k
        distance = unit - np.linalg.inv(s) if self.metric == "entropic" else s - unit
        slope = 2 * c.matrix.T @ (c.matrix @ u - c.right)
        slope[:width] += self.strength * np.einsum("ijk,nij->nk", SYMMETRIC_BASIS, distance).reshape(-1)
        slope[width:] += self.strength * FURTHER_COLUMN_WEIGHT * u[width:]
        return slope

    def hessian(self, u: Array) -> Array:
        c, width = self.coordinates, self.coordinates.width
        h = 2 * c.matrix.T @ c.matrix
        h[range(width, len(h)), range(width, len(h))] += self.strength * FURTHER_COLUMN_WEIGHT
        for i, s in enumerate(c.symmetric(u)):
            block = slice(BODY_PARAMETERS * i, BODY_PARAMETERS * (i + 1))
            if self.metric == "entropic":
                # ∂²(-log det S)/∂s_k ∂s_l = tr(S⁻¹ B_k S⁻¹ B_l)
                turned = np.einsum("ij,jak->iak", np.linalg.inv(s), SYMMETRIC_BASIS)
                h[block, block] += self.strength * np.einsum("iak,ail->kl", turned, turned)
            else:
                h[block, block] += self.strength * np.eye(BODY_PARAMETERS)
        return h


def polished(
    cost: Cost, u: Array, multipliers: Array, inequalities: tuple[Array, Array], margin: float
) -> tuple[Array, Array]:
    """u and the multipliers of G u ≥ h after Newton's method; unchanged if it does not converge off the margin.

    Active rows with a negative multiplier are released, violated rows are made active.
    """
    g, h = inequalities
    # complementary slackness: of a pair, the larger one is the one that does not vanish
    held = multipliers > g @ u - h
    x = u
    for _ in range(MAX_ACTIVE_SETS):
        found = _newton(cost, x, g[held], h[held], margin)
        if found is None:
            return u, multipliers
        x, slopes = found[0], np.zeros(len(h))
        slopes[held] = found[1]
        # rounding of G x is relative to the size of its terms
        violated = ~held & (g @ x - h < -NEWTON_TOLERANCE * (1 + np.abs(g) @ np.abs(x)))
        if not violated.any() and np.all(slopes >= 0):
            return x, slopes
        held = (held & (slopes >= 0)) | violated
    return u, multipliers


def _newton(cost: Cost, x: Array, rows: Array, right: Array, margin: float) -> tuple[Array, Array] | None:
    """The minimum of the cost on rows x = right, and the multipliers; None if it is not found off the margin."""
    corner = np.zeros((len(rows), len(rows)))
    for _ in range(MAX_NEWTON_STEPS):
        # ∇f + ∇²f step = Gᵀλ and G (x + step) = h
        system = np.block([[cost.hessian(x), -rows.T], [rows, corner]])
        try:
            answer = np.linalg.solve(system, np.concatenate([-cost.gradient(x), right - rows @ x]))
        except np.linalg.LinAlgError:
            return None
        step, part = answer[: len(x)], 1.0
        # log det ends at the margin: shorter steps stay where the cost is smooth
        while not np.all(cost.coordinates.smallest_eigenvalues(x + part * step) > margin):
            part /= 2
            if part < MIN_STEP_SHARE:
                return None
        x = x + part * step
        if np.linalg.norm(step) <= NEWTON_TOLERANCE * np.linalg.norm(x):
            break
    return x, answer[len(x) :]


def suboptimality(cost: Cost, u: Array, rows: Array, right: Array, multipliers: Array, margin: float) -> float:
    """Bound on f(u) - f(u*); rows: G (m, p), right: h (m,), multipliers: λ ≥ 0 (m,)."""
    c, unit = cost.coordinates, np.eye(4)
    s, slope = c.symmetric(u), cost.gradient(u) - rows.T @ multipliers
    z = np.einsum("ijk,nk->nij", SYMMETRIC_BASIS, slope[: c.width].reshape(-1, BODY_PARAMETERS))
    slack = np.abs(np.sum(z * (s - margin * unit), axis=(1, 2)))
    lacking = np.maximum(0.0, -np.linalg.eigvalsh(z)[:, 0]) * np.trace(s, axis1=1, axis2=2)
    further = np.abs(slope[c.width :] * u[c.width :])
    return float(slack.sum() + lacking.sum() + further.sum() + abs(multipliers @ (rows @ u - right)))


def entropic_divergence(matrix: Array, prior: Array) -> Array:
    """tr(P₀⁻¹ P) - log det(P₀⁻¹ P) - 4 of positive definite P, P₀ (…, 4, 4); infinite if P is not positive definite."""
    excess = np.linalg.eigvals(np.linalg.solve(prior, matrix)).real - 1.0
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(excess.min(axis=-1) > -1, np.sum(excess - np.log1p(excess), axis=-1), np.inf)


def pullback_distance(matrix: Array, prior: Array) -> Array:
    """½ tr((P₀⁻¹ (P - P₀))²) (…,) of symmetric P and positive definite P₀ (…, 4, 4)."""
    relative = np.linalg.solve(prior, matrix - prior)
    squared: Array = np.trace(relative @ relative, axis1=-2, axis2=-1) / 2
    return squared
