"""Wrenches and multipliers of the joints as people write them, many codes at once; the recursion open to slips."""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    turned,
    turned_about,
    turned_back,
    wrenches,
)
from crosscheck.judging.functions.motions import flat, places, stacked
from crosscheck.judging.slips.link_axes import LinkAxes
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations, turn_product
from crosscheck.quantities.measures import Chosen
from graphdyn import Placement
from graphdyn.layout import Array

IN_LINK_AXES = LinkAxes()


@dataclass(frozen=True, eq=False)
class JointWrenches:
    """Forces and moments of the joints about the link origins (6 n, K, R).

    base: of the ground in the world; chosen: the conventions that a code follows; by: the recursion open to slips
    """

    base: Placement
    chosen: Chosen
    by: LinkAxes = IN_LINK_AXES

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        return self._read(code, x, state, do, self.by.joint_wrenches(code, x, state, do))

    def right(self, code: DynamicsCode, x: Numbers, state: State) -> Array:
        """Without slips."""
        return self._read(code, x, state, Operations([], state[0].shape[-1]), wrenches(code, x, state))

    def _read(
        self, code: DynamicsCode, x: Numbers, state: State, do: Operations, parts: tuple[list[Array], list[Array]]
    ) -> Array:
        forces, moments = parts
        turns = places(code, x, state[0], Operations([], 1), self.base).rotations[1:]
        is_world, numbers = self.chosen.get("axes") == "world", list[Array]()
        for j, (f, n, R, slides) in enumerate(zip(forces, moments, turns, code.prismatic, strict=True)):
            p, c = x.axes[j], x.centers[j]
            if self.chosen.get("actuator") == "left out":
                f, n = (f - p * (f * p).sum(axis=0), n) if slides else (f, n - p * (n * p).sum(axis=0))
            moment = do.result("the moments of the joint wrenches", j, n, {
                "those about the center of mass": lambda: n - crossed(c, f),
            }, of="body")  # fmt: skip
            force = do.result("the forces of the joint wrenches", j, turned(R, f) if is_world else f, {
                "in world axes, the moments in link axes": lambda: turned(R, f),
                "in link axes, the moments in world axes": lambda: f + 0 * R[0],
            }, of="body")  # fmt: skip
            pair = (force, turned(R, moment) if is_world else moment)
            numbers += pair[::-1] if self.chosen.get("order") == "angular first" else pair
        sign = -1.0 if self.chosen.get("acts on") == "the inside body" else 1.0
        return sign * stacked(flat(numbers))


@dataclass(frozen=True, eq=False)
class Multipliers:
    """The five of each joint of docs/notation.md (5 n, K, R).

    base: of the ground in the world; by: the recursion open to slips
    """

    base: Placement
    by: LinkAxes = IN_LINK_AXES

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        return _multipliers(self.base, code, x, state, do, self.by.joint_wrenches(code, x, state, do))

    def right(self, code: DynamicsCode, x: Numbers, state: State) -> Array:
        """Without slips."""
        return _multipliers(self.base, code, x, state, Operations([], state[0].shape[-1]), wrenches(code, x, state))


def _multipliers(
    base: Placement,
    code: DynamicsCode,
    x: Numbers,
    state: State,
    do: Operations,
    parts: tuple[list[Array], list[Array]],
) -> Array:
    m = places(code, x, state[0], Operations([], 1), base)
    numbers: list[Array] = []
    for j, (f, n, slides) in enumerate(zip(*parts, code.prismatic, strict=True)):
        p, R, before = x.axes[j], m.rotations[j + 1], m.rotations[code.inside[j]]
        first, second = do.result("the pair of normals t_1, t_2", j, np.stack(_normals(p)), {
            "exchanged": lambda: np.stack(_normals(p)[::-1]),
            "taken with t_1 = p × z, or p × x where p is near z": lambda: np.stack(_normals(p, order=(2, 0))),
        })  # fmt: skip
        if slides:
            pairs = ((first, f), (second, f), (first, n), (second, n), (p, n))
            numbers += [(axis * vector).sum(axis=0) for axis, vector in pairs]
            continue
        own = turned_about(p, state[0][j])
        force = do.result("the force λ_1, λ_2, λ_3 in world axes", j, turned(R, f), {
            NOT_TURNED: lambda: f + 0 * R[0], WRONG_WAY: lambda: turned_back(R, f),
            "turned with the inside link": lambda: turned(before, f),
        }, product=turn_product(turned, R, f))  # fmt: skip
        moment = do.result("the moment of λ_4, λ_5 in axes that the joint does not turn", j, turned(own, n), {
            "taken in link axes, not turned": lambda: n + 0 * own[0], WRONG_WAY: lambda: turned_back(own, n),
            "taken about the center of mass": lambda: turned(own, n - crossed(x.centers[j], f)),
            "turned into axes of the inside link": lambda: turned(x.rotations[j], turned(own, n)),
            "taken with the position of the joint before": lambda: turned(turned_about(p, state[0][j - 1]), n),
        }, product=turn_product(turned, own, n))  # fmt: skip
        names = ("λ_4, the moment about t_1,", "λ_5, the moment about t_2,")
        about = [(axis * moment).sum(axis=0) for axis in (first, second)]
        numbers += [*force, *(do.result(name, j, number) for name, number in zip(names, about, strict=True))]
    return stacked(numbers)


NEAR_AN_AXIS = 0.9
"""Component of a unit vector from which people take another axis for the product with it."""


def _normals(p: Array, order: tuple[int, int] | None = None) -> tuple[Array, Array]:
    """t_1, t_2 of docs/notation.md for axes (3, K, R), of the real part of each.

    order: of axes that are taken in place of that with the least component: the first, or the other where p is near it
    """
    least = np.abs(np.real(p)).argmin(axis=0)
    if order is not None:
        least = np.where(np.abs(np.real(p[order[0]])) < NEAR_AN_AXIS, *order)
    unit = (np.arange(3).reshape(3, *[1] * (p.ndim - 1)) == least).astype(float)
    first = crossed(p, unit)
    first = first / np.sqrt((first * first).sum(axis=0))
    return first, crossed(p, first)
