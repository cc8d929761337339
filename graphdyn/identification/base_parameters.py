"""Base parameters: the combinations of inertial parameters that joint torques depend on.

Gautier, "Numerical calculation of the base inertial parameters of robots", Journal of Robotic Systems 8(4), 1991,
with a rank-revealing (column-pivoted) QR factorisation of the regressor over many states.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array

DROPPED_COLUMN = 1e-9
"""A column shorter than this part of the longest is no column: angles such as π/2 rounded in a file leave null
columns at 1e-11, and scaling to unit length would resurrect them as parameters."""

RANK = 1e-9
"""Smallest |R_kk| relative to |R_11| that counts as independent, after scaling the columns to unit length. Rounding
leaves 1e-15, the weakest true parameter of an arm under random motion 1e-4 or more."""


@dataclass(frozen=True, eq=False)
class BaseParameters:
    """Which columns of W are independent, and how the others fold into them.

    independent: columns of the base parameters             (b,)
    dependent: columns folded into them                     (d,)
    regrouping: K with π_base = π[independent] + K π[dependent]   (b, d)
    gap: smallest accepted and largest rejected |R_kk| / |R_11|: the rank is clear where they are far apart
    """

    independent: NDArray[np.int64]
    dependent: NDArray[np.int64]
    regrouping: Array
    gap: tuple[float, float]

    @property
    def rank(self) -> int:
        return len(self.independent)

    def values(self, parameters: ArrayLike) -> Array:
        """Base parameters (b,) of standard parameters (10n,)."""
        pi = np.asarray(parameters, dtype=float)
        return pi[self.independent] + self.regrouping @ pi[self.dependent]


def base_parameters(regressor: ArrayLike) -> BaseParameters:
    """Independent columns of a stacked regressor W (rows, 10n), rows ≥ 10n, and the regrouping of the rest.

    Raises InvalidInput where W is not a matrix, not finite, or has fewer rows than columns.
    """
    from scipy.linalg import qr, solve_triangular  # imported where first used: import graphdyn stays light

    w = as_floats("regressor", regressor)
    if w.ndim != 2 or w.size == 0 or w.shape[0] < w.shape[1] or not np.all(np.isfinite(w)):
        raise InvalidInput(
            f"regressor has shape {w.shape}; a finite matrix with at least as many rows as columns needed"
        )
    length = np.linalg.norm(w, axis=0)
    kept = np.flatnonzero(length > DROPPED_COLUMN * length.max())
    dropped = np.setdiff1d(np.arange(w.shape[1]), kept)
    if kept.size == 0:
        return BaseParameters(kept, dropped, np.zeros((0, dropped.size)), (0.0, 0.0))
    r, pivots = qr(w[:, kept] / length[kept], mode="r", pivoting=True)
    pivot_sizes = np.append(np.abs(np.diag(r)) / np.abs(r[0, 0]), 0.0)
    rank = int(np.count_nonzero(pivot_sizes > RANK))
    folded = solve_triangular(r[:rank, :rank], r[:rank, rank : kept.size])
    first, rest = kept[pivots[:rank]], kept[pivots[rank:]]
    regrouping = folded * length[rest] / length[first][:, None]
    order = np.argsort(first)
    return BaseParameters(
        independent=first[order],
        dependent=np.concatenate([rest, dropped]),
        regrouping=np.hstack([regrouping[order], np.zeros((rank, dropped.size))]),
        gap=(float(pivot_sizes[rank - 1]), float(pivot_sizes[rank])),
    )
