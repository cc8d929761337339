"""Standard deviation of further parameters of a fit, such as the size of a change."""

from __future__ import annotations

import numpy as np

from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.layout import Array

SIZE_BLOCKS = 20
"""Number of time blocks within which errors may be correlated."""


def covariance(fit: BoundedFit, error: Array, slopes: Array) -> Array:
    """Covariance (k, k) of k further parameters of a fit by one Gauss-Newton step.

    error: residual (N, n), NaN in rows that do not count; slopes: its change with each parameter (k, N, n). Errors may
    be correlated within each of SIZE_BLOCKS time blocks.
    """
    rows = np.isfinite(error)
    noise = np.sqrt(np.nansum(error**2, axis=0) / np.maximum(rows.sum(axis=0), 1))
    weight = np.where(rows, 1 / np.where(noise > 0, noise, 1.0), 0.0)
    matrix = (fit.matrix * weight[..., None]).reshape(error.size, -1)
    length = np.linalg.norm(matrix, axis=0)
    basis = np.linalg.qr(matrix[:, length > 0] / length[length > 0])[0]

    def left(values: Array) -> Array:
        flat = (np.nan_to_num(values) * weight).ravel()
        return np.asarray(flat - basis @ (basis.T @ flat)).reshape(error.shape)

    shifts, e = np.array([left(slope) for slope in slopes]), left(error)
    curvature = np.einsum("aij,bij->ab", shifts, shifts)
    blocks = np.array_split(np.arange(len(error)), SIZE_BLOCKS)
    steps = np.array([np.einsum("aij,ij->a", shifts[:, rows], e[rows]) for rows in blocks])
    inverse = np.linalg.pinv(curvature)
    return np.asarray(inverse @ steps.T @ steps @ inverse)
