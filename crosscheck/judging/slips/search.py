"""The search among slips: every one in every formulation at a few states, then the few that fit everywhere."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import CodeFault
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, numbers_of
from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.slips.body_wrenches import add_body_with_first_moments
from crosscheck.judging.slips.composite import composite_bodies
from crosscheck.judging.slips.lagrange import christoffel
from crosscheck.judging.slips.link_axes import LinkAxes
from crosscheck.judging.slips.operations import Formulation, Operations, Slip
from crosscheck.judging.slips.spatial import spatial
from crosscheck.judging.slips.world_axes import world_axes
from graphdyn.layout import Array

TORQUE_FORMULATIONS: tuple[Formulation, ...] = (
    LinkAxes(),
    world_axes,
    LinkAxes(gravity="apart"),
    spatial,
    LinkAxes(bodies=add_body_with_first_moments),
    composite_bodies,
    christoffel,
)
"""The formulations whose operations are tried, in turn."""

MAX_CHRISTOFFEL_JOINTS = 12
"""Number of joints up to which Christoffel symbols are tried: their number grows with the third power."""

N_TRIED_NUMBERS = 6
"""Number of torques, at least, with which all slips are tried."""

SLIP_SIZE = 2
"""How many numbers a slip counts as: a fault that is as simple and gives the same numbers is named first."""

SLIP_REMEDY = "compare this operation with the recursion in a textbook"


def all_slips(formulation: Formulation, code: DynamicsCode) -> list[Slip]:
    """Every slip of a formulation for this robot."""
    known = Operations([], 1)
    state = np.zeros((3, len(code.inside), 1, 1))
    formulation(code, numbers_of([code]), (state[0], state[1], state[2]), known)
    return list(known.slips())


def fitting_slips(
    formulations: Sequence[Formulation],
    code: DynamicsCode,
    names: tuple[Sequence[str], Sequence[str]],
    rows: Observation,
    bound: float,
    known: dict[object, Array],
) -> Iterator[CodeFault]:
    """Slips that give the numbers of a few rows, as faults of a code.

    names: of the joints, and of the bodies; known: the torques of all slips, from one search to the next
    """
    tried = rows.only(_most_general(rows))
    seen: set[str] = set()
    for formulation in formulations:
        if formulation is christoffel and len(code.inside) > MAX_CHRISTOFFEL_JOINTS:
            continue
        slips = all_slips(formulation, code)
        key = formulation, tried.state_key
        if key not in known:
            known[key] = torques_with(formulation, slips, code, tried.state)
        left = np.abs(tried.left_by(known[key])).max(axis=(1, 2))
        for k in np.flatnonzero(left <= bound):
            message = slips[k].message(*names)
            if message not in seen:
                seen.add(message)
                yield _fault(formulation, slips[k], message)


def torques_with(formulation: Formulation, slips: Sequence[Slip], code: DynamicsCode, state: State) -> Array:
    """Torques (K, R, n) of a code with each of K slips alone."""
    q, v, a = (np.moveaxis(x, -1, 0)[:, None] for x in state)
    with np.errstate(all="ignore"):
        found = formulation(code, numbers_of([code]), (q, v, a), Operations(slips, q.shape[-1]))
    torque = np.moveaxis(found, 0, -1)
    return np.nan_to_num(np.broadcast_to(torque, (len(slips), *torque.shape[1:])), nan=np.inf)


def _most_general(rows: Observation) -> NDArray[np.bool_]:
    """The rows with the most numbers that are not zero, as few as have enough torques."""
    q, v, a = (x[rows.of] for x in rows.state)
    size = (q != 0).sum(axis=1) + (v != 0).sum(axis=1) + (a != 0).sum(axis=1)
    chosen = np.zeros(len(size), dtype=bool)
    chosen[np.argsort(-size, kind="stable")[: -(-N_TRIED_NUMBERS // q.shape[1])]] = True
    return chosen


@dataclasses.dataclass(frozen=True)
class SlippedRecursion:
    """A recursion with one slip; equal to another one with the same slip."""

    formulation: Formulation
    slip: Slip

    def __call__(self, code: DynamicsCode, numbers: Numbers, state: State) -> Array:
        """Torques (n, 1, R)."""
        return self.formulation(code, numbers, state, Operations([self.slip], state[0].shape[-1]))


def _fault(formulation: Formulation, slip: Slip, message: str) -> CodeFault:
    def change(code: DynamicsCode) -> DynamicsCode:
        return dataclasses.replace(code, recursion=SlippedRecursion(formulation, slip))

    return CodeFault.of("slip", message, SLIP_REMEDY, change, SLIP_SIZE)
