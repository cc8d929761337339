"""M = Lᵀ D L along the tree, and M⁻¹ from it.

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
    """M⁻¹ = L⁻¹ D⁻¹ L⁻ᵀ (n, n), and the pivots D (n)."""
    lower, pivots = _factors(links, mass_matrix(links, q))
    inverse = _inverted(links, lower)
    scaled = inverse * np.array([reciprocal(pivot) for pivot in pivots], dtype=object)
    matrix = zeros(len(links), len(links))
    for i in range(len(links)):
        for k in range(i, len(links)):
            matrix[i, k] = matrix[k, i] = scaled[i] @ inverse[k]
    return matrix, pivots


def _factors(links: Sequence[Link], mass: Scalars) -> tuple[Scalars, list[Any]]:
    """L (n, n) without its diagonal, and D (n): from the leaves to the ground, joint after joint is eliminated."""
    rest, lower = mass.copy(), zeros(*mass.shape)
    for j in reversed(range(len(links))):
        inside = list(_inside(links, j))
        lower[j, inside] = rest[j, inside] * reciprocal(rest[j, j])
        for i in inside:
            for k in (i, *_inside(links, i)):
                rest[i, k] = rest[i, k] - lower[j, i] * rest[j, k]
    return lower, list(rest.diagonal())


def _inverted(links: Sequence[Link], lower: Scalars) -> Scalars:
    """L⁻¹ (n, n), from the ground to the leaves."""
    inverse = np.eye(len(links)).astype(object)
    for j in range(len(links)):
        inside = list(_inside(links, j))
        inverse[j, inside] = -(lower[j, inside] @ inverse[np.ix_(inside, inside)])
    return inverse


def _inside(links: Sequence[Link], j: int) -> Iterator[int]:
    """The joints between joint j and the ground, outermost first."""
    while links[j].inside >= 0:
        j = links[j].inside
        yield j
