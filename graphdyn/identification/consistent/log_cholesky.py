"""Log-Cholesky coordinates of an inertia: ten unbounded numbers, each choice of them a physically consistent body.

    P = U Uᵀ,   U = e^α [e^d₁ s₁₂ s₁₃ t₁; 0 e^d₂ s₂₃ t₂; 0 0 e^d₃ t₃; 0 0 0 1]
    θ = (α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃)

α, d scale the body, s shear it, t moves its center of mass, from the body of θ = 0 whose P is the unit matrix.

Rucker and Wensing, "Smooth parameterization of rigid-body inertia", IEEE Robotics and Automation Letters 7(2), 2022.

The residuals of the fit in these coordinates, and their derivatives.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS, PriorCoordinates
from graphdyn.identification.consistent.manifold import upper_factor
from graphdyn.identification.consistent.polishing import FURTHER_COLUMN_WEIGHT
from graphdyn.layout import BODY_PARAMETERS, Array

_STRETCHES = (0, 1, 2)
_PLACES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))  # of s₁₂, s₂₃, s₁₃, t₁, t₂, t₃


def log_cholesky_factor(theta: Array) -> Array:
    """U (…, 4, 4) of θ (…, 10)."""
    u = np.zeros((*theta.shape[:-1], 4, 4))
    for k in _STRETCHES:
        u[..., k, k] = np.exp(theta[..., 1 + k])
    for k, (row, column) in enumerate(_PLACES, start=4):
        u[..., row, column] = theta[..., k]
    u[..., 3, 3] = 1.0
    return np.exp(theta[..., 0])[..., None, None] * u


def log_cholesky_factor_derivatives(theta: Array) -> Array:
    """∂U/∂θ_k (…, 10, 4, 4) of θ (…, 10)."""
    u = log_cholesky_factor(theta)
    d = np.zeros((*theta.shape[:-1], BODY_PARAMETERS, 4, 4))
    d[..., 0, :, :] = u
    for k in _STRETCHES:
        d[..., 1 + k, k, k] = u[..., k, k]
    for k, (row, column) in enumerate(_PLACES, start=4):
        d[..., k, row, column] = np.exp(theta[..., 0])
    return d


def log_cholesky_pseudo_inertia(theta: Array) -> Array:
    """P = U Uᵀ (…, 4, 4) of θ (…, 10)."""
    u = log_cholesky_factor(theta)
    return u @ np.swapaxes(u, -1, -2)


def log_cholesky_pseudo_inertia_derivatives(theta: Array) -> Array:
    """∂P/∂θ_k = ∂U/∂θ_k Uᵀ + U ∂Uᵀ/∂θ_k (…, 10, 4, 4)."""
    half = log_cholesky_factor_derivatives(theta) @ np.swapaxes(log_cholesky_factor(theta), -1, -2)[..., None, :, :]
    return half + np.swapaxes(half, -1, -2)


def log_cholesky_parameters(matrix: Array) -> Array:
    """θ (…, 10) of positive definite P (…, 4, 4). Raises numpy.linalg.LinAlgError if P is not positive definite."""
    u = upper_factor(matrix)
    unit = u / u[..., 3:, 3:]
    theta = [np.log(u[..., 3, 3]), *(np.log(unit[..., k, k]) for k in _STRETCHES)]
    return np.stack([*theta, *(unit[..., row, column] for row, column in _PLACES)], axis=-1)


MAX_THETA = 40.0
"""Largest |θ| that has an effect: trial steps must not overflow, and e^-40 is negligible."""


class Residuals:
    """A u - b and √(strength / 2) (u - u of the prior), as functions of the unknowns (θ of n bodies, further
    columns).
    """

    def __init__(self, coordinates: PriorCoordinates, strength: float, margin: float):
        self.coordinates, self.margin, self.pull = coordinates, margin, np.sqrt(strength / 2)

    def u(self, unknowns: Array) -> Array:
        bodies = log_cholesky_pseudo_inertia(self._thetas(unknowns))
        s = self.margin * np.eye(4) + (1 - self.margin) * bodies
        return np.concatenate(
            [np.einsum("ijk,nij->nk", SYMMETRIC_BASIS, s).reshape(-1), unknowns[self.coordinates.width :]]
        )

    def residuals(self, unknowns: Array) -> Array:
        c, u = self.coordinates, self.u(unknowns)
        weight = self._weight(len(u))
        return np.concatenate([c.matrix @ u - c.right, weight * (u - c.origin)])

    def jacobian(self, unknowns: Array) -> Array:
        derivatives = log_cholesky_pseudo_inertia_derivatives(self._thetas(unknowns))
        blocks = (1 - self.margin) * np.einsum("ijk,nlij->nkl", SYMMETRIC_BASIS, derivatives)
        of_u = np.eye(len(unknowns))
        for i, block in enumerate(blocks):
            rows = slice(BODY_PARAMETERS * i, BODY_PARAMETERS * (i + 1))
            of_u[rows, rows] = block
        return np.concatenate([self.coordinates.matrix @ of_u, self._weight(len(unknowns))[:, None] * of_u])

    def cost(self, unknowns: Array) -> float:
        return float(np.sum(self.residuals(unknowns) ** 2))

    def lifted(self, unknowns: Array, part: float) -> Array:
        """The unknowns with this fraction of the prior added to every body."""
        thicker = log_cholesky_pseudo_inertia(self._thetas(unknowns)) + part * np.eye(4)
        further = unknowns[self.coordinates.width :]
        return np.concatenate([log_cholesky_parameters(thicker).reshape(-1), further])

    def of_some(self, values: Array, free: NDArray[np.int64], others: Array) -> Array:
        """The residuals as a function of the free unknowns."""
        return self.residuals(with_values(others, free, values))

    def jacobian_of_some(self, values: Array, free: NDArray[np.int64], others: Array) -> Array:
        return self.jacobian(with_values(others, free, values))[:, free]

    def _thetas(self, unknowns: Array) -> Array:
        bodies = unknowns[: self.coordinates.width].reshape(-1, BODY_PARAMETERS)
        return np.clip(bodies, -MAX_THETA, MAX_THETA)

    def _weight(self, size: int) -> Array:
        pulls: Array = self.pull * np.where(
            np.arange(size) < self.coordinates.width, 1.0, np.sqrt(FURTHER_COLUMN_WEIGHT)
        )
        return pulls


def with_values(unknowns: Array, free: NDArray[np.int64], values: Array) -> Array:
    """The unknowns with these values at the free entries."""
    changed = unknowns.copy()
    changed[free] = values
    return changed
