"""Center of mass, momentum and energies as people write them: sums over the bodies, in world axes."""

# ruff: noqa: B023 - the functions are called before the next body

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, crossed, turned, turned_back
from crosscheck.judging.functions.motions import Motions, flat, motions, stacked
from crosscheck.judging.slips.operations import ONCE, Operations
from crosscheck.judging.slips.turning import center_in_world, tensor_in_world
from crosscheck.quantities.measures import Chosen
from graphdyn import Placement
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class MovingBody:
    """Mass, center of mass from the link origin and in the world, its velocity, tensor in world axes, ω."""

    mass: Array
    offset: Array
    center: Array
    velocity: Array
    tensor: Array
    omega: Array


@dataclass(frozen=True, eq=False)
class BodySums:
    """The functions of all bodies together.

    base: of the ground in the world; chosen: about, order
    """

    base: Placement
    chosen: Chosen

    def center(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """The center of mass (3, K, R)."""
        bodies = self._bodies(code, x, state, do)[1]
        return stacked(list(self._mean([body.center for body in bodies], bodies, do)))

    def velocity(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """Velocity of the center of mass (3, K, R)."""
        bodies = self._bodies(code, x, state, do)[1]
        return stacked(list(self._mean([body.velocity for body in bodies], bodies, do)))

    def jacobian(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """Jacobian of the center of mass, row by row (3 n, K, R)."""
        m, bodies = self._bodies(code, x, state, do)
        center = self._mean([body.center for body in bodies], bodies, Operations([], 1))
        columns = []
        for j, (z, slides) in enumerate(zip(m.axes, code.prismatic, strict=True)):
            o = m.origins[j + 1]
            moved = [(z if slides else crossed(z, body.center - o)) + 0 * body.center for body in bodies]
            outside = [x if j in m.chain(b + 1) else 0 * x for b, x in enumerate(moved)]
            without_own = [0 * x if b == j else x for b, x in enumerate(outside)]
            column = self._mean(outside, bodies, do)
            whole, less = (self._mean(vectors, bodies, Operations([], 1)) for vectors in (moved, without_own))
            total, moving = (
                sum((x.masses[b] for b in range(len(bodies)) if every or j in m.chain(b + 1)), 0 * x.masses[j])
                for every in (True, False)
            )
            columns.append(do.result("the column of the center of mass", j, column, {
                "divided by the mass that moves with the joint, not by all of it": lambda: column * total / moving,
                "taken without the body of its own joint": lambda: less,
                "taken of all bodies, of those inside the joint too": lambda: whole,
                "taken with levers to the center of mass of the whole robot": lambda: (
                    column if slides else crossed(z, center - o) * moving / total
                ),
                "taken of the center of mass of the whole robot, as if all of it moved": lambda: (
                    z + 0 * center if slides else crossed(z, center - o)
                ),
            }))  # fmt: skip
        return stacked([column[i] for i in range(3) for column in columns])

    def momentum(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """Linear, then angular (6, K, R)."""
        m, bodies = self._bodies(code, x, state, do)
        linear = [do.result("m ċ in the momentum", b, body.mass * body.velocity, {
            "taken with the velocity of the link origin": lambda: (
                body.mass * (body.velocity - crossed(body.omega, body.offset))
            ),
        }, of="body") for b, body in enumerate(bodies)]  # fmt: skip
        whole = self._mean([body.center for body in bodies], bodies, do)
        if self.chosen["about"] != "the center of mass":
            whole = 0 * whole
        centers = [body.center for body in bodies]
        whole = do.result("the point about which the angular momentum is", ONCE, whole, {
            "the mean of the centers, not weighted by masses": lambda: sum(centers[1:], centers[0]) / len(centers),
            "taken with the opposite sign, c + c_all": lambda: -whole,
        })  # fmt: skip
        angular = []
        for b, (body, pushed) in enumerate(zip(bodies, linear, strict=True)):
            inside = m.omegas[code.inside[b]]
            spin = do.result("J ω in the angular momentum", b, turned(body.tensor, body.omega), {
                "taken with ω of the inside link": lambda: turned(body.tensor, inside) + 0 * body.omega,
                "taken with ω of the outer link": lambda: turned(
                    body.tensor, m.omegas[outer[0] + 1] if (outer := _outside(code, b)) else body.omega
                ),
            }, of="body")  # fmt: skip
            lever = do.result("the moment of momentum (c − c_all) × m ċ", b, crossed(body.center - whole, pushed), {
                "taken without m": lambda: crossed(body.center - whole, body.velocity),
                "taken about the world's origin": lambda: crossed(body.center, pushed),
                "taken of the link origin": lambda: crossed(body.center - body.offset - whole, pushed),
                "taken with c of the link alone": lambda: crossed(body.offset, pushed),
                "taken about the origin of the first link": lambda: crossed(body.center - m.origins[1], pushed),
            }, of="body")  # fmt: skip
            angular.append(spin + lever)
        pushed = do.result("the linear momentum, a sum,", ONCE, sum(linear[1:], linear[0]), {
            "taken with the velocities of the link origins": lambda: np.sum(
                [body.mass * (body.velocity - crossed(body.omega, body.offset)) for body in bodies], axis=0
            ),
        })  # fmt: skip
        found = stacked(flat([pushed, sum(angular[1:], angular[0])]))
        return self._ordered(found)

    def centroidal_map(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """The momentum of unit velocities, row by row (6 n, K, R)."""
        q = state[0]
        n, rows = len(q), q.shape[-1]
        unit = np.eye(n)[:, None, :, None] + np.zeros((n, 1, n, rows))
        wide = np.tile(q, (1, 1, n))
        do.see(rows * n, float)
        found = self.momentum(code, x, (wide, unit.reshape(n, 1, -1), 0 * wide), do)
        found = np.broadcast_to(found, (*found.shape[:-1], rows * n))
        found = found.reshape(6, found.shape[1], n, rows)
        do.see(rows, float)
        return np.moveaxis(found, 2, 1).reshape(6 * n, -1, rows)

    def kinetic_energy(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """½ m ṙ² + ½ ωᵀ J ω (1, K, R)."""
        m, bodies = self._bodies(code, x, state, do)
        total: Array = np.zeros((1, 1))
        for b, body in enumerate(bodies):
            R = m.rotations[b + 1]
            moving = body.mass * (body.velocity**2).sum(axis=0) / 2
            turning = (body.omega * turned(body.tensor, body.omega)).sum(axis=0) / 2
            at_origin = body.velocity - crossed(body.omega, body.offset)
            total = total + do.result("½ m ċ²", b, moving, {
                "taken with the velocity of the link origin": lambda: body.mass * (at_origin**2).sum(axis=0) / 2,
            }, of="body")  # fmt: skip
            total = total + do.result("½ ωᵀ J ω", b, turning, {
                "taken with ω in world axes and J in link axes": lambda: (
                    (body.omega * turned(x.tensors[b], body.omega)).sum(axis=0) / 2 + 0 * R[0, 0]
                ),
                "taken with J about the link origin": lambda: (
                    turning + body.mass * (crossed(body.omega, body.offset) ** 2).sum(axis=0) / 2
                ),
            }, of="body")  # fmt: skip
        return stacked([total])

    def potential_energy(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """−m gᵀ r (1, K, R)."""
        m, bodies = self._bodies(code, x, state, do)
        g = turned(m.rotations[0], x.gravity)
        total: Array = np.zeros((1, 1))
        for b, body in enumerate(bodies):
            weight = body.mass * x.weight[b]
            total = total + do.result("m g h", b, -weight * (g * body.center).sum(axis=0), {
                "taken of the link origin": lambda: -weight * (g * (body.center - body.offset)).sum(axis=0),
                "taken with the length of r, not its height": lambda: (
                    weight * np.sqrt((g * g).sum(axis=0) * (body.center**2).sum(axis=0))
                ),
            }, of="body")  # fmt: skip
        return stacked([total])

    def _bodies(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> tuple[Motions, list[MovingBody]]:
        m = motions(code, x, state, do, self.base)
        bodies = []
        for b, inside in enumerate(code.inside):
            R, before, c, J = m.rotations[b + 1], m.rotations[inside], x.centers[b], x.tensors[b]
            name = "c, the center of mass from the link origin in world axes,"
            offset = center_in_world(name, b, R, before, c, do, "body")
            tensor = tensor_in_world(b, R, before, J, do, "body")
            w = do.result("ω of the link", b, m.omegas[b + 1], {
                "that of the inside link": lambda: m.omegas[inside] + 0 * m.omegas[b + 1],
                "that of its own joint alone, relative to the inside link": lambda: m.omegas[b + 1] - m.omegas[inside],
            }, of="body")  # fmt: skip
            speed = do.result("the velocity of the link origin", b, m.velocities[b + 1], {
                "that of the inside link's origin": lambda: m.velocities[inside] + 0 * m.velocities[b + 1],
            }, of="body")  # fmt: skip
            swing = do.result("ω × c in the velocity of the center of mass", b, crossed(w, offset), {
                "taken with ω of the inside link": lambda: crossed(m.omegas[inside], offset),
                "taken with ω in link axes": lambda: crossed(turned_back(R, w), offset),
            }, of="body")  # fmt: skip
            origin = do.result("the place of the link origin", b, m.origins[b + 1], {
                "that of the inside link's origin": lambda: m.origins[inside] + 0 * m.origins[b + 1],
            }, of="body")  # fmt: skip
            mass = do.result("the mass", b, x.masses[b], {
                "taken as 1 kg": lambda: 1.0 + 0 * x.masses[b],
                "taken in grams": lambda: 1000 * x.masses[b],
                "that of the body and all outside of it": lambda: sum(
                    (x.masses[k] for k in range(len(code.inside)) if b in m.chain(k + 1)), 0 * x.masses[b]
                ),
            }, of="body")  # fmt: skip
            bodies.append(MovingBody(mass, offset, origin + offset, speed + swing, tensor, w + 0 * offset))
        return m, bodies

    def _mean(self, vectors: list[Array], bodies: list[MovingBody], do: Operations) -> Array:
        """The mean of vectors of the bodies, with their masses as weights."""
        parts, masses = [], []
        for b, (vector, body) in enumerate(zip(vectors, bodies, strict=True)):
            parts.append(do.result("m r in the sum over the bodies", b, body.mass * vector, of="body"))
            masses.append(do.result("m in the mass of all bodies", b, body.mass, of="body"))
        mean: Array = sum(parts[1:], parts[0]) / sum(masses[1:], masses[0])
        return mean

    def _ordered(self, answer: Array) -> Array:
        return np.roll(answer, 3, axis=0) if self.chosen["order"] == "angular first" else answer


def _outside(code: DynamicsCode, b: int) -> list[int]:
    """Numbers of the bodies next to body b on its outside, all from 0."""
    return [k for k, inside in enumerate(code.inside) if inside == b + 1]
