"""Linear algebra on the small matrices of an identification, for which several threads are slower than one.

Triangular factors: A = Q F with F upper triangular, so that ‖A x‖ = ‖F x‖.

Ordinary least squares on independent columns.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array


def one_thread() -> AbstractContextManager[Any]:
    """Limit NumPy's and SciPy's linear algebra to one thread. Sums of graphdyn.compiler keep their threads."""
    limited: AbstractContextManager[Any] = _linear_algebra().limit(limits=1, user_api="blas")
    return limited


@cache
def _linear_algebra() -> Any:
    """The loaded libraries, looked up once: that takes a millisecond, the limit itself a fiftieth of it."""
    import scipy.linalg  # noqa: F401  # imported where first used; a library must be loaded to be limited
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def triangle(matrix: Array) -> Array:
    """Triangular factor F (…, min(rows, p), p) of A (…, rows, p)."""
    return np.asarray(np.linalg.qr(matrix, mode="r"), dtype=float)


def square_triangle(matrix: Array) -> Array:
    """Triangular factor F (p, p) of A (rows, p), filled with zero rows, with a non-negative diagonal."""
    p = matrix.shape[1]
    f = triangle(matrix)
    f = np.concatenate([f, np.zeros((p - len(f), p))])
    return f * np.where(np.diag(f) < 0, -1.0, 1.0)[:, None]


def orthonormal_basis(columns: Array, tolerance: float) -> Array:
    """An orthonormal basis of columns, scaled to unit length; zero columns, as of a resting joint, are left out.

    tolerance: singular value, relative to the largest, below which a direction is rounding
    """
    length = np.linalg.norm(columns, axis=0)
    unit = columns[:, length > 0] / length[length > 0]
    q, r = np.linalg.qr(unit)  # of many rows the singular values of the small factor take a fraction of the time
    u, s, _ = np.linalg.svd(r, full_matrices=False)
    return np.asarray(q @ u[:, s > tolerance * s.max(initial=0.0)])


@dataclass(frozen=True, eq=False)
@short_repr
class LeastSquares:
    """Solution of a linear least-squares problem W x = τ.

    parameters: x                                           (b,)
    column_scale: lengths of the columns of W; condition_number: of W with columns scaled to unit length
    residual_rms: root mean square of W x - τ
    """

    parameters: Array
    column_scale: Array
    condition_number: float
    residual_rms: float


def ordinary_least_squares(regressor: ArrayLike, torque: ArrayLike) -> LeastSquares:
    """x that minimizes ‖W x - τ‖, by singular values with columns scaled to unit length. W (rows, b), τ (rows,).

    The normal equations of Eq. (56), (64) are not used: they square the condition number.
    Raises InvalidInput if the shapes do not fit, a number is not finite, or the columns are dependent (see
    base_parameters).
    """
    from scipy.linalg import lstsq  # imported where first used: import graphdyn stays light

    w, t = as_floats("regressor", regressor), as_floats("torque", torque)
    if w.ndim != 2 or t.shape != w.shape[:1]:
        raise InvalidInput(f"regressor has shape {w.shape}, torque {t.shape}; expected (rows, b) and (rows,)")
    for name, array in (("regressor", w), ("torque", t)):
        if not np.all(np.isfinite(array)):
            raise InvalidInput(f"{name} contains NaN or infinity in row {int(np.argwhere(~np.isfinite(array))[0][0])}")
    scale = np.linalg.norm(w, axis=0)
    if w.shape[1] and not np.all(scale > 0):
        raise InvalidInput(f"column {int(np.argmin(scale))} of the regressor is zero; keep independent columns only")
    x, _, rank, singular_values = lstsq(w / scale, t)
    if rank < w.shape[1]:
        raise InvalidInput(f"the regressor has rank {rank} of {w.shape[1]} columns; keep independent columns only")
    parameters = x / scale
    return LeastSquares(
        parameters=parameters,
        column_scale=scale,
        condition_number=float(singular_values[0] / singular_values[-1]) if len(singular_values) else 1.0,
        residual_rms=float(np.sqrt(np.mean((w @ parameters - t) ** 2))),
    )
