"""Energies of all bodies together, from the motion of their link frames, and what each inertial parameter adds.

Center of mass and momentum of all bodies together, by sums from the leaves to the ground.

Orin, Goswami and Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 35(2), 2013. All sums are about
joint 1 (motion.rooted); mass is the total mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from graphdyn.layout import BODY_DOF
from graphdyn.recursions.declarations import ArraySpec, recursion
from graphdyn.recursions.inertia import composites, per_rate
from graphdyn.recursions.inverse import Wrench, added, inwards, transmitted
from graphdyn.recursions.mechanism.mechanism import Link, Links
from graphdyn.recursions.motion import JointPlacement, Root, origins, places, rooted, rotations, twists
from graphdyn.scalars.differentiation import directional, jacobian
from graphdyn.scalars.vectors import PerJoint, Scalars, cross, zeros


@recursion(kinetic_energy=ArraySpec((), "J"))
def kinetic_energy(links: Links, root: Root, q: PerJoint, v: PerJoint) -> list[Any]:
    """Σ ½ m u² + u·(ω × m c) + ½ ωᵀ I ω, u the velocity of O_j and I the tensor about it."""
    total: Any = 0.0
    for link, (u, omega) in zip(links, twists(links, places(links, q), root, v), strict=True):
        twice = u @ (u * link.mass + cross(omega, link.first_moment) * 2.0) + omega @ (link.tensor @ omega)
        total = total + twice * 0.5
    return [total]


@recursion(potential_energy=ArraySpec((), "J"))
def potential_energy(links: Links, root: Root, q: PerJoint) -> list[Any]:
    """-Σ g·m r, from the world's origin to each center of mass."""
    at = places(links, q)
    axes = rotations(links, at, root)
    total: Any = 0.0
    for link, origin, to_world in zip(links, origins(links, at, axes, root), axes, strict=True):
        total = total - root.gravity @ (origin * link.mass + to_world @ link.first_moment)
    return [total]


@recursion(kinetic=ArraySpec(("10 bodies",), "J per parameter"), potential=ArraySpec(("10 bodies",), "J per parameter"))
def energy_regressor(links: Links, root: Root, q: PerJoint, v: PerJoint) -> dict[str, list[Any]]:
    """kinetic and potential (10 n each): the energies are linear in m, m c and I, the tensor about O_j in link axes."""
    at = places(links, q)
    kinetic: list[Any] = []
    potential: list[Any] = []
    fields: list[tuple[Any, Scalars]] = []  # -g·O_j and -g in joint axes
    for link, place, twist in zip(links, at, twists(links, at, root, v), strict=True):
        ground = -(root.gravity @ root.position), -(root.rotation.T @ root.gravity)
        height, up = fields[link.inside] if link.inside >= 0 else ground
        fields.append((height + up @ place.translation, place.outwards(up)))
        height, up = fields[-1]
        u, w, up = (link.link_axes @ x for x in (*twist, up))
        parts = of_parameters(u, w, height, up)
        kinetic += parts[0]
        potential += parts[1]
    return {"kinetic": kinetic, "potential": potential}


def of_parameters(u: Scalars, w: Scalars, height: Any, up: Scalars) -> tuple[list[Any], list[Any]]:
    """Kinetic and potential energy of a body per inertial parameter (10 each).

    u, w: velocity of its origin and ω; height, up: -g·O and -g; all in link axes
    """
    squares = [w[0] * w[0] * 0.5, w[0] * w[1], w[1] * w[1] * 0.5, w[0] * w[2], w[1] * w[2], w[2] * w[2] * 0.5]
    return [u @ u * 0.5, *cross(u, w), *squares], [height, *up, *[0.0] * len(squares)]


@recursion(center_of_mass=ArraySpec((3,), "m"))
def center_of_mass(links: Links, root: Root, mass: float, q: PerJoint) -> list[Any]:
    """Center of mass in the world (3,)."""
    links, root = rooted(links, root)
    return list(root.position + root.rotation @ _center(links, places(links, q), mass))


@recursion(center_of_mass_velocity=ArraySpec((3,), "m/s"))
def center_of_mass_velocity(links: Links, root: Root, mass: float, q: PerJoint, v: PerJoint) -> list[Any]:
    """World axes (3,)."""
    links, root = rooted(links, root)
    center = _center(links, places(links, q), mass)
    in_ground = np.array(directional(list(center), q, v), dtype=object)
    return list(root.rotation @ (root.velocity + cross(root.omega, center) + in_ground))


@recursion(center_of_mass_jacobian=ArraySpec((3, "n"), "m or 1"))
def center_of_mass_jacobian(links: Links, root: Root, mass: float, q: PerJoint) -> Scalars:
    """World axes (3, n)."""
    links, root = rooted(links, root)
    columns: Scalars = root.rotation @ jacobian(list(_center(links, places(links, q), mass)), q)
    return columns


@recursion(
    about_center_of_mass=ArraySpec((BODY_DOF,), "kg m/s, kg m²/s"),
    about_origin=ArraySpec((BODY_DOF,), "kg m/s, kg m²/s"),
)
def momentum(links: Links, root: Root, mass: float, q: PerJoint, v: PerJoint) -> dict[str, list[Any]]:
    """about_center_of_mass and about_origin (6 each): linear, then angular momentum, world axes."""
    links, root = rooted(links, root)
    at = places(links, q)
    of_bodies = [of_motion(link, *twist) for link, twist in zip(links, twists(links, at, root, v), strict=True)]
    in_ground, about_joint = _at_ground(links, at, transmitted(links, at, of_bodies, None))
    linear, center = root.rotation @ in_ground, _center(links, at, mass)
    about_center = root.rotation @ (about_joint - cross(center, in_ground))
    about_origin = root.rotation @ about_joint + cross(root.position, linear)
    return {"about_center_of_mass": [*linear, *about_center], "about_origin": [*linear, *about_origin]}


@recursion(centroidal_map=ArraySpec((BODY_DOF, "n"), "kg m, kg m² or kg, kg m"))
def centroidal_map(links: Links, root: Root, mass: float, q: PerJoint) -> Scalars:
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


def of_motion(link: Link, u: Scalars, omega: Scalars) -> Wrench:
    """m u + ω × m c, and m c × u + I ω about O_j, of the velocity u of O_j; joint axes."""
    return u * link.mass + cross(omega, link.first_moment), cross(link.first_moment, u) + link.tensor @ omega


def _center(links: Links, at: Sequence[JointPlacement], mass: float) -> Scalars:
    """Center of all bodies, from the origin of the ground frame in its axes."""
    first_moment = zeros(3)
    for link, place, outside in zip(links, at, composites(links, at), strict=True):
        if link.inside < 0:
            first_moment = first_moment + outside.inwards(place).first_moment
    center: Scalars = first_moment / mass
    return center


def _at_ground(links: Links, at: Sequence[JointPlacement], of_joints: Sequence[Wrench]) -> Wrench:
    """The sum of what the joints on the ground transmit, about the origin of the ground frame in its axes."""
    total = zeros(3), zeros(3)
    for link, place, wrench in zip(links, at, of_joints, strict=True):
        if link.inside < 0:
            total = added(total, inwards(place, wrench))
    return total
