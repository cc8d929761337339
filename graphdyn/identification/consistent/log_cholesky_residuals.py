"""Residuals of the log-Cholesky fit and their derivatives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS, PriorCoordinates
from graphdyn.identification.consistent.log_cholesky import (
    log_cholesky_parameters,
    log_cholesky_pseudo_inertia,
    log_cholesky_pseudo_inertia_derivatives,
)
from graphdyn.identification.consistent.polishing import FURTHER_COLUMN_WEIGHT
from graphdyn.layout import BODY_PARAMETERS, Array

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
