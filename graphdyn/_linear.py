"""Matrix and vector with leading batch dimensions."""

import numpy as np

from graphdyn.layout import Array


def apply(matrix: Array, vector: Array) -> Array:
    """(…, k, l), (…, l) → (…, k)."""
    return (matrix @ vector[..., None])[..., 0]


def solve(matrix: Array, vector: Array) -> Array:
    """x with matrix x = vector, by LU factorisation. (…, k, k), (…, k) → (…, k)."""
    return np.asarray(np.linalg.solve(matrix, vector[..., None])[..., 0], dtype=float)
