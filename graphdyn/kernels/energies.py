"""Energies of all bodies together, from the motion of their link frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root, places, rotations
from graphdyn.kernels.vectors import E_Z, Scalars, cross


def kinetic_energy(links: Sequence[Link], root: Root, q: Sequence[Any], v: Sequence[Any]) -> list[Any]:
    """Σ ½ m u² + u·(ω × m c) + ½ ωᵀ I ω, u the velocity of O_j and I the tensor about it."""
    twists: list[tuple[Scalars, Scalars]] = []
    total: Any = 0.0
    for link, place, rate in zip(links, places(links, q), v, strict=True):
        linear, omega = (root.velocity, root.omega) if link.inside < 0 else twists[link.inside]
        u, omega = place.outwards(linear + cross(omega, place.translation)), place.outwards(omega)
        if link.prismatic:
            u = u + E_Z * rate
        else:
            omega = omega + E_Z * rate
        twists.append((u, omega))
        twice = u @ (u * link.mass + cross(omega, link.first_moment) * 2.0) + omega @ (link.tensor @ omega)
        total = total + twice * 0.5
    return [total]


def potential_energy(links: Sequence[Link], root: Root, q: Sequence[Any]) -> list[Any]:
    """-Σ g·m r, from the world's origin to each center of mass."""
    at = places(links, q)
    axes = rotations(links, at, root)
    origins: list[Scalars] = []
    total: Any = 0.0
    for link, place, to_world in zip(links, at, axes, strict=True):
        inside = (root.rotation, root.position) if link.inside < 0 else (axes[link.inside], origins[link.inside])
        origins.append(inside[1] + inside[0] @ place.translation)
        total = total - root.gravity @ (origins[-1] * link.mass + to_world @ link.first_moment)
    return [total]
