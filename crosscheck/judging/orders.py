"""Joint orders: which permutation of the joints gives the numbers of a foreign function."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.experiments import Function, torques
from crosscheck.judging.faults.fault import Fault
from graphdyn import RobotModel, mass_matrix
from graphdyn.layout import Array

MOST_PERMUTED = 6
"""Largest number of joints for which all n! orders are tried; beyond, exchanges of two joints, cyclic shifts, and the
reverse and alphabetical orders."""


SCREEN = 1e-3
"""Relative error at one state beyond which an order is not tried at the others."""


def order_faults(model: RobotModel, q: Array, v: Array, answer: Array | None, columns: Array | None) -> Iterator[Fault]:
    """The orders that are possible according to one state.

    q, v: (n,); answer: torques at (q, v, a = 0) there (n,); columns: M there (n, n); None where unknown
    """
    own, names = torques(model), model.joint_names
    orders = np.array(list(_orders(model)))
    for consistent in (True, False):
        kept = _screened(model, orders, q, v, answer, columns, consistent)
        for order in kept:
            listed = ", ".join(names[k] for k in order)
            what = "joint quantities are" if consistent else "joint motions, but not torques, are"
            yield Fault(
                "joint_order",
                f"{what} in the order {listed}",
                f"the order here is {', '.join(names)}; pass joint_names=, or sort by name",
                _permuted(own, order, consistent),
            )


def _permuted(own: Function, order: NDArray[np.intp], consistent: bool) -> Function:
    """A code whose joint k is our joint order[k]."""

    def torque(q: Array, v: Array, a: Array) -> Array:
        ours = [np.empty_like(x) for x in (q, v, a)]
        for mine, given in zip(ours, (q, v, a), strict=True):
            mine[..., order] = given
        tau = own(*ours)
        return tau[..., order] if consistent else tau

    return torque


def _screened(
    model: RobotModel,
    orders: NDArray[np.intp],
    q: Array,
    v: Array,
    answer: Array | None,
    columns: Array | None,
    consistent: bool,
) -> NDArray[np.intp]:
    """Orders that give the answer at one state: all of them in one batch."""
    inverse = np.argsort(orders, axis=1)
    own = torques(model)
    permuted_q, permuted_v = q[inverse], v[inverse]
    fits = np.ones(len(orders), dtype=bool)
    if answer is not None:
        tau = own(permuted_q, permuted_v, np.zeros_like(permuted_q))
        tau = np.take_along_axis(tau, orders, axis=1) if consistent else tau
        fits &= np.abs(tau - answer).max(axis=1) <= SCREEN * np.abs(answer).max()
    if columns is not None:
        mass = mass_matrix(model, permuted_q)
        rows = np.take_along_axis(mass, orders[:, :, None], axis=1) if consistent else mass
        mass = np.take_along_axis(rows, orders[:, None, :], axis=2)
        fits &= np.abs(mass - columns).max(axis=(1, 2)) <= SCREEN * np.abs(columns).max()
    return orders[fits]


def _orders(model: RobotModel) -> Iterator[tuple[int, ...]]:
    """Every order but ours, the common mistakes first."""
    n = model.n_bodies
    ours = tuple(range(n))
    alphabetical = tuple(sorted(ours, key=lambda k: model.joint_names[k]))
    likely = [alphabetical, ours[::-1]]
    likely += [ours[k:] + ours[:k] for k in range(1, n)]
    for i, k in itertools.combinations(ours, 2):
        exchanged = list(ours)
        exchanged[i], exchanged[k] = k, i
        likely.append(tuple(exchanged))
    every = itertools.permutations(ours) if n <= MOST_PERMUTED else ()
    yield from (order for order in dict.fromkeys([*likely, *every]) if order != ours)
