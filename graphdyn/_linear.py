"""Matrices and vectors with leading batch dimensions."""

from typing import Any

import numpy as np

from graphdyn.layout import Array

_NEXT, _AFTER_NEXT = np.array([1, 2, 0]), np.array([2, 0, 1])


def cross(a: Array, b: Array) -> Array:
    """a × b over the last dimension, with the bits of np.cross. (…, 3), (…, 3) → (…, 3).

    Of small batches np.cross spends nine tenths of its time on the choice of axes.
    """
    product: Array = a.take(_NEXT, -1) * b.take(_AFTER_NEXT, -1) - a.take(_AFTER_NEXT, -1) * b.take(_NEXT, -1)
    return product


def apply(matrix: Array, vector: Array) -> Array:
    """(…, k, l), (…, l) → (…, k)."""
    return (matrix @ vector[..., None])[..., 0]


def solve(matrix: Array, vector: Array) -> Array:
    """x with matrix x = vector, by LU factorisation. (…, k, k), (…, k) → (…, k)."""
    x: Any = np.linalg.solve(matrix, vector[..., None])[..., 0]
    return np.asarray(x)
