"""Criteria: functions of the information matrix F (b, b) that measure how well a motion determines the base parameters.

Each returns its value and its derivative by F (b, b), symmetric; smaller is better. If F is singular, the value is
infinite.

log_det: ln of the geometric mean of the semi-axes of the error ellipsoid, -ln det F / 2b. Its best motion does not
    depend on units or on how columns are scaled.
mean_sigma: ln of the geometric mean of the standard deviations, Σ ln (F⁻¹)_kk / 2b; never below log_det.
ConditionNumber: ln of that of the regressor with scaled columns, (ln λ_max - ln λ_min) / 2. It depends on the scales,
    and it is small if all parameters are equally badly determined.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from graphdyn.layout import Array

Criterion = Callable[[Array], tuple[float, Array]]


def log_det(information: Array) -> tuple[float, Array]:
    """D-optimality: Pukelsheim, Optimal Design of Experiments, 1993, chapter 6."""
    inverse = covariance(information)
    size = len(information)
    if inverse is None:
        return np.inf, np.zeros_like(information)
    return float(-np.linalg.slogdet(information)[1] / (2 * size)), -inverse / (2 * size)


def mean_sigma(information: Array) -> tuple[float, Array]:
    """Mean logarithm of the standard deviations: ∂/∂F of (F⁻¹)_kk is -F⁻¹ e_k e_kᵀ F⁻¹."""
    inverse = covariance(information)
    size = len(information)
    if inverse is None:
        return np.inf, np.zeros_like(information)
    variances = np.diag(inverse)
    return float(np.log(variances).sum() / (2 * size)), -(inverse / variances) @ inverse / (2 * size)


@dataclass(frozen=True, eq=False)
class ConditionNumber:
    """Condition number for columns times scale (b,), the prior spreads of the parameters.

    Gautier and Khalil, "Exciting trajectories for the identification of base inertial parameters of robots",
    International Journal of Robotics Research 11(4), 1992.
    """

    scale: Array

    def __call__(self, information: Array) -> tuple[float, Array]:
        units = np.outer(self.scale, self.scale)
        values, vectors = np.linalg.eigh(information * units)
        if not values[0] > 0:
            return np.inf, np.zeros_like(information)
        low, high = vectors[:, 0], vectors[:, -1]
        slope = np.outer(high, high) / values[-1] - np.outer(low, low) / values[0]
        return float(np.log(values[-1] / values[0]) / 2), slope * units / 2


def covariance(information: Array) -> Array | None:
    """F⁻¹ of a positive definite F, with rows and columns first scaled to a diagonal of one; None for any other F."""
    diagonal = np.diag(information)
    if not np.all(diagonal > 0):
        return None
    scale = 1 / np.sqrt(diagonal)
    try:
        root = np.linalg.inv(np.linalg.cholesky(information * np.outer(scale, scale)))
    except np.linalg.LinAlgError:
        return None
    return np.asarray(root.T @ root) * np.outer(scale, scale)
