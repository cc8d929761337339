"""Functions of one frame as people write them: placement, Jacobian, its rate, velocity, acceleration."""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, crossed, times, turned, turned_back
from crosscheck.judging.functions.motions import Motions, flat, motions, places, stacked
from crosscheck.judging.slips.operations import NOT_TURNED, ONCE, WRONG_WAY, Operations
from crosscheck.judging.slips.turning import WITH_THE_INSIDE
from crosscheck.quantities.measures import Chosen
from graphdyn import Frame, Placement
from graphdyn.layout import Array

Twist = tuple[Array, Array]
"""Linear and angular part (3, …)."""


@dataclass(frozen=True, eq=False)
class FrameFormulations:
    """The functions of one frame, read in one way.

    base: of the ground in the world; chosen: reference, order, acceleration
    """

    frame: Frame
    base: Placement
    chosen: Chosen

    def placement(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """[[R, p], [0, 1]], row by row (16, K, R)."""
        m = places(code, x, state[0], do, self.base)
        R, p, _ = self._placed(x, m, do)
        zero = 0 * p[0]
        rows = [number for i in range(3) for number in (*R[i], p[i])]
        return stacked([*rows, zero, zero, zero, zero + 1])

    def jacobian(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """Column by column z × (p − o), z (6 n, K, R), row by row."""
        m = places(code, x, state[0], do, self.base)
        placed = self._placed(x, m, do)
        p, offset = placed[1], placed[2]
        columns: list[Twist] = []
        for j, z in enumerate(m.axes):
            o, inside = m.origins[j + 1], code.inside[j]
            nothing = 0 * z + 0 * p
            if j not in m.chain(self.frame.body):
                filled = (z, 0 * z) if code.prismatic[j] else (crossed(z, p - o), z)
                hinge = np.stack([part + nothing for part in filled])
                pair = do.result("the column of a joint that does not move the frame", j, 0 * hinge, {
                    "filled in, as of one that does": lambda: hinge,
                })  # fmt: skip
                columns.append((pair[0], pair[1]))
                continue
            previous = m.axes[inside - 1] if inside > 0 else turned(m.rotations[0], np.eye(3)[2][:, None, None])
            if code.prismatic[j]:
                linear = do.result("the linear column z of a sliding joint", j, z + nothing, {
                    "taken as z × (p − o), as of a hinge": lambda: crossed(z, p - o) + nothing,
                })  # fmt: skip
                angular = do.result("the angular column of a sliding joint, zero,", j, nothing, {
                    "taken as z, as of a hinge": lambda: z + nothing,
                })  # fmt: skip
                linear, angular = do.result("the column of a sliding joint", j, np.stack([linear, angular]), {
                    "taken as that of a hinge, z × (p − o) and z": lambda: np.stack([
                        crossed(z, p - o) + nothing, z + nothing
                    ]),
                })  # fmt: skip
            else:
                linear = do.result("the linear column z × (p − o)", j, crossed(z, p - o) + nothing, {
                    "taken as z × p": lambda: crossed(z, p) + nothing,
                    "taken as z × o": lambda: crossed(z, o) + nothing,
                    "taken as z × (p − o) of the inside joint's o": lambda: (
                        crossed(z, p - m.origins[inside]) + nothing
                    ),
                    "taken at the link origin, not at the frame": lambda: crossed(z, p - offset - o) + nothing,
                    "taken with the axis of the joint before": lambda: crossed(previous, p - o) + nothing,
                    "taken with axis and origin of the joint before": lambda: (
                        crossed(previous, p - m.origins[inside]) + nothing
                    ),
                    "taken as z": lambda: z + nothing,
                })  # fmt: skip
                angular = do.result("the angular column z", j, z + nothing, {
                    "taken with the axis of the joint before": lambda: previous + nothing,
                })  # fmt: skip
            columns.append((linear, angular))
        columns = [self._read(m, placed, column, do) for column in columns]
        return self._matrix(columns)

    def velocity(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        m = motions(code, x, state, do, self.base)
        placed = self._placed(x, m, do)
        return self._six(self._read(m, placed, self._moving(m, placed[2], do), do))

    def rates(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """The rate of the Jacobian, ż × (p − o) + z × (ṗ − ȯ), ż (6 n, K, R)."""
        m = motions(code, x, state, do, self.base)
        placed = self._placed(x, m, do)
        p, offset = placed[1], placed[2]
        twist = self._moving(m, offset, do)
        columns: list[Twist] = []
        jacobian: list[Twist] = []
        for j, z in enumerate(m.axes):
            o, nothing = m.origins[j + 1], 0 * z + 0 * p
            if j not in m.chain(self.frame.body):
                columns.append((nothing, nothing))
                jacobian.append((nothing, nothing))
                continue
            w = m.omegas[code.inside[j]]
            dz = do.result("ż", j, crossed(w, z) + nothing, {
                "taken with ω of the frame's link, not of the joint's": lambda: crossed(twist[1], z) + nothing,
            })  # fmt: skip
            if code.prismatic[j]:
                columns.append((dz, nothing))
                jacobian.append((z + nothing, nothing))
                continue
            turning = do.result("the term ż × (p − o)", j, crossed(dz, p - o) + nothing, {
                "taken as ż × p": lambda: crossed(dz, p) + nothing,
            })  # fmt: skip
            moving = do.result("the term z × (ṗ − ȯ)", j, crossed(z, twist[0] - m.velocities[j + 1]) + nothing, {
                "taken as z × ṗ": lambda: crossed(z, twist[0]) + nothing,
                "taken with ȯ of the inside link": lambda: (
                    crossed(z, twist[0] - m.velocities[code.inside[j]]) + nothing
                ),
            })  # fmt: skip
            columns.append((turning + moving, dz))
            jacobian.append((crossed(z, p - o) + nothing, z + nothing))
        read = [
            self._rate_read(m, placed, column, own, twist, do) for column, own in zip(columns, jacobian, strict=True)
        ]
        return self._matrix(read)

    def acceleration(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        m = motions(code, x, state, do, self.base)
        R, p, offset = self._placed(x, m, do)
        b = self.frame.body
        w, dw = m.omegas[b], m.alphas[b]
        tangential = do.result("the term ω̇ × r of the frame", ONCE, crossed(dw, offset))
        around = do.result("the term ω × (ω × r) of the frame", ONCE, crossed(w, crossed(w, offset)))
        linear, angular = m.accelerations[b] + tangential + around, dw + 0 * p
        g = turned(m.rotations[0], x.gravity)
        linear = do.result("the acceleration", ONCE, linear, {
            "taken with gravity added": lambda: linear + g, "taken with gravity subtracted": lambda: linear - g,
            "taken with gravity subtracted, not turned into axes of the frame": lambda: linear - turned(R, g),
        })  # fmt: skip
        if self.chosen["acceleration"] == "spatial":
            right = motions(code, x, state, Operations([], state[0].shape[-1]), self.base)
            u = right.velocities[b] + crossed(right.omegas[b], offset)
            between = "ω × v, by which a spatial acceleration is less than a classical one,"
            linear = linear - do.result(between, ONCE, crossed(w, u))
            if self.chosen["reference"] == "world":
                linear = linear - crossed(angular, p)
        elif self.chosen["reference"] == "world":  # that of the point at the world's origin
            linear = linear - crossed(angular, p) - crossed(w, crossed(w, p))
        if self.chosen["reference"] == "local":
            linear, angular = turned_back(R, linear), turned_back(R, angular)
        return self._six((linear, angular))

    def _placed(self, x: Numbers, m: Motions, do: Operations) -> tuple[Array, Array, Array]:
        """Rotation and place of the frame, and where it is from its link's origin."""
        b, own = self.frame.body, self.frame.placement
        link, t = m.rotations[b], own.translation[:, None, None]
        offset = do.result("the offset of the frame from its link's origin", ONCE, turned(link, t), {
            NOT_TURNED: lambda: t + 0 * link[0], WRONG_WAY: lambda: turned_back(link, t),
            WITH_THE_INSIDE: lambda: turned(m.rotations[m.inside[b - 1]], t),
            "that of the link's center of mass": lambda: turned(link, x.centers[b - 1]),
        })  # fmt: skip
        rf = own.rotation[:, :, None, None]
        R = do.result("the rotation of the frame", ONCE, times(link, rf), {
            "taken as that of its link": lambda: link + 0 * rf,
            "taken in the opposite order, of the frame in its link before that of the link": lambda: times(rf, link),
            "taken with that of the frame in its link transposed": lambda: times(link, np.swapaxes(rf, 0, 1)),
        })  # fmt: skip
        return R, m.origins[b] + offset, offset

    def _moving(self, m: Motions, offset: Array, do: Operations) -> Twist:
        b = self.frame.body
        w = m.omegas[b]
        swing = do.result("the term ω × r of the frame's offset", ONCE, crossed(w, offset))
        return m.velocities[b] + swing, w + 0 * swing

    def _read(self, m: Motions, placed: tuple[Array, Array, Array], twist: Twist, do: Operations) -> Twist:
        """A twist at the frame in world axes, in the reference; or one part in another reference."""
        R, p, _ = placed
        linear, angular = twist
        ways: dict[str, Callable[[], Array]] = {
            "local_world_aligned": lambda: linear + 0 * p,
            "world": lambda: linear - crossed(angular, p),
            "local": lambda: turned_back(R, linear + 0 * p),
        }
        turns: dict[str, Callable[[], Array]] = {
            "local_world_aligned or world": lambda: angular + 0 * p,
            "local": lambda: turned_back(R, angular + 0 * p),
        }  # fmt: skip
        reference = self.chosen["reference"]
        in_axes = "local" if reference == "local" else "local_world_aligned or world"
        mixed = {f"that of '{way}', the angular part that of '{in_axes}'": ways[way] for way in ways}
        mixed["in every row the sum of its three rows, as by a matrix of ones"] = lambda: (
            ways[reference]().sum(axis=0) + 0 * p
        )
        mixed["moved to the world's origin the wrong way"] = lambda: linear + crossed(angular, p)
        turned_mixed = {f"that of '{way}', the linear part that of '{reference}'": turns[way] for way in turns}
        mixed["turned from local to world axes once more"] = lambda: turned(R, linear + 0 * p)
        turned_mixed["turned from local to world axes once more"] = lambda: turned(R, angular + 0 * p)
        parts = (
            do.result("the linear part", ONCE, ways[reference](), mixed),
            do.result("the angular part", ONCE, turns[in_axes](), turned_mixed),
        )
        both = do.result("the whole twist", ONCE, np.stack(np.broadcast_arrays(*parts)), {
            "turned with R, from local to world axes, in place of Rᵀ": lambda: np.stack(
                [turned(R, linear + 0 * p), turned(R, angular + 0 * p)]
            ),
        })  # fmt: skip
        return both[0], both[1]

    def _rate_read(
        self, m: Motions, placed: tuple[Array, Array, Array], rate: Twist, own: Twist, twist: Twist, do: Operations
    ) -> Twist:
        """The rate of a twist at the frame in world axes, in the reference. own: the twist; twist: of the frame"""
        R, p, _ = placed
        linear, angular = rate
        v, w = twist
        if self.chosen["reference"] == "world":
            moved = do.result("the term z × ṗ of the reference's point", ONCE, crossed(own[1], v))
            return linear - crossed(angular, p) - moved, angular + 0 * p
        if self.chosen["reference"] == "local":
            turning = np.stack(np.broadcast_arrays(crossed(w, own[0]), crossed(w, own[1])))
            turning = do.result("the term ω × J of the axes that turn", ONCE, turning)
            return turned_back(R, linear - turning[0]), turned_back(R, angular - turning[1])
        return linear + 0 * p, angular + 0 * p

    def _six(self, twist: Twist) -> Array:
        return self._ordered(stacked(flat(twist)))

    def _matrix(self, columns: Sequence[Twist]) -> Array:
        """Row by row."""
        return self._ordered(stacked([column[part][i] for part in range(2) for i in range(3) for column in columns]))

    def _ordered(self, answer: Array) -> Array:
        """Six numbers or rows in the chosen order."""
        return np.roll(answer, len(answer) // 2, axis=0) if self.chosen["order"] == "angular first" else answer
