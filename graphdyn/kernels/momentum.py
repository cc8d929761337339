"""Center of mass and momentum of all bodies together, by sums from the leaves to the ground.

Orin, Goswami and Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 35(2), 2013. All sums are about
joint 1 (motion.rooted); mass is the total mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from graphdyn.kernels.differentiation import directional, jacobian
from graphdyn.kernels.inertia import composites, per_rate
from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Place, Root, origins, places, rooted, rotations, twists
from graphdyn.kernels.reactions import Wrench, added, inwards, transmitted
from graphdyn.kernels.vectors import Scalars, cross, zeros


def center_of_mass(links: Sequence[Link], root: Root, mass: float, q: Sequence[Any]) -> list[Any]:
    """In the world (3,)."""
    links, root = rooted(links, root)
    return list(root.position + root.rotation @ _center(links, places(links, q), mass))


def center_of_mass_velocity(
    links: Sequence[Link], root: Root, mass: float, q: Sequence[Any], v: Sequence[Any]
) -> list[Any]:
    """World axes (3,)."""
    links, root = rooted(links, root)
    center = _center(links, places(links, q), mass)
    in_ground = np.array(directional(list(center), q, v), dtype=object)
    return list(root.rotation @ (root.velocity + cross(root.omega, center) + in_ground))


def center_of_mass_jacobian(links: Sequence[Link], root: Root, mass: float, q: Sequence[Any]) -> Scalars:
    """World axes (3, n)."""
    links, root = rooted(links, root)
    columns: Scalars = root.rotation @ jacobian(list(_center(links, places(links, q), mass)), q)
    return columns


def momentum(
    links: Sequence[Link], root: Root, mass: float, q: Sequence[Any], v: Sequence[Any]
) -> dict[str, list[Any]]:
    """about_center_of_mass and about_origin (6 each): linear, then angular momentum, world axes."""
    links, root = rooted(links, root)
    at = places(links, q)
    of_bodies = [_momentum(link, *twist) for link, twist in zip(links, twists(links, at, root, v), strict=True)]
    in_ground, about_joint = _at_ground(links, at, transmitted(links, at, of_bodies, None))
    linear, center = root.rotation @ in_ground, _center(links, at, mass)
    about_center = root.rotation @ (about_joint - cross(center, in_ground))
    about_origin = root.rotation @ about_joint + cross(root.position, linear)
    return {"about_center_of_mass": [*linear, *about_center], "about_origin": [*linear, *about_origin]}


def centroidal_map(links: Sequence[Link], root: Root, mass: float, q: Sequence[Any]) -> Scalars:
    """(6, n): column j is the momentum that a unit velocity of joint j gives, about the center of mass, world axes."""
    links, root = rooted(links, root)
    root = replace(root, position=zeros(3))
    at = places(links, q)
    axes = rotations(links, at, root)
    center = root.rotation @ _center(links, at, mass)
    columns = []
    for link, outside, to_world, origin in zip(
        links, composites(links, at), axes, origins(links, at, axes, root), strict=True
    ):
        linear, angular = (to_world @ part for part in per_rate(link.prismatic, outside))
        columns.append([*linear, *(angular + cross(origin - center, linear))])
    return np.array(columns, dtype=object).T


def _momentum(link: Link, u: Scalars, omega: Scalars) -> Wrench:
    """m u + ω × m c, and m c × u + I ω about O_j, of the velocity u of O_j; joint axes."""
    return u * link.mass + cross(omega, link.first_moment), cross(link.first_moment, u) + link.tensor @ omega


def _center(links: Sequence[Link], at: Sequence[Place], mass: float) -> Scalars:
    """Of all bodies, from the origin of the ground frame in its axes."""
    first_moment = zeros(3)
    for link, place, outside in zip(links, at, composites(links, at), strict=True):
        if link.inside < 0:
            first_moment = first_moment + outside.inwards(place).first_moment
    center: Scalars = first_moment / mass
    return center


def _at_ground(links: Sequence[Link], at: Sequence[Place], of_joints: Sequence[Wrench]) -> Wrench:
    """The sum of what the joints on the ground transmit, about the origin of the ground frame in its axes."""
    total = zeros(3), zeros(3)
    for link, place, wrench in zip(links, at, of_joints, strict=True):
        if link.inside < 0:
            total = added(total, inwards(place, wrench))
    return total
