"""Outward recursion, from the ground to the leaves: where the bodies are and how they move.

Luh, Walker and Paul, "On-line computational scheme for mechanical manipulators", ASME Journal of Dynamic Systems,
Measurement, and Control 102(2), 1980; Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 5.3. Velocities and
accelerations are those of O_j, in joint axes of body j. Gravity enters as an acceleration of the ground by -g; linear
accelerations are therefore gravity-compensated, p̈ - g.

Joint state to maximal state by recursion (graphdyn.maximal_state): world axes for places, body axes for turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from graphdyn.layout import BODY_DOF
from graphdyn.recursions.declarations import ArraySpec, recursion
from graphdyn.recursions.mechanism.mechanism import Link, Links
from graphdyn.scalars.vectors import (
    E_Z,
    PerJoint,
    Scalars,
    cross,
    scalars,
    skew,
    turn,
    turn_back,
    turn_matrix,
    turn_symmetric,
    zeros,
)


@dataclass(frozen=True, eq=False)
class Root:
    """The ground frame, where the recursions start: rotation to world axes, position and gravity there.

    Its velocity, acceleration, ω, ω̇ and gravity-compensated acceleration are in its own axes.
    """

    rotation: Scalars
    position: Scalars
    gravity: Scalars
    velocity: Scalars
    omega: Scalars
    alpha: Scalars
    acceleration: Scalars
    compensated: Scalars


def resting_root() -> Root:
    """A ground at rest at the world's origin, without gravity."""
    return Root(scalars(np.eye(3)), *(zeros(3) for _ in range(7)))


def rooted(links: Links, root: Root) -> tuple[list[Link], Root]:
    """The same robot with the origin of its ground frame moved to joint 1 (where that is at q = 0, if it slides).

    Sums about this point lose no digits where joint 1 is far from the ground frame or the world's origin.
    """
    arm = links[0].translation
    relative = BodyMotion(root.omega, root.alpha, root.compensated).spread() @ arm
    moved = replace(
        root,
        position=root.position + root.rotation @ arm,
        velocity=root.velocity + cross(root.omega, arm),
        acceleration=root.acceleration + relative,
        compensated=root.compensated + relative,
    )
    return [link if link.inside >= 0 else replace(link, translation=link.translation - arm) for link in links], moved


@dataclass(frozen=True, eq=False)
class JointPlacement:
    """Placement of body j in its inside body: rotation R Rz(q), translation with the slide. R comes last."""

    rotation: Scalars
    c: Any
    s: Any
    translation: Scalars

    def inwards(self, x: Scalars) -> Scalars:
        """Rotate from joint axes of body j to those of the inside body; a vector, or each column of a matrix."""
        turned: Scalars = self.rotation @ turn(self.c, self.s, x)
        return turned

    def outwards(self, x: Scalars) -> Scalars:
        return turn_back(self.c, self.s, self.rotation.T @ x)

    def matrix_inwards(self, x: Scalars) -> Scalars:
        turned: Scalars = self.rotation @ turn_matrix(self.c, self.s, x) @ self.rotation.T
        return turned

    def symmetric_inwards(self, x: Scalars) -> Scalars:
        turned: Scalars = self.rotation @ turn_symmetric(self.c, self.s, x) @ self.rotation.T
        return turned


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """ω, ω̇ and the gravity-compensated acceleration p̈ - g of O_j."""

    omega: Scalars
    alpha: Scalars
    compensated: Scalars

    def spread(self) -> Scalars:
        """S(ω̇) + S(ω)²: times a vector fixed in the body, the acceleration of its tip relative to its root."""
        w = skew(self.omega)
        spread: Scalars = skew(self.alpha) + w @ w
        return spread


def places(links: Links, q: PerJoint) -> list[JointPlacement]:
    return [
        JointPlacement(link.rotation, 1.0, 0.0, link.translation + link.rotation @ (E_Z * x))
        if link.prismatic
        else JointPlacement(link.rotation, *_cosine_and_sine(x, *link.at_zero), link.translation)
        for link, x in zip(links, q, strict=True)
    ]


def _cosine_and_sine(angle: Any, c: Any, s: Any) -> tuple[Any, Any]:
    """Cosine and sine of the angle plus that of cosine c and sine s."""
    return angle.cosine * c - angle.sine * s, angle.sine * c + angle.cosine * s


def motions(links: Links, at: Sequence[JointPlacement], root: Root, v: PerJoint, a: PerJoint) -> list[BodyMotion]:
    """Motions of all bodies, at joint velocities v and accelerations a."""
    done: list[BodyMotion] = []
    for link, place, rate, acceleration in zip(links, at, v, a, strict=True):
        inside = done[link.inside] if link.inside >= 0 else BodyMotion(root.omega, root.alpha, root.compensated)
        omega, alpha = place.outwards(inside.omega), place.outwards(inside.alpha)
        compensated = place.outwards(inside.compensated + inside.spread() @ place.translation)
        if link.prismatic:
            compensated = compensated + cross(omega, E_Z * (2.0 * rate)) + E_Z * acceleration
        else:
            alpha = alpha + cross(omega, E_Z * rate) + E_Z * acceleration
            omega = omega + E_Z * rate
        done.append(BodyMotion(omega, alpha, compensated))
    return done


def rotations(links: Links, at: Sequence[JointPlacement], root: Root) -> list[Scalars]:
    """Joint axes of body j to world axes."""
    done: list[Scalars] = []
    for link, place in zip(links, at, strict=True):
        inside = done[link.inside] if link.inside >= 0 else root.rotation
        done.append(turn_back(place.c, place.s, (inside @ place.rotation).T).T)
    return done


def origins(links: Links, at: Sequence[JointPlacement], axes: Sequence[Scalars], root: Root) -> list[Scalars]:
    """O_j of all bodies in the world; axes: their rotations."""
    done: list[Scalars] = []
    for link, place in zip(links, at, strict=True):
        inside = (root.position, root.rotation) if link.inside < 0 else (done[link.inside], axes[link.inside])
        done.append(inside[0] + inside[1] @ place.translation)
    return done


def twists(links: Links, at: Sequence[JointPlacement], root: Root, v: PerJoint) -> list[tuple[Scalars, Scalars]]:
    """Velocity of O_j and ω of all bodies, in joint axes."""
    done: list[tuple[Scalars, Scalars]] = []
    for link, place, rate in zip(links, at, v, strict=True):
        linear, omega = (root.velocity, root.omega) if link.inside < 0 else done[link.inside]
        linear, omega = place.outwards(linear + cross(omega, place.translation)), place.outwards(omega)
        done.append((linear + E_Z * rate, omega) if link.prismatic else (linear, omega + E_Z * rate))
    return done


def inertial_wrench(link: Link, motion: BodyMotion) -> tuple[Scalars, Scalars]:
    """Force, and moment about O_j, that the motion of body j takes: Eq. (22), (23) moved to the link origin."""
    force = link.mass * motion.compensated + motion.spread() @ link.first_moment
    return force, rotary_moment(link.tensor, motion) + cross(link.first_moment, motion.compensated)


def rotary_moment(tensor: Scalars, motion: BodyMotion) -> Scalars:
    """I ω̇ + ω × I ω, summed by the entries of I, whose factors are entries of the spread or common products."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor
    (x, y, z), (alpha_x, alpha_y, alpha_z), spread = motion.omega, motion.alpha, motion.spread()
    return np.array(
        [
            xx * alpha_x + (zz - yy) * (y * z) + yz * (y * y - z * z) - xy * spread[2, 0] + xz * spread[1, 0],
            yy * alpha_y + (xx - zz) * (z * x) + xz * (z * z - x * x) - yz * spread[0, 1] + xy * spread[2, 1],
            zz * alpha_z + (yy - xx) * (x * y) + xy * (x * x - y * y) - xz * spread[1, 2] + yz * spread[0, 2],
        ],
        dtype=object,
    )


def stacked(vectors: Sequence[Scalars]) -> list[Any]:
    return list(np.concatenate(vectors))


@recursion(
    position=ArraySpec(("bodies", 3), "m"),
    rotation=ArraySpec(("bodies", 3, 3), "1"),
    velocity=ArraySpec(("bodies", BODY_DOF), "m/s, rad/s"),
)
def maximal_state(links: Links, root: Root, q: PerJoint, v: PerJoint) -> dict[str, list[Any]]:
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
