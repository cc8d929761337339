"""Inward recursion, from the leaves to the ground: what the joints transmit, and how the verbs state it.

Inverse dynamics by recursion: outwards the motion, inwards the wrenches. Luh, Walker and Paul, 1980.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS
from graphdyn.recursions.declarations import TORQUES, ArraySpec, recursion, recursion_of_torques
from graphdyn.recursions.mechanism.mechanism import Links
from graphdyn.recursions.motion import (
    BodyMotion,
    JointPlacement,
    Root,
    inertial_wrench,
    motions,
    places,
    rotations,
    stacked,
)
from graphdyn.scalars.vectors import PerJoint, Scalars, cross, turn

Wrench = tuple[Scalars, Scalars]
"""Force, and moment about O_j, in joint axes of body j."""

Loads = Sequence[Wrench] | None
"""External wrenches on the bodies."""


def transmitted(links: Links, at: Sequence[JointPlacement], needed: Sequence[Wrench], external: Loads) -> list[Wrench]:
    """Wrench of the inside body on body j: needed by body j and all bodies outside, less the external wrenches."""
    wrenches = unloaded(needed, external)
    for j in reversed(range(len(links))):
        i = links[j].inside
        if i >= 0:
            wrenches[i] = added(wrenches[i], inwards(at[j], wrenches[j]))
    return wrenches


def inwards(place: JointPlacement, wrench: Wrench) -> Wrench:
    """The same wrench in joint axes, and about the origin, of the inside body."""
    force, moment = place.inwards(wrench[0]), place.inwards(wrench[1])
    return force, moment + cross(place.translation, force)


def added(x: Wrench, y: Wrench) -> Wrench:
    return x[0] + y[0], x[1] + y[1]


def unloaded(needed: Sequence[Wrench], external: Loads) -> list[Wrench]:
    """What the joints must supply when external wrenches act on the bodies."""
    if external is None:
        return list(needed)
    return [(f - fx, n - nx) for (f, n), (fx, nx) in zip(needed, external, strict=True)]


def answers(
    links: Links, at: Sequence[JointPlacement], root: Root, moving: Sequence[BodyMotion], wrenches: Sequence[Wrench]
) -> dict[str, list[Any]]:
    """body_accelerations, multipliers and joint_wrenches as graphdyn states them, from joint axes."""
    to_world = rotations(links, at, root)
    multipliers, in_link_axes = [], []
    for link, place, (force, moment), rotation in zip(links, at, wrenches, to_world, strict=True):
        if link.prismatic:
            multipliers += [force[:2], moment]
        else:
            multipliers += [rotation @ force, turn(place.c, place.s, moment)[:2]]
        in_link_axes += [link.link_axes @ force, link.link_axes @ moment]
    return {
        "body_accelerations": _body_accelerations(links, root, moving, to_world),
        "multipliers": stacked(multipliers),
        "joint_wrenches": stacked(in_link_axes),
    }


def along_pins(
    links: Links, at: Sequence[JointPlacement], root: Root, moving: Sequence[BodyMotion], wrenches: Sequence[Wrench]
) -> dict[str, list[Any]]:
    """The same of robots with loops: forces and moments along t_1, t_2, p, which turn with the inside body."""
    multipliers, along = [], []
    for link, place, wrench in zip(links, at, wrenches, strict=True):
        force, moment = (turn(place.c, place.s, part) for part in wrench)
        multipliers += [force[:2], moment] if link.prismatic else [force, moment[:2]]
        along += [force, moment]
    return {
        "body_accelerations": _body_accelerations(links, root, moving, rotations(links, at, root)),
        "multipliers": stacked(multipliers),
        "joint_wrenches": stacked(along),
    }


def _body_accelerations(
    links: Links, root: Root, moving: Sequence[BodyMotion], to_world: Sequence[Scalars]
) -> list[Any]:
    """r̈ of the centers of mass in world axes, ω̇ in link axes."""
    accelerations = []
    for link, motion, rotation in zip(links, moving, to_world, strict=True):
        at_center = motion.compensated + motion.spread() @ link.center_of_mass
        accelerations += [rotation @ at_center + root.gravity, link.link_axes @ motion.alpha]
    return stacked(accelerations)


def in_joint_axes(links: Links, external: Scalars) -> list[Wrench]:
    """External wrenches (n, 6) from link axes, where they are about the link origin."""
    wrenches = []
    for link, wrench in zip(links, np.asarray(external), strict=True):
        force, moment = link.link_axes.T @ wrench[:3], link.link_axes.T @ wrench[3:]
        wrenches.append((force, moment - cross(np.array([0.0, 0.0, link.slide], dtype=object), force)))
    return wrenches


REACTIONS = {
    "body_accelerations": ArraySpec(("bodies", BODY_DOF), "m/s², rad/s²"),
    "multipliers": ArraySpec(("bodies", JOINT_CONSTRAINTS), "N, N m"),
    "joint_wrenches": ArraySpec(("bodies", BODY_DOF), "N, N m"),
    "coupling_multipliers": ArraySpec(("couplings",), "N m or N"),
    "chord_multipliers": ArraySpec(("chord rows",), "N, N m"),
}
"""What forward and inverse dynamics answer beside a or tau. Those of couplings and chords come from what records them
(graphdyn.compiler.programs)."""


@recursion(tau=TORQUES, **REACTIONS)
def inverse_dynamics(
    links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads = None
) -> dict[str, list[Any]]:
    """tau, body_accelerations, multipliers and joint_wrenches of graphdyn.inverse_dynamics."""
    at = places(links, q)
    moving = motions(links, at, root, v, a)
    wrenches = transmitted(links, at, [inertial_wrench(*pair) for pair in zip(links, moving, strict=True)], external)
    tau = [force[2] if link.prismatic else moment[2] for link, (force, moment) in zip(links, wrenches, strict=True)]
    return {"tau": tau, **answers(links, at, root, moving, wrenches)}


@recursion_of_torques(bias_torque=TORQUES)
def bias_torque(links: Links, root: Root, q: PerJoint, v: PerJoint) -> list[Any]:
    """tau at a = 0 (n)."""
    return inverse_dynamics(links, root, q, v, [0.0] * len(links))["tau"]


@recursion_of_torques(gravity_torque=TORQUES)
def gravity_torque(links: Links, root: Root, q: PerJoint) -> list[Any]:
    """tau at v = a = 0 (n)."""
    return bias_torque(links, root, q, [0.0] * len(links))


@recursion_of_torques(static_torque=TORQUES)
def static_torque(links: Links, root: Root, q: PerJoint, external: Loads = None) -> list[Any]:
    """tau at v = a = 0 against external wrenches (n)."""
    zeros = [0.0] * len(links)
    return inverse_dynamics(links, root, q, zeros, zeros, external)["tau"]


@recursion(power=ArraySpec(("n",), "W"))
def power(links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads = None) -> list[Any]:
    """τ_j v_j (n)."""
    tau = inverse_dynamics(links, root, q, v, a, external)["tau"]
    return [torque * rate for torque, rate in zip(tau, v, strict=True)]
