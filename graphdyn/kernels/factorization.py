"""M = Lᵀ D L along the tree, M⁻¹ from it, and M x = b.

Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 6.5. L is lower triangular with ones on its diagonal, and
like M it has entries only where one joint lies between the other and the ground; D_j is the inertia about joint j with
all joints outside free to move, the pivot of the elimination in graphdyn.kernels.forward.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from graphdyn.kernels.forward import reciprocal
from graphdyn.kernels.inertia import mass_matrix
from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.vectors import Scalars, zeros


def mass_matrix_inverse(links: Sequence[Link], q: Sequence[Any]) -> dict[str, list[Any]]:
    """mass_matrix_inverse (n n); pivots."""
    inverse, pivots = inverted_mass_matrix(links, q)
    return {"mass_matrix_inverse": list(inverse.ravel()), "pivots": pivots}


def inverted_mass_matrix(links: Sequence[Link], q: Sequence[Any]) -> tuple[Scalars, list[Any]]:
    """M⁻¹ (n, n), and the pivots D (n)."""
    return inverted(mass_matrix(links, q), [list(_inside(links, j)) for j in range(len(links))])


def solved(links: Sequence[Link], q: Sequence[Any], right: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """x of M x = right (n), and the pivots D (n)."""
    inside = [list(_inside(links, j)) for j in range(len(links))]
    lower, pivots = _factors(mass_matrix(links, q), inside)
    x = list(right)
    for j in reversed(range(len(links))):
        for i in inside[j]:
            x[i] = x[i] - lower[j, i] * x[j]
    x = [value * reciprocal(pivot) for value, pivot in zip(x, pivots, strict=True)]
    for j in range(len(links)):
        for i in reversed(inside[j]):
            x[j] = x[j] - lower[j, i] * x[i]
    return x, pivots


def inverted(mass: Scalars, inside: Sequence[Sequence[int]]) -> tuple[Scalars, list[Any]]:
    """L⁻¹ D⁻¹ L⁻ᵀ (n, n), and D (n); inside: per row, the columns left of the diagonal that have entries, falling."""
    lower, pivots = _factors(mass, inside)
    inverse = _inverted(lower, inside)
    scaled = inverse * np.array([reciprocal(pivot) for pivot in pivots], dtype=object)
    matrix = zeros(*mass.shape)
    for i in range(len(mass)):
        for k in range(i, len(mass)):
            matrix[i, k] = matrix[k, i] = scaled[i] @ inverse[k]
    return matrix, pivots


def _factors(mass: Scalars, inside: Sequence[Sequence[int]]) -> tuple[Scalars, list[Any]]:
    """L (n, n) without its diagonal, and D (n): from the leaves to the ground, joint after joint is eliminated."""
    rest, lower = mass.copy(), zeros(*mass.shape)
    for j in reversed(range(len(mass))):
        columns = list(inside[j])
        lower[j, columns] = rest[j, columns] * reciprocal(rest[j, j])
        for i in columns:
            for k in (i, *inside[i]):
                rest[i, k] = rest[i, k] - lower[j, i] * rest[j, k]
    return lower, list(rest.diagonal())


def _inverted(lower: Scalars, inside: Sequence[Sequence[int]]) -> Scalars:
    """L⁻¹ (n, n), from the ground to the leaves."""
    inverse = np.eye(len(lower)).astype(object)
    for j, given in enumerate(inside):
        columns = list(given)
        inverse[j, columns] = -(lower[j, columns] @ inverse[np.ix_(columns, columns)])
    return inverse


def _inside(links: Sequence[Link], j: int) -> Iterator[int]:
    """The joints between joint j and the ground, outermost first."""
    while links[j].inside >= 0:
        j = links[j].inside
        yield j
