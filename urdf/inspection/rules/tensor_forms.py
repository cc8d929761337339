"""What a tensor would have to be written as to be that of a mesh: products negated, axes exchanged, turned.

Tensors are compared up to a factor, because links are hollow. Which way of writing is meant is only asked where the
inertial is that of the mesh beside it: the center of mass is the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations
from typing import NamedTuple

import numpy as np

from graphdyn.layout import Array

_AXES = "xyz"
_PRODUCTS = ((0, 1), (0, 2), (1, 2))


class TensorForm(NamedTuple):
    """A tensor in link axes (3, 3), and how it comes from the one that is written: "with its products negated"."""

    words: str
    tensor: Array


def forms(own: Array, rotation: Array) -> Iterator[TensorForm]:
    """Other tensors that the writer may have meant, usual mistakes first.

    own: as written, in the axes of the inertial frame       (3, 3)
    rotation: of <origin>                                    (3, 3)
    """
    turned = rotation @ own @ rotation.T
    if not np.allclose(rotation, np.eye(3)):
        yield TensorForm("without the rotation of <origin>", own)
        yield TensorForm("with the opposite rotation of <origin>", rotation.T @ own @ rotation)
    yield TensorForm("with its products of inertia negated", 2 * np.diag(np.diag(turned)) - turned)
    for k, axis in enumerate(_AXES):
        mirror = np.where(np.arange(3) == k, -1.0, 1.0)
        yield TensorForm(f"mirrored in {axis}", turned * np.outer(mirror, mirror))
    for order in list(permutations(range(3)))[1:]:
        exchanged = "".join(_AXES[k] for k in order)
        swapped = turned[np.ix_(order, order)]
        yield TensorForm(f"with its axes x, y, z in the order {', '.join(exchanged)}", swapped)
        diagonal = np.diag(np.diag(turned))
        yield TensorForm(
            f"with its moments in the order {', '.join(2 * axis for axis in exchanged)}",
            turned - diagonal + np.diag(np.diag(swapped)),
        )
        products = ("".join(sorted(exchanged[i] + exchanged[j])) for i, j in _PRODUCTS)
        yield TensorForm(
            f"with its products in the order {', '.join(products)}",
            swapped - np.diag(np.diag(swapped)) + diagonal,
        )


MAX_DISTANCE, MIN_GAIN, MIN_DISTANCE = 0.1, 3.0, 0.12
"""A tensor is that of the mesh up to the first distance; another one is meant if it is so and nearer by the second
factor, where the written one is farther away than the last. Tensors of other bodies, turned by 45°, are meant so once
for twenty times that the forms below are."""

SAME_SIZE = (0.75, 1.34)
"""Factors between a tensor and that of the mesh with the same mass that a body has which is nearly uniform."""


def meant(own: Array, rotation: Array, filled: Array) -> tuple[float, TensorForm, float] | None:
    """The distance as written, the form that is meant, and its distance; None where no other one is.

    filled: the tensor of the mesh with the mass of the link, in link axes   (3, 3)
    """
    apart, _ = distance(rotation @ own @ rotation.T, filled)
    if apart < MIN_DISTANCE:
        return None
    limit = min(MAX_DISTANCE, apart / MIN_GAIN)
    fitting = [
        (form, off)
        for form in forms(own, rotation)
        for off, factor in [distance(form.tensor, filled)]
        if off < limit and SAME_SIZE[0] < factor < SAME_SIZE[1]
    ]
    if not fitting:
        return None
    best = min(off for _, off in fitting)
    form, off = next(each for each in fitting if each[1] <= 1.2 * best)  # the usual one of equals
    return apart, form, off


def distance(own: Array, other: Array) -> tuple[float, float]:
    """‖own - f other‖ / ‖own‖ with the factor f that makes it smallest, and f; tensors (3, 3)."""
    factor = float(np.sum(own * other) / np.sum(other * other))
    return float(np.linalg.norm(own - factor * other) / np.linalg.norm(own)), factor
