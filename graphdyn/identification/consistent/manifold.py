"""Distances between physically consistent inertias, and a prior that lies among them.

Pseudo-inertia matrices P of physically consistent bodies are the positive definite 4×4 matrices. There are two
distances from a prior P₀:

    entropic    d = tr(P₀⁻¹ P) - log det(P₀⁻¹ P) - 4        Bregman divergence of -log det
    pullback    d = ½ tr((P₀⁻¹ (P - P₀))²)                  its second-order part at P₀, a quadratic form in P

Both are ≥ 0, vanish at P₀ alone, and are invariant to changes of link frame or units: P → G P Gᵀ, P₀ → G P₀ Gᵀ.

Lee, Wensing and Park, "Geometric robot dynamic identification: a convex programming approach", IEEE Transactions on
Robotics 36(2), 2020, Eq. (22) and (26); Lee and Park, "A geometric algorithm for robust multibody inertial parameter
identification", IEEE Robotics and Automation Letters 3(3), 2018.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.inertia import pseudo_inertia_from_parameters

MIN_PRIOR_RADIUS = 1e-3
"""Smallest extent of a prior [m]: the root mean square distance of its mass from a plane through the center of mass."""

MIN_PRIOR_THINNESS = 0.05
"""Smallest extent of a prior relative to its largest one: the log-det of a flat or slender CAD body is undefined."""

MIN_PRIOR_MASS_SHARE = 1e-2
"""Smallest mass of a prior relative to the mean body: a link without mass in the file gets that much."""


@dataclass(frozen=True, eq=False)
class InertialPrior:
    """Positive definite pseudo-inertia matrices of n bodies, about the link origins, in link axes.

    pseudo_inertia: (n, 4, 4) [kg, kg m, kg m²]
    lifted: bodies that were too light, too thin or not physically consistent and had to be moved inside    (n,)
    """

    pseudo_inertia: Array
    lifted: NDArray[np.bool_]


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


def upper_factor(matrix: Array) -> Array:
    """Upper triangular U with P = U Uᵀ, positive diagonal (…, 4, 4)."""
    return np.asarray(np.linalg.cholesky(matrix[..., ::-1, ::-1])[..., ::-1, ::-1], dtype=float)


def inertial_prior(parameters: Array) -> InertialPrior:
    """Prior from ten parameters per body (n, 10), moved inside the physically consistent bodies if needed.

    The mass is raised to MIN_PRIOR_MASS_SHARE of the mean, and the extent along each principal axis to
    MIN_PRIOR_THINNESS of the largest one and to MIN_PRIOR_RADIUS. A body that is already inside stays unchanged.
    Raises InvalidInput if no body has a mass.
    """
    mass = parameters[:, 0]
    heavy = mass > 0
    if not heavy.any():
        raise InvalidInput("no body of the prior has a mass; give a prior with at least rough masses")
    matrices = pseudo_inertia_from_parameters(parameters)
    least = MIN_PRIOR_MASS_SHARE * mass[heavy].mean()
    lifted = np.array([_lift(matrix, least) for matrix in matrices])
    return InertialPrior(matrices, lifted)


def _lift(matrix: Array, least_mass: float) -> bool:
    """Move one pseudo-inertia matrix inside, in place; return whether that was needed."""
    light = matrix[3, 3] < least_mass
    center = np.zeros(3) if matrix[3, 3] <= 0 else matrix[:3, 3] / matrix[3, 3]
    second_moments = matrix[:3, :3] - matrix[3, 3] * np.outer(center, center)
    mass = max(matrix[3, 3], least_mass)
    values, axes = np.linalg.eigh(second_moments)
    smallest = max(MIN_PRIOR_THINNESS**2 * values[-1], MIN_PRIOR_RADIUS**2 * mass)
    if not light and values[0] >= smallest:
        return False
    second_moments = axes * np.maximum(values, smallest) @ axes.T
    matrix[:3, :3] = second_moments + mass * np.outer(center, center)
    matrix[:3, 3] = matrix[3, :3] = mass * center
    matrix[3, 3] = mass
    return True
