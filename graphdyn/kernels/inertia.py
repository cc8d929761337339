"""Mass matrix by composite rigid bodies: what lies outside joint j moves as one.

Walker and Orin, "Efficient dynamic computer simulation of robotic mechanisms", ASME Journal of Dynamic Systems,
Measurement, and Control 104(3), 1982; Featherstone 2008, section 6.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Place, places
from graphdyn.kernels.reactions import Wrench, inwards
from graphdyn.kernels.vectors import E_Z, Scalars, cross, symmetric, zeros


@dataclass(frozen=True, eq=False)
class Composite:
    """m, m c and I about O_j of body j and all bodies outside."""

    mass: Any
    first_moment: Scalars
    tensor: Scalars

    def inwards(self, place: Place) -> Composite:
        """The same bodies in joint axes, and about the origin, of the inside body."""
        h, p = place.inwards(self.first_moment), place.translation
        cross_terms = np.outer(h, p)
        point = p @ p * self.mass + 2.0 * (h @ p)
        shift = np.eye(3, dtype=object) * point - (cross_terms + cross_terms.T) - np.outer(p, p) * self.mass
        return Composite(self.mass, h + self.mass * p, symmetric(place.symmetric_inwards(self.tensor) + shift))

    def __add__(self, other: Composite) -> Composite:
        return Composite(self.mass + other.mass, self.first_moment + other.first_moment, self.tensor + other.tensor)


def composites(links: Sequence[Link], at: Sequence[Place]) -> list[Composite]:
    """Body j with all bodies outside, for every j."""
    done = [Composite(link.mass, link.first_moment, link.tensor) for link in links]
    for j in reversed(range(len(links))):
        if links[j].inside >= 0:
            done[links[j].inside] += done[j].inwards(at[j])
    return done


def mass_matrix(links: Sequence[Link], q: Sequence[Any]) -> Scalars:
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
