"""Places and motions of all links in world axes, link after link, of many codes at once; its operations open to slips.

Siciliano et al., "Robotics: Modeling, Planning and Control", sections 3.1 and 7.2.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    times,
    turned,
    turned_about,
    turned_back,
)
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations
from crosscheck.judging.slips.turning import WITH_THE_INSIDE, WITH_THE_OUTER
from graphdyn import Placement
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Motions:
    """Motions of the ground, number 0, and of the links (3, …).

    They are rotations (3, 3, …), origins, their velocities and accelerations, ω and ω̇; axes of the joints and arms from
    the inside link's origin by their own numbers from 0.

    inside: number of the inside body of each joint
    """

    inside: tuple[int, ...]
    prismatic: tuple[bool, ...]
    rotations: list[Array] = field(default_factory=list)
    origins: list[Array] = field(default_factory=list)
    velocities: list[Array] = field(default_factory=list)
    accelerations: list[Array] = field(default_factory=list)
    omegas: list[Array] = field(default_factory=list)
    alphas: list[Array] = field(default_factory=list)
    axes: list[Array] = field(default_factory=list)
    arms: list[Array] = field(default_factory=list)

    def chain(self, body: int) -> list[int]:
        """The joints from the ground to a body, by number from 0."""
        found = []
        while body > 0:
            found.append(body - 1)
            body = self.inside[body - 1]
        return found[::-1]


def places(code: DynamicsCode, x: Numbers, q: Array, do: Operations, base: Placement) -> Motions:
    """Rotations, origins and axes alone. base: of the ground in the world"""
    m = Motions(code.inside, code.prismatic)
    m.rotations.append(base.rotation[:, :, None, None])
    m.origins.append(base.translation[:, None, None])
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p, before = x.axes[j], m.rotations[inside]
        turn = x.rotations[j] if slides else times(x.rotations[j], turned_about(p, q[j]))
        R = do.result("the rotation of the link", j, times(before, turn), {
            "taken in the opposite order": lambda: times(turn, before + 0 * turn),
            "taken without that of the inside link": lambda: turn + 0 * before,
        })  # fmt: skip
        local = x.translations[j]
        if slides:
            local = local + do.result("the slide p q", j, turned(x.rotations[j], p * q[j]), {
                "taken along the axis in world axes, not turned": lambda: turned_back(before, p * q[j]),
            })  # fmt: skip
        r = do.result("r of the joint in world axes", j, turned(before, local), {
            NOT_TURNED: lambda: local + 0 * before[0], WRONG_WAY: lambda: turned_back(before, local),
            WITH_THE_OUTER: lambda: turned(R, local),
        })  # fmt: skip
        z = do.result("the joint axis in world axes", j, turned(R, p), {
            NOT_TURNED: lambda: p + 0 * R[0], WRONG_WAY: lambda: turned_back(R, p),
            WITH_THE_INSIDE: lambda: turned(before, p),
            "taken as z, whatever the file says": lambda: R[:, 2] + 0 * p,
        })  # fmt: skip
        m.rotations.append(R)
        m.origins.append(m.origins[inside] + r)
        m.arms.append(r)
        m.axes.append(z)
    return m


def motions(code: DynamicsCode, x: Numbers, state: State, do: Operations, base: Placement) -> Motions:
    """base: of the ground in the world."""
    q, v, a = state
    zero = np.zeros((3, 1, 1))
    m = places(code, x, q, do, base)
    for known in (m.velocities, m.accelerations, m.omegas, m.alphas):
        known.append(zero)
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        r, z, w, dw = m.arms[j], m.axes[j], m.omegas[inside], m.alphas[inside]
        spin, slide = (0.0 * z, z * v[j]) if slides else (z * v[j], 0.0 * z)
        carried = do.result("ω × r in the velocity of the link origin", j, crossed(w, r), {
            "taken with ω of the link, not of the inside one": lambda: crossed(w + spin, r),
        })  # fmt: skip
        kept = do.result("ω of the inside link in that of the link", j, w)
        kept_up = do.result("ω̇ of the inside link in that of the link", j, dw)
        moved = do.result("the velocity of the inside link in that of the link origin", j, m.velocities[inside])
        cross = do.result("the term ω × q̇ p in ω̇", j, x.cross[j] * crossed(w, spin))
        tangential = do.result("the term ω̇ × r in the acceleration of the link origin", j, crossed(dw, r))
        inward = crossed(w, crossed(w, r))
        around = do.result("the term ω × (ω × r) in the acceleration of the link origin", j, inward, {
            "taken as ω × v of the inside link": lambda: crossed(w, m.velocities[inside]) + 0 * r,
        })  # fmt: skip
        sliding = do.result("the term 2 ω × ṡ of sliding joints", j, 2 * crossed(w, slide))
        m.omegas.append(kept + spin)
        m.alphas.append(kept_up + cross + (0.0 * z if slides else z * a[j]))
        m.velocities.append(moved + carried + slide)
        m.accelerations.append(
            do.result("the acceleration of the inside link in that of the link origin", j, m.accelerations[inside])
            + tangential
            + around
            + sliding
            + (z * a[j] if slides else 0.0 * z)
        )
    return m


def stacked(numbers: Sequence[Array]) -> Array:
    """Numbers (K, R) side by side (D, K, R)."""
    return np.stack(np.broadcast_arrays(*numbers))


def flat(vectors: Iterable[Array]) -> list[Array]:
    """The numbers of vectors (3, K, R), one after the other."""
    return [x for vector in vectors for x in vector]
