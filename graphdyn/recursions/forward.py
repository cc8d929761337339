"""Forward dynamics: Eq. (111) by elimination from leaf to root.

Joint j and body j are a leaf of the system: 6 accelerations, 5 multipliers and the joint's own acceleration appear in
the equations of body j and of its inside body only. Eliminating them adds an inertia and a wrench to the inside body:
those of Featherstone's articulated body, seen through its joint ("The calculation of robot dynamics using
articulated-body inertias", International Journal of Robotics Research 2(1), 1983; "Rigid Body Dynamics Algorithms",
2008, section 7.3, whose symbols are used here). At the root nothing is left to eliminate; substituting back outwards
yields all accelerations, and all multipliers on the way.

The unknowns are the accelerations beyond those at a = 0, so that velocity and gravity enter as wrenches only; the
velocity-product accelerations c of Featherstone's form are among those at a = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.recursions.declarations import ACCELERATIONS, recursion
from graphdyn.recursions.inertia import is_short, joint_accelerations, reciprocal
from graphdyn.recursions.inverse import REACTIONS, Loads, Wrench, added, answers, inwards, unloaded
from graphdyn.recursions.mechanism.mechanism import Link, Links
from graphdyn.recursions.motion import BodyMotion, JointPlacement, Root, inertial_wrench, motions, places
from graphdyn.scalars.vectors import E_Z, PerJoint, Scalars, cross, is_known, skew, symmetric, zeros


@dataclass(frozen=True, eq=False)
class Inertia:
    """f = M a + H α, n = Hᵀ a + J α about O_j."""

    m: Scalars
    h: Scalars
    j: Scalars

    @classmethod
    def of(cls, link: Link) -> Inertia:
        mass = zeros(3, 3)
        np.fill_diagonal(mass, link.mass)
        return cls(mass, -skew(link.first_moment), link.tensor)

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(self.m + other.m, self.h + other.h, self.j + other.j)

    def times(self, a: Scalars, alpha: Scalars) -> Wrench:
        return self.m @ a + self.h @ alpha, self.h.T @ a + self.j @ alpha

    def inwards(self, place: JointPlacement) -> Inertia:
        """The same inertia in joint axes, and about the origin, of the inside body."""
        m = symmetric(place.symmetric_inwards(self.m))
        h = place.matrix_inwards(self.h)
        p = skew(place.translation)
        # f = M (a - p × α) + H α about the new origin, with p × α = S(p) α; the moment of f by the arm p follows
        shifted = h - m @ p
        return Inertia(m, shifted, symmetric(place.symmetric_inwards(self.j) - h.T @ p + p @ shifted))


@dataclass(frozen=True, eq=False)
class SeenThroughJoint:
    """The articulated body j as its inside body sees it, through joint j with motion subspace S.

    inertia, bias: I^a and p^a
    U: I^A S, force and moment per unit of joint acceleration; D_inverse: 1 / D, D = Sᵀ U
    u: τ - Sᵀ p^A
    """

    inertia: Inertia
    bias: Wrench
    U: Wrench
    D_inverse: Any
    u: Any


@dataclass(frozen=True, eq=False)
class Drives:
    """What a simulation adds to the joints (graphdyn.compiler.simulated).

    rotor: inertia of rotor and gear as seen at the joint, D = Sᵀ U + rotor
    free: 1, or 0 where friction holds the joint, whose a is then exactly zero
    """

    rotor: Sequence[Any]
    free: Sequence[Any]


@recursion(a=ACCELERATIONS, **REACTIONS)
def forward_dynamics(
    links: Links,
    root: Root,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads = None,
    joints_only: bool = False,
    *,
    drives: Drives | None = None,
) -> dict[str, list[Any]]:
    """a, body_accelerations, multipliers and joint_wrenches of graphdyn.forward_dynamics; pivots: D of each joint.

    joints_only: whether a and pivots are enough
    required: the torque that bodies and rotor take; tau, except of a joint that is held
    """
    if joints_only and is_short(links):
        return joint_accelerations(links, root, q, v, tau, external)
    rotor, free = (drives.rotor, drives.free) if drives else ([0.0] * len(links), [1.0] * len(links))
    at = places(links, q)
    at_rest = motions(links, at, root, v, [0.0] * len(links))
    inertias = [Inertia.of(link) for link in links]  # I^A and p^A, once all bodies outside are added
    biases = unloaded([inertial_wrench(*pair) for pair in zip(links, at_rest, strict=True)], external)
    pivots: list[Any] = [None] * len(links)
    required: list[Any] = []
    seen: dict[int, SeenThroughJoint] = {}
    for j in reversed(range(len(links))):
        pivots[j] = inertias[j].m[2, 2] if links[j].prismatic else inertias[j].j[2, 2]
        leaf = seen[j] = seen_through_joint(links[j].prismatic, inertias[j], biases[j], tau[j], rotor[j], free[j])
        i = links[j].inside
        if i >= 0:
            inertias[i] = inertias[i] + leaf.inertia.inwards(at[j])
            biases[i] = added(biases[i], inwards(at[j], leaf.bias))
    accelerations: list[Any] = []
    moving, transmitted = [], []
    gained: list[tuple[Scalars, Scalars]] = []
    for j, (link, place, motion) in enumerate(zip(links, at, at_rest, strict=True)):
        inside = gained[link.inside] if link.inside >= 0 else (zeros(3), zeros(3))
        a_j, (linear, angular), wrench = accelerated(link, place, seen[j], inside)
        required.append(wrench[0 if link.prismatic else 1][2] + rotor[j] * a_j)
        transmitted.append(wrench)
        accelerations.append(a_j)
        gained.append((linear, angular))
        moving.append(BodyMotion(motion.omega, motion.alpha + angular, motion.compensated + linear))
    reactions = answers(links, at, root, moving, transmitted)
    return {"a": accelerations, "pivots": pivots, "required": required, **reactions}


def accelerated(
    link: Link, place: JointPlacement, leaf: SeenThroughJoint, inside: tuple[Scalars, Scalars]
) -> tuple[Any, tuple[Scalars, Scalars], Wrench]:
    """Acceleration of joint j, those of O_j and ω̇ of body j beyond a = 0, and what the joint transmits.

    inside: accelerations of the inside body beyond a = 0
    """
    linear = place.outwards(inside[0] + cross(inside[1], place.translation))
    angular = place.outwards(inside[1])
    a_j = leaf.D_inverse * (leaf.u - (leaf.U[0] @ linear + leaf.U[1] @ angular))
    wrench = added(leaf.inertia.times(linear, angular), leaf.bias)
    if link.prismatic:
        return a_j, (linear + E_Z * a_j, angular), wrench
    return a_j, (linear, angular + E_Z * a_j), wrench


def seen_through_joint(
    prismatic: bool, inertia: Inertia, bias: Wrench, tau: Any, rotor: Any = 0.0, free: Any = 1.0
) -> SeenThroughJoint:
    """I^a = I^A - U Uᵀ / D and p^a = p^A + U u / D, of I^A (inertia) and p^A (bias)."""
    force, moment = bias
    # S is the unit vector e_z, of the linear part for a slide and of the angular part for a turn: I^A S is a column
    U_f, U_n = (inertia.m[:, 2], inertia.h[2, :]) if prismatic else (inertia.h[:, 2], inertia.j[:, 2])
    D_inverse = reciprocal((U_f[2] if prismatic else U_n[2]) + rotor) * free
    u = tau - (force[2] if prismatic else moment[2])
    f, n = U_f * D_inverse, U_n * D_inverse
    reduced = Inertia(
        symmetric(inertia.m - np.outer(f, U_f)),
        inertia.h - np.outer(f, U_n),
        symmetric(inertia.j - np.outer(n, U_n)),
    )
    reduced_f, reduced_n = force + f * u, moment + n * u
    if not (is_known(rotor, 0.0) and is_known(free, 1.0)):
        return SeenThroughJoint(reduced, (reduced_f, reduced_n), (U_f, U_n), D_inverse, u)
    if prismatic:  # I^a S = 0 and Sᵀ p^a = τ, without rounding
        reduced.m[2, :] = reduced.m[:, 2] = reduced.h[2, :] = 0.0
        reduced_f[2] = tau
    else:
        reduced.j[2, :] = reduced.j[:, 2] = reduced.h[:, 2] = 0.0
        reduced_n[2] = tau
    return SeenThroughJoint(reduced, (reduced_f, reduced_n), (U_f, U_n), D_inverse, u)
