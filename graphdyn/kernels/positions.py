"""Joint state to maximal state by recursion (graphdyn.maximal_state): world axes for places, body axes for turns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root, origins, places, rotations, stacked, twists
from graphdyn.kernels.vectors import cross


def maximal_state(links: Sequence[Link], root: Root, q: Sequence[Any], v: Sequence[Any]) -> dict[str, list[Any]]:
    """position (n 3) of the centers of mass, rotation (n 9) of the link axes, velocity (n 6)."""
    at = places(links, q)
    axes = rotations(links, at, root)
    position, rotation, velocity = [], [], []
    for link, to_world, origin, (linear, omega) in zip(
        links, axes, origins(links, at, axes, root), twists(links, at, root, v), strict=True
    ):
        position.append(origin + to_world @ link.center_of_mass)
        rotation.append((to_world @ link.link_axes.T).reshape(-1))
        velocity += [to_world @ (linear + cross(omega, link.center_of_mass)), link.link_axes @ omega]
    return {"position": stacked(position), "rotation": stacked(rotation), "velocity": stacked(velocity)}
