"""Log-Cholesky coordinates of an inertia: ten unbounded numbers, each choice of them a physically consistent body.

    P = U Uᵀ,   U = e^α [e^d₁ s₁₂ s₁₃ t₁; 0 e^d₂ s₂₃ t₂; 0 0 e^d₃ t₃; 0 0 0 1]
    θ = (α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃)

α, d scale the body, s shear it, t moves its center of mass, from the body of θ = 0 whose P is the unit matrix.

Rucker and Wensing, "Smooth parameterization of rigid-body inertia", IEEE Robotics and Automation Letters 7(2), 2022.
"""

import numpy as np

from graphdyn.identification.consistent.manifold import upper_factor
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
