"""Joint orders: permutations of motions and torques."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import CodeFault
from crosscheck.judging.faults.recursion import DynamicsCode
from graphdyn import RobotModel

MOST_PERMUTED = 6
"""Largest number of joints for which all n! orders are tried; beyond, exchanges of two joints, cyclic shifts, and the
reverse and alphabetical orders."""


def orders(model: RobotModel) -> Iterator[CodeFault]:
    names, rules = model.joint_names, set(_rules(model))
    remedy = f"the order here is {', '.join(names)}; pass joint_names=, or sort by name"
    for order in map(np.array, _orders(model)):
        listed = ", ".join(names[k] for k in order)
        back = np.argsort(order)
        for message, motions, torques in (
            (f"joint quantities are in the order {listed}", True, True),
            (f"joint motions, but not torques, are in the order {listed}", True, False),
            (f"torques, but not joint motions, are in the order {listed}", False, True),
        ):
            yield CodeFault.of(
                "joint_order", message, remedy,
                lambda code, x=(order, back, motions, torques): _permuted(code, *x),  # type: ignore[misc]
                1 if tuple(order) in rules else _exchanges(order),
            )  # fmt: skip


def _permuted(
    code: DynamicsCode, order: NDArray[np.intp], back: NDArray[np.intp], motions: bool, torques: bool
) -> DynamicsCode:
    """A code whose joint k is our joint order[k]."""
    if motions:
        code = code.taking(lambda q, v, a: (q[..., back], v[..., back], a[..., back]))
    return code.giving(lambda tau, _: tau[..., order]) if torques else code


def _exchanges(order: NDArray[np.intp]) -> int:
    """How many exchanges of two joints make this order: its length less the number of its cycles."""
    left, cycles = set(range(len(order))), 0
    while left:
        k = left.pop()
        cycles += 1
        while (k := int(order[k])) in left:
            left.remove(k)
    return len(order) - cycles


def _rules(model: RobotModel) -> list[tuple[int, ...]]:
    """Orders that follow from a rule: alphabetical, reversed, one after the other shifted."""
    ours = tuple(range(model.n_bodies))
    alphabetical = tuple(sorted(ours, key=lambda k: model.joint_names[k]))
    return [alphabetical, ours[::-1], *(ours[k:] + ours[:k] for k in ours[1:])]


def _orders(model: RobotModel) -> Iterator[tuple[int, ...]]:
    """Every order but ours."""
    n = model.n_bodies
    ours = tuple(range(n))
    likely = _rules(model)
    for i, k in itertools.combinations(ours, 2):
        exchanged = list(ours)
        exchanged[i], exchanged[k] = k, i
        likely.append(tuple(exchanged))
    every = itertools.permutations(ours) if n <= MOST_PERMUTED else ()
    yield from (order for order in dict.fromkeys([*likely, *every]) if order != ours)
