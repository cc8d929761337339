"""Forward dynamics: Eq. (111) by elimination from leaf to root.

Joint j and body j are a leaf of the system: 6 accelerations, 5 multipliers and the joint's own acceleration appear in
the equations of body j and of its inside body only. Eliminating them adds to the inside body an inertia and a wrench as
if body j were part of it, free to move along the joint: Featherstone's articulated body ("The calculation of robot
dynamics using articulated-body inertias", International Journal of Robotics Research 2(1), 1983). At the root nothing
is left to eliminate; substituting back outwards yields all accelerations, and all multipliers on the way.

The unknowns are the accelerations beyond those at a = 0, so that velocity and gravity enter as wrenches only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Ground, Motion, Place, inertial_wrench, motions, places
from graphdyn.kernels.reactions import Wrench, added, answers, inwards, unloaded
from graphdyn.kernels.vectors import E_Z, Scalars, cross, scalars, skew, symmetric, zeros


@dataclass(frozen=True, eq=False)
class Inertia:
    """f = M a + H α, n = Hᵀ a + J α about O_j."""

    m: Scalars
    h: Scalars
    j: Scalars

    @classmethod
    def of(cls, link: Link) -> Inertia:
        return cls(scalars(link.mass * np.eye(3)), -skew(link.first_moment), link.tensor)

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(self.m + other.m, self.h + other.h, self.j + other.j)

    def times(self, a: Scalars, alpha: Scalars) -> Wrench:
        return self.m @ a + self.h @ alpha, self.h.T @ a + self.j @ alpha

    def inwards(self, place: Place) -> Inertia:
        """The same inertia in joint axes, and about the origin, of the inside body."""
        m = symmetric(place.symmetric_inwards(self.m))
        h = place.matrix_inwards(self.h)
        p = skew(place.translation)
        shifted = h - m @ p
        return Inertia(m, shifted, symmetric(place.symmetric_inwards(self.j) - h.T @ p + p @ shifted))


@dataclass(frozen=True, eq=False)
class Eliminated:
    """Body j with everything outside, as its inside body sees it across the free joint.

    inertia, wrench: of the articulated body once the joint gives way
    column: force and moment per unit of joint acceleration; yielding: 1 / d, joint acceleration per unit of torque
    surplus: torque left when the inside body does not accelerate
    """

    inertia: Inertia
    wrench: Wrench
    column: Wrench
    yielding: Any
    surplus: Any


def forward_dynamics(
    links: Sequence[Link],
    ground: Ground,
    q: Sequence[Any],
    v: Sequence[Any],
    tau: Sequence[Any],
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """a, body_accelerations, multipliers and joint_wrenches of graphdyn.forward_dynamics; pivots: d of each joint."""
    at = places(links, q)
    at_rest = motions(links, at, ground, v, [0.0] * len(links))
    inertias = [Inertia.of(link) for link in links]
    wrenches = unloaded([inertial_wrench(*pair) for pair in zip(links, at_rest, strict=True)], external)
    pivots: list[Any] = [None] * len(links)
    leaves: dict[int, Eliminated] = {}
    for j in reversed(range(len(links))):
        pivots[j] = inertias[j].m[2, 2] if links[j].prismatic else inertias[j].j[2, 2]
        leaf = leaves[j] = eliminate(links[j].prismatic, inertias[j], wrenches[j], tau[j])
        i = links[j].inside
        if i >= 0:
            inertias[i] = inertias[i] + leaf.inertia.inwards(at[j])
            wrenches[i] = added(wrenches[i], inwards(at[j], leaf.wrench))
    accelerations: list[Any] = []
    moving, through = [], []
    gained: list[tuple[Scalars, Scalars]] = []
    for j, (link, place, motion) in enumerate(zip(links, at, at_rest, strict=True)):
        leaf = leaves[j]
        a_i, alpha_i = gained[link.inside] if link.inside >= 0 else (zeros(3), zeros(3))
        linear = place.outwards(a_i + cross(alpha_i, place.translation))
        angular = place.outwards(alpha_i)
        own = leaf.yielding * (leaf.surplus - (leaf.column[0] @ linear + leaf.column[1] @ angular))
        through.append(added(leaf.inertia.times(linear, angular), leaf.wrench))
        if link.prismatic:
            linear = linear + E_Z * own
        else:
            angular = angular + E_Z * own
        accelerations.append(own)
        gained.append((linear, angular))
        moving.append(Motion(motion.omega, motion.alpha + angular, motion.felt + linear))
    return {"a": accelerations, "pivots": pivots, **answers(links, at, ground, moving, through)}


def eliminate(prismatic: bool, inertia: Inertia, wrench: Wrench, torque: Any) -> Eliminated:
    """Let the joint give way: what it takes along its axis is the torque, whatever the accelerations."""
    force, moment = wrench
    column_f, column_n = (inertia.m[:, 2], inertia.h[2, :]) if prismatic else (inertia.h[:, 2], inertia.j[:, 2])
    own = force[2] if prismatic else moment[2]
    yielding = _reciprocal(column_f[2] if prismatic else column_n[2])
    surplus = torque - own
    f, n = column_f * yielding, column_n * yielding
    left = Inertia(
        symmetric(inertia.m - np.outer(f, column_f)),
        inertia.h - np.outer(f, column_n),
        symmetric(inertia.j - np.outer(n, column_n)),
    )
    kept_f, kept_n = force + f * surplus, moment + n * surplus
    if prismatic:  # exactly nothing, and exactly the torque
        left.m[2, :] = left.m[:, 2] = left.h[2, :] = 0.0
        kept_f[2] = torque
    else:
        left.j[2, :] = left.j[:, 2] = left.h[:, 2] = 0.0
        kept_n[2] = torque
    return Eliminated(left, (kept_f, kept_n), (column_f, column_n), yielding, surplus)


def _reciprocal(pivot: Any) -> Any:
    """1 / d, infinite where d is known to be zero: a joint without inertia, which its pivot then tells."""
    return math.inf if isinstance(pivot, float | int) and pivot == 0 else 1.0 / pivot
