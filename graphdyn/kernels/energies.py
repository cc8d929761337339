"""Energies of all bodies together, from the motion of their link frames, and what each inertial parameter adds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root, origins, places, rotations, twists
from graphdyn.kernels.vectors import Scalars, cross


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


def energy_regressor(links: Sequence[Link], root: Root, q: Sequence[Any], v: Sequence[Any]) -> dict[str, list[Any]]:
    """kinetic and potential (10 n each): the energies are linear in m, m c and I, the tensor about O_j in link axes."""
    at = places(links, q)
    kinetic: list[Any] = []
    potential: list[Any] = []
    fields: list[tuple[Any, Scalars]] = []  # -g·O_j and -g in joint axes
    for link, place, twist in zip(links, at, twists(links, at, root, v), strict=True):
        u, w = (link.link_axes @ x for x in twist)
        squares = [w[0] * w[0] * 0.5, w[0] * w[1], w[1] * w[1] * 0.5, w[0] * w[2], w[1] * w[2], w[2] * w[2] * 0.5]
        kinetic += [u @ u * 0.5, *cross(u, w), *squares]
        ground = -(root.gravity @ root.position), -(root.rotation.T @ root.gravity)
        height, up = fields[link.inside] if link.inside >= 0 else ground
        fields.append((height + up @ place.translation, place.outwards(up)))
        potential += [fields[-1][0], *(link.link_axes @ fields[-1][1]), *[0.0] * len(squares)]
    return {"kinetic": kinetic, "potential": potential}
