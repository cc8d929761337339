"""Energies of all bodies together, from the motion of their link frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root, origins, places, rotations, twists
from graphdyn.kernels.vectors import cross


def kinetic_energy(links: Sequence[Link], root: Root, q: Sequence[Any], v: Sequence[Any]) -> list[Any]:
    """Σ ½ m u² + u·(ω × m c) + ½ ωᵀ I ω, u the velocity of O_j and I the tensor about it."""
    total: Any = 0.0
    for link, (u, omega) in zip(links, twists(links, places(links, q), root, v), strict=True):
        twice = u @ (u * link.mass + cross(omega, link.first_moment) * 2.0) + omega @ (link.tensor @ omega)
        total = total + twice * 0.5
    return [total]


def potential_energy(links: Sequence[Link], root: Root, q: Sequence[Any]) -> list[Any]:
    """-Σ g·m r, from the world's origin to each center of mass."""
    at = places(links, q)
    axes = rotations(links, at, root)
    total: Any = 0.0
    for link, origin, to_world in zip(links, origins(links, at, axes, root), axes, strict=True):
        total = total - root.gravity @ (origin * link.mass + to_world @ link.first_moment)
    return [total]
