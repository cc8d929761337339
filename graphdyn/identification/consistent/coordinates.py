"""Least squares in coordinates in which the prior is the unit matrix: a physically meaningful scaling of the columns.

Per body P = U₀ S U₀ᵀ with the prior P₀ = U₀ U₀ᵀ. S = E is the prior, and S ⪰ 0 is a physically consistent body. s are
the ten entries of S, those off the diagonal times √2, so that ‖s‖ = ‖S‖. A further column (friction, offset, …) is
scaled so that 1 makes a torque as large as the whole measured one. The coordinates are thus independent of units and
of the choice of link frames.

The rank is that of the base parameters, which drop tiny columns before they scale any. The best fits are
    u = fitting + null y,    any y:
the data determine u up to y. A method that stays on this set has the base parameters of weighted least squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE, BaseParameters, base_parameters
from graphdyn.identification.algebra.compressed import solve_triangle
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import parameters_from_pseudo_inertia

_ROWS, _COLUMNS = np.triu_indices(4)
_WEIGHT = np.where(_ROWS == _COLUMNS, 1.0, np.sqrt(0.5))

SYMMETRIC_BASIS = np.zeros((4, 4, BODY_PARAMETERS))
"""Basis of symmetric matrices: S = SYMMETRIC_BASIS @ s."""
SYMMETRIC_BASIS[_ROWS, _COLUMNS, range(BODY_PARAMETERS)] = SYMMETRIC_BASIS[_COLUMNS, _ROWS, range(BODY_PARAMETERS)] = (
    _WEIGHT
)

IDENTITY_COORDINATES = np.einsum("iik->k", SYMMETRIC_BASIS)
"""Coordinates s of the unit matrix S = E."""

MAX_TRUSTED_DEVIATIONS = 1e5
"""Largest ‖z‖, in standard deviations of the residuals, by which equations are scaled: exact data have no such unit."""


@dataclass(frozen=True, eq=False)
class PriorCoordinates:
    """min ‖A u - b‖², u = (s of n bodies, k further columns), residuals in units of their standard deviation.

    prior: pseudo-inertia matrices                          (n, 4, 4)
    to_parameters: x = to_parameters @ u, x in the order of the torque model   (p, p), p = 10n + k
    matrix, right: A (r, p), b (r,)
    fitting, null: the best fits u are fitting + null y (p,), (p, p - r), null orthonormal
    base, base_values, base_covariance: base parameters of the data, their best fit (r,), their covariance (r, r)
    """

    prior: Array
    to_parameters: Array
    matrix: Array
    right: Array
    fitting: Array
    null: Array
    base: BaseParameters
    base_values: Array
    base_covariance: Array

    @property
    def n_bodies(self) -> int:
        return len(self.prior)

    @property
    def width(self) -> int:
        """Number of entries of u that belong to bodies; the further columns follow."""
        return BODY_PARAMETERS * self.n_bodies

    @property
    def origin(self) -> Array:
        """u of the prior: S = E, no friction."""
        return np.concatenate(
            [np.tile(IDENTITY_COORDINATES, self.n_bodies), np.zeros(len(self.to_parameters) - self.width)]
        )

    def symmetric(self, u: Array) -> Array:
        """Matrices S of the bodies (n, 4, 4)."""
        tensors: Array = np.einsum("ijk,nk->nij", SYMMETRIC_BASIS, u[: self.width].reshape(-1, BODY_PARAMETERS))
        return tensors

    def smallest_eigenvalues(self, u: Array) -> Array:
        """Smallest eigenvalue of S for each body (n,)."""
        return np.asarray(np.linalg.eigvalsh(self.symmetric(u))[:, 0], dtype=float)

    def parameters(self, u: Array) -> Array:
        """Parameters x (p,) of the torque model."""
        return self.to_parameters @ u

    def fitting_parameters(self, u: Array) -> Array:
        """Parameters x (p,) among the best fits, for a u that is a best fit up to rounding.

        The base parameters are exact, and the rest comes from u.
        """
        x = self.to_parameters @ u
        x[self.base.independent] = self.base_values - self.base.regrouping @ x[self.base.dependent]
        return x

    def nearest_best_fit(self, u: Array, held: NDArray[np.bool_]) -> Array:
        """The best fit u with the smallest distance from this one.

        Entries that are held (p,) become zero, up to rounding, if the best fits allow it.
        """
        inverse = np.linalg.pinv(self.null[held], rcond=RANK_TOLERANCE)
        y = self.null.T @ (u - self.fitting)
        y -= inverse @ (self.fitting[held] + self.null[held] @ y)
        return self.fitting + self.null @ y

    def excess(self, u: Array) -> float:
        """Amount of ‖A u - b‖² above its minimum."""
        return float(np.sum((self.matrix @ (u - self.fitting)) ** 2))


def prior_coordinates(
    base: BaseParameters, reduced: Array, right: Array, prior: Array, body_columns: Sequence[slice]
) -> PriorCoordinates:
    """Coordinates for min ‖R x_base - z‖², residuals in units of their standard deviation.

    base: of the recording; reduced: R (≥ r, r), right: z (≥ r,), of CompressedEquations.weighted
    prior: pseudo-inertia matrices, positive definite (n, 4, 4); body_columns: the ten of each body among the p columns
    """
    rank = len(base.independent)
    inner = base_parameters(reduced[:rank])  # a part of a recording may determine less than the whole
    if inner.rank < rank:
        base, reduced = base.then(inner), reduced[:, inner.independent]
    triangle: Array = np.asarray(np.linalg.qr(np.column_stack([reduced, right]), mode="r"))
    reduced, right = triangle[: base.rank, :-1], triangle[: base.rank, -1]
    best = solve_triangle(reduced, right)

    p = base.rank + len(base.dependent)
    regressor = reduced @ base.matrix
    size = float(np.linalg.norm(right)) or 1.0
    in_bodies = np.concatenate([np.arange(p)[columns] for columns in body_columns])
    width, scale = len(in_bodies), np.zeros((p, p))
    for i, (factor, columns) in enumerate(zip(upper_factor(prior), body_columns, strict=True)):
        basis = np.einsum("ai,ijk,bj->kab", factor, SYMMETRIC_BASIS, factor)
        scale[columns, BODY_PARAMETERS * i : BODY_PARAMETERS * (i + 1)] = parameters_from_pseudo_inertia(basis).T
    for k, column in enumerate(np.setdiff1d(np.arange(p), in_bodies), start=width):
        length = np.linalg.norm(regressor[:, column])
        scale[column, k] = size / length if length > 0 else 1.0

    particular, free = np.zeros(p), np.zeros((p, p - base.rank))
    particular[base.independent] = best.x
    free[base.independent] = -base.regrouping
    free[base.dependent, range(p - base.rank)] = 1.0
    unit = max(1.0, size / MAX_TRUSTED_DEVIATIONS)
    return PriorCoordinates(
        prior=prior,
        to_parameters=scale,
        matrix=regressor @ scale / unit,
        right=right / unit,
        fitting=np.asarray(np.linalg.solve(scale, particular), dtype=float),
        null=np.linalg.qr(np.linalg.solve(scale, free))[0],
        base=base,
        base_values=best.x,
        base_covariance=best.inverse,
    )


def upper_factor(matrix: Array) -> Array:
    """Upper triangular U with P = U Uᵀ, positive diagonal (…, 4, 4)."""
    return np.asarray(np.linalg.cholesky(matrix[..., ::-1, ::-1])[..., ::-1, ::-1], dtype=float)
