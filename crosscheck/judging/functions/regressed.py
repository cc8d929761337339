"""What the regressors of bodies and momenta give with inertial parameters, as people write it, its operations open to
slips: the wrench of each body alone, and the momenta M v of the joints.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    joint_placement,
    times,
    torque_recursion,
    turned,
    turned_back,
)
from crosscheck.judging.functions.motions import Motions, flat, motions, stacked
from crosscheck.judging.slips.body_wrenches import add_body_with_first_moments
from crosscheck.judging.slips.operations import NOT_TURNED, ONCE, WRONG_WAY, Operations
from graphdyn import Placement
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class BodyWrenches:
    """Force and moment about the link origin that move each body and hold its weight, in link axes (6 n, K, R).

    base: of the ground in the world
    """

    base: Placement

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        m = motions(code, x, state, do, self.base)
        zero = np.zeros((3, 1, 1))
        numbers: list[Array] = []
        for b, c in enumerate(x.centers):
            R = m.rotations[b + 1]
            w, dw, a = in_link_axes(m, b, x.gravity, do)
            own: tuple[list[Array], list[Array]] = [], []
            body = x.masses[b], c, c, x.tensors[b]
            add_body_with_first_moments(b, 0, body, do, ([w], [dw], [a], [zero]), own)
            f, n = own[0][0], own[1][0]
            pair = do.result("the wrench of the body", b, np.stack(np.broadcast_arrays(f, n)), {
                "in world axes": lambda: np.stack(np.broadcast_arrays(turned(R, f), turned(R, n))),
                "about the center of mass": lambda: np.stack(np.broadcast_arrays(f, n - crossed(c, f))),
            }, of="body")  # fmt: skip
            numbers += flat(pair)
        return stacked(numbers)


def in_link_axes(m: Motions, b: int, gravity: Array, do: Operations) -> Array:
    """ω, ω̇, and the acceleration of the link origin with gravity as an acceleration of the base, in link axes."""
    R, inside = m.rotations[b + 1], m.inside[b]
    pulled = do.result("gravity, as an acceleration of the base,", ONCE, -turned(m.rotations[0], gravity))
    place = do.result("a of the link origin", b, m.accelerations[b + 1], {
        "that of the inside link's origin": lambda: m.accelerations[inside] + 0 * m.accelerations[b + 1],
    }, of="body")  # fmt: skip
    world = np.stack(np.broadcast_arrays(m.omegas[b + 1], m.alphas[b + 1], place + pulled))
    turned_in = do.result("ω, ω̇ and a of the link, turned into its axes,", b, _each(turned_back, R, world), {
        NOT_TURNED: lambda: world + 0 * R[0], WRONG_WAY: lambda: _each(turned, R, world),
    }, of="body")  # fmt: skip
    names = ("ω of the link, turned into its axes,", "ω̇ of the link, turned into its axes,")
    found = [
        do.result(name, b, part, {NOT_TURNED: lambda: own + 0 * R[0], WRONG_WAY: lambda: turned(R, own)}, of="body")
        for name, part, own in zip(names, turned_in, world, strict=False)
    ]
    return np.stack(np.broadcast_arrays(*found, turned_in[2]))


def _each(turn: Callable[[Array, Array], Array], R: Array, vectors: Array) -> Array:
    return np.stack([turn(R, vector) for vector in vectors])


@dataclass(frozen=True)
class Momenta:
    """M v, by the momenta of the bodies, passed on like forces (n, K, R)."""

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        q, v, _ = state
        zero = np.zeros((3, 1, 1))
        omegas, speeds, attitudes = [zero], [zero], [np.eye(3)[:, :, None, None]]
        frames: list[tuple[Array, Array]] = []
        momenta: list[tuple[Array, Array]] = []
        for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
            p, w = x.axes[j], omegas[inside]
            turn, r = joint_placement(code, x, q, j)
            carried = do.outward("ω of the inside link", j, turn, w)
            swing = do.result("ω × r in the velocity of the link origin", j, crossed(w, r))
            speed = do.outward("the velocity of the inside link", j, turn, speeds[inside] + swing)
            omegas.append(carried + (0.0 * p if slides else p * v[j]))
            speeds.append(speed + (p * v[j] if slides else 0.0 * p))
            frames.append((turn, r))
            attitudes.append(times(attitudes[inside], turn))
            R = attitudes[-1]
            w_j = do.result("ω of the link in its momentum", j, omegas[-1], {
                "in world axes, not turned into the link": lambda: turned(R, omegas[-1]),
                "that of the inside link": lambda: turned_back(turn, omegas[inside]) + 0 * omegas[-1],
            }, of="body")  # fmt: skip
            v_j = do.result("v of the link origin in its momentum", j, speeds[-1], {
                "in world axes, not turned into the link": lambda: turned(R, speeds[-1]),
                "that of the inside link's origin": lambda: turned_back(turn, speeds[inside]) + 0 * speeds[-1],
            }, of="body")  # fmt: skip
            momenta.append(_momentum(j, x, w_j, v_j, do))
        found = []
        for j in reversed(range(len(code.inside))):
            (turn, r), (linear, angular) = frames[j], momenta[j]
            found.append((x.axes[j] * (linear if code.prismatic[j] else angular)).sum(axis=0))
            i = code.inside[j] - 1
            if i >= 0:
                back = do.inward("the momentum of the outer link, passed on,", j, turn, linear)
                lever = do.result("r × p of the outer link's momentum", j, crossed(r, back))
                spin = do.inward("the angular momentum of the outer link, passed on,", j, turn, angular)
                momenta[i] = momenta[i][0] + back, momenta[i][1] + spin + lever
        return stacked(found[::-1])

    def right(self, code: DynamicsCode, x: Numbers, state: State) -> Array:
        """Without slips."""
        q, v, _ = state
        return torque_recursion(code, replace(x, gravity=0 * x.gravity), (q, 0 * v, v))


def _momentum(j: int, x: Numbers, w: Array, speed: Array, do: Operations) -> tuple[Array, Array]:
    """Linear and angular momentum of a body about its link origin, linear in mass, first moment and I."""
    mass, c, tensor = x.masses[j], x.centers[j], x.tensors[j]
    first = mass * c
    linear = do.result("m v in the momentum", j, mass * speed, of="body")
    linear = linear + do.result("ω × m c in the momentum", j, crossed(w, first), of="body")
    about = turned(tensor, w) + crossed(first, crossed(w, c))
    angular = do.result("I ω, I about the link origin,", j, about, {
        "taken with J about the center of mass": lambda: turned(tensor, w),
    }, of="body")  # fmt: skip
    angular = angular + do.result("m c × v in the angular momentum", j, crossed(first, speed), of="body")
    return linear, do.result("the angular momentum of the body", j, angular, {
        "taken about the center of mass": lambda: angular - crossed(c, linear),
        "added as if the momentum were at the center of mass": lambda: angular + crossed(c, linear),
    }, of="body")  # fmt: skip
