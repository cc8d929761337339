"""Triangular factors: A = Q F with F upper triangular, so that ‖A x‖ = ‖F x‖."""

import numpy as np

from graphdyn.layout import Array


def triangle(matrix: Array) -> Array:
    """F (…, min(rows, p), p) of A (…, rows, p)."""
    return np.asarray(np.linalg.qr(matrix, mode="r"), dtype=float)


def square_triangle(matrix: Array) -> Array:
    """F (p, p) of A (rows, p), filled with zero rows, with a diagonal that is not negative."""
    p = matrix.shape[1]
    f = triangle(matrix)
    f = np.concatenate([f, np.zeros((p - len(f), p))])
    return f * np.where(np.diag(f) < 0, -1.0, 1.0)[:, None]
