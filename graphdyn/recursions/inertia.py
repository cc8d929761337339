"""Mass matrix by composite rigid bodies: what lies outside joint j moves as one.

Walker and Orin, "Efficient dynamic computer simulation of robotic mechanisms", ASME Journal of Dynamic Systems,
Measurement, and Control 104(3), 1982; Featherstone 2008, section 6.2.

M = Lᵀ D L along the tree, M⁻¹ from it, and M x = b.

Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 6.5. L is lower triangular with ones on its diagonal, and
like M it has entries only where one joint lies between the other and the ground; D_j is the inertia about joint j with
all joints outside free to move, the pivot of the elimination in graphdyn.recursions.forward.

Accelerations of short chains: M a = τ - h, with M by composite rigid bodies and h by inverse dynamics.

As many operations as the elimination of recursions.forward for six joints in a row, and more for longer chains.
But M and h are two sums that do not wait for each other, where the elimination is one: the longest sequence of
operations is shorter by a third.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.recursions.declarations import ArraySpec, recursion
from graphdyn.recursions.inverse import Loads, Wrench, inverse_dynamics, inwards
from graphdyn.recursions.mechanism.mechanism import Links, path
from graphdyn.recursions.motion import JointPlacement, Root, places
from graphdyn.scalars.vectors import E_Z, PerJoint, Scalars, cross, is_known, symmetric, zeros


@dataclass(frozen=True, eq=False)
class Composite:
    """m, m c and I about O_j of body j and all bodies outside."""

    mass: Any
    first_moment: Scalars
    tensor: Scalars

    def inwards(self, place: JointPlacement) -> Composite:
        """The same bodies in joint axes, and about the origin, of the inside body."""
        h, p = place.inwards(self.first_moment), place.translation
        cross_terms = np.outer(h, p)
        point = p @ p * self.mass + 2.0 * (h @ p)
        shift = np.eye(3, dtype=object) * point - (cross_terms + cross_terms.T) - np.outer(p, p) * self.mass
        return Composite(self.mass, h + self.mass * p, symmetric(place.symmetric_inwards(self.tensor) + shift))

    def __add__(self, other: Composite) -> Composite:
        return Composite(self.mass + other.mass, self.first_moment + other.first_moment, self.tensor + other.tensor)


def composites(links: Links, at: Sequence[JointPlacement]) -> list[Composite]:
    """Body j with all bodies outside, for every j."""
    done = [Composite(link.mass, link.first_moment, link.tensor) for link in links]
    for j in reversed(range(len(links))):
        if links[j].inside >= 0:
            done[links[j].inside] += done[j].inwards(at[j])
    return done


@recursion(mass_matrix=ArraySpec(("n", "n"), "kg m², kg m, kg"))
def mass_matrix(links: Links, q: PerJoint) -> Scalars:
    """M (n, n)."""
    at = places(links, q)
    matrix = zeros(len(links), len(links))
    for j, composite in enumerate(composites(links, at)):
        wrench = per_rate(links[j].prismatic, composite)
        matrix[j, j] = _along_axis(links[j].prismatic, wrench)
        k = j
        while links[k].inside >= 0:
            wrench, k = inwards(at[k], wrench), links[k].inside
            matrix[j, k] = matrix[k, j] = _along_axis(links[k].prismatic, wrench)
    return matrix


def per_rate(prismatic: bool, composite: Composite) -> Wrench:
    """The momentum that a unit velocity of the joint gives, which is also what a unit acceleration takes."""
    if prismatic:
        return np.array([0.0, 0.0, composite.mass], dtype=object), cross(composite.first_moment, E_Z)
    return cross(E_Z, composite.first_moment), composite.tensor[:, 2]


def _along_axis(prismatic: bool, wrench: Wrench) -> Any:
    return wrench[0][2] if prismatic else wrench[1][2]


@recursion(mass_matrix_inverse=ArraySpec(("n", "n"), "1/(kg m²), 1/(kg m), 1/kg"))
def mass_matrix_inverse(links: Links, q: PerJoint) -> dict[str, Any]:
    """mass_matrix_inverse (n n); pivots."""
    inverse, pivots = inverted_mass_matrix(links, q)
    return {"mass_matrix_inverse": inverse, "pivots": pivots}


def inverted_mass_matrix(links: Links, q: PerJoint) -> tuple[Scalars, list[Any]]:
    """M⁻¹ (n, n), and the pivots D (n)."""
    return inverted(mass_matrix(links, q), _inside(links))


def solved(links: Links, q: PerJoint, right: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """x of M x = right (n), and the pivots D (n)."""
    inside = _inside(links)
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


def reciprocal(pivot: Any) -> Any:
    """1 / D, infinite where D is known to be zero: a joint without inertia, which then shows as a pivot of zero."""
    return math.inf if is_known(pivot, 0.0) else 1.0 / pivot


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
            # only where row i has entries: the joints between i and the ground
            for k in (i, *inside[i]):
                rest[i, k] = rest[i, k] - lower[j, i] * rest[j, k]
    return lower, list(rest.diagonal())


def _inverted(lower: Scalars, inside: Sequence[Sequence[int]]) -> Scalars:
    """L⁻¹ (n, n), from the ground to the leaves."""
    inverse = np.eye(len(lower)).astype(object)
    for j, given in enumerate(inside):
        # row j of L⁻¹ from the rows before: L has ones on its diagonal
        columns = list(given)
        inverse[j, columns] = -(lower[j, columns] @ inverse[np.ix_(columns, columns)])
    return inverse


def _inside(links: Links) -> list[list[int]]:
    """Per joint, those between it and the ground, outermost first."""
    return [path(links, link.inside)[::-1] for link in links]


MAX_SHORT_CHAIN = 6
"""Joints between a body and the ground. Measured: a fifth faster with six, equally fast with seven."""


def is_short(links: Links) -> bool:
    return max(len(path(links, j)) for j in range(len(links))) <= MAX_SHORT_CHAIN


def joint_accelerations(
    links: Links, root: Root, q: PerJoint, v: PerJoint, tau: PerJoint, external: Loads = None
) -> dict[str, list[Any]]:
    """a, and pivots: the inertia about each joint with all joints outside free to move."""
    bias = inverse_dynamics(links, root, q, v, [0.0] * len(links), external)["tau"]
    a, pivots = solved(links, q, [given - needed for given, needed in zip(tau, bias, strict=True)])
    return {"a": a, "pivots": pivots}
