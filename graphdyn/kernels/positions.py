"""Joint state to maximal state by recursion (graphdyn.maximal_state): world axes for places, body axes for turns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root, places, rotations, stacked
from graphdyn.kernels.vectors import E_Z, Scalars, cross


def maximal_state(links: Sequence[Link], root: Root, q: Sequence[Any], v: Sequence[Any]) -> dict[str, list[Any]]:
    """position (n 3) of the centers of mass, rotation (n 9) of the link axes, velocity (n 6)."""
    at = places(links, q)
    axes = rotations(links, at, root)
    origins: list[Scalars] = []
    twists: list[tuple[Scalars, Scalars]] = []
    position, rotation, velocity = [], [], []
    for link, place, to_world, rate in zip(links, at, axes, v, strict=True):
        inside = (root.rotation, root.position) if link.inside < 0 else (axes[link.inside], origins[link.inside])
        linear, omega = (root.velocity, root.omega) if link.inside < 0 else twists[link.inside]
        origin = inside[1] + inside[0] @ place.translation
        linear = place.outwards(linear + cross(omega, place.translation))
        omega = place.outwards(omega)
        if link.prismatic:
            linear = linear + E_Z * rate
        else:
            omega = omega + E_Z * rate
        origins.append(origin)
        twists.append((linear, omega))
        position.append(origin + to_world @ link.center_of_mass)
        rotation.append((to_world @ link.link_axes.T).reshape(-1))
        velocity += [to_world @ (linear + cross(omega, link.center_of_mass)), link.link_axes @ omega]
    return {"position": stacked(position), "rotation": stacked(rotation), "velocity": stacked(velocity)}
