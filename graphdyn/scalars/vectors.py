"""Vectors and matrices of scalars: NumPy arrays of objects, so that +, @ and slices mean what they mean elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Scalars = NDArray[np.object_]

PerJoint = Sequence[Any]
"""A scalar for each joint."""

E_Z = np.array([0.0, 0.0, 1.0], dtype=object)


def scalars(values: ArrayLike) -> Scalars:
    """Known numbers as scalars; what is recorded stays as it is."""
    array = np.asarray(values)
    return array if array.dtype == object else array.astype(float).astype(object)


def zeros(*shape: int) -> Scalars:
    return np.full(shape, 0.0, dtype=object)


def by_shapes(columns: Sequence[Any], shapes: Mapping[str, tuple[int, ...]]) -> dict[str, Any]:
    """Arrays of these shapes, by name, from their entries one after the other; a scalar where the shape is ()."""
    found, first = {}, 0
    for name, shape in shapes.items():
        last = first + prod(shape)
        found[name] = np.array(columns[first:last], dtype=object).reshape(shape)[()]
        first = last
    return found


def cross(x: Scalars, y: Scalars) -> Scalars:
    return np.array([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]], dtype=object)


def is_known(scalar: Any, value: float) -> bool:
    """Whether a scalar is this number for all samples."""
    return isinstance(scalar, float | int) and scalar == value


def skew(x: Scalars) -> Scalars:
    """S(x) with S(x) y = x × y."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]], dtype=object)


def symmetric(matrix: Scalars) -> Scalars:
    """The same symmetric matrix, its lower triangle taken from the upper, which is then not computed twice."""
    return np.array([[matrix[min(i, k), max(i, k)] for k in range(3)] for i in range(3)], dtype=object)


def turn(c: Any, s: Any, x: Scalars) -> Scalars:
    """Rz x for a vector, or for each column of a matrix; c, s: cosine and sine of the angle."""
    return np.array([c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]], dtype=object)


def turn_back(c: Any, s: Any, x: Scalars) -> Scalars:
    """Rzᵀ x."""
    return turn(c, -s, x)


def turn_matrix(c: Any, s: Any, matrix: Scalars) -> Scalars:
    """Rz X Rzᵀ."""
    return turn(c, s, turn(c, s, matrix).T).T


def turn_symmetric(c: Any, s: Any, x: Scalars) -> Scalars:
    """Rz X Rzᵀ of a symmetric X, in 16 operations instead of 27: the plane part turns by the double angle."""
    change = s * s * (x[1, 1] - x[0, 0]) - 2.0 * (c * s) * x[0, 1]
    xx, yy = x[0, 0] + change, x[1, 1] - change
    xy = (c * c - s * s) * x[0, 1] - c * s * (x[1, 1] - x[0, 0])
    xz, yz = c * x[0, 2] - s * x[1, 2], s * x[0, 2] + c * x[1, 2]
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, x[2, 2]]], dtype=object)
