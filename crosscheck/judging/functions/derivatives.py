"""Functions that follow from the torques of a code: power, and derivatives, exact for what torques can be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol, runtime_checkable

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, torque_recursion
from crosscheck.judging.slips.link_axes import LinkAxes
from crosscheck.judging.slips.operations import Operations
from graphdyn.layout import Array

TURNS = 2 * np.pi * np.arange(1, 7) / 7
TURN_WEIGHTS = 2 / 7 * sum(k * np.sin(k * TURNS) for k in (1, 2, 3))
"""The slope of a trigonometric polynomial of the third degree from its values at seven angles, the first of weight
zero: forces and torques are no higher ones in the position of a hinge."""

OFFSETS = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
OFFSET_WEIGHTS = np.array([-1, 9, -45, 45, -9, 1]) / 60
"""The slope of a polynomial of the sixth degree: they are of the second in velocities and positions of slides.
Fornberg, "Generation of finite difference formulas on arbitrarily spaced grids", Mathematics of Computation 51(184),
1988."""

RATE_OFFSETS, RATE_WEIGHTS = np.array([-1.0, 1.0]), np.array([-0.5, 0.5])
"""The slope of a polynomial of the second degree: what forces and torques are in velocities and accelerations."""

Answering = Callable[[DynamicsCode, Numbers, State], Array]
"""(code, numbers (…, K, 1), q, v, a (n, K or 1, R)) → (D, K, R)."""


@runtime_checkable
class Written(Protocol):
    """A function as people write it, open to slips, and faster without them."""

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations, /) -> Array: ...

    def right(self, code: DynamicsCode, x: Numbers, state: State) -> Array: ...


class TorqueRecursion:
    """Joint torques in link axes."""

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        return LinkAxes()(code, x, state, do)

    def right(self, code: DynamicsCode, x: Numbers, state: State) -> Array:
        return torque_recursion(code, x, state)


def power(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    return torque_recursion(code, x, state) * state[1]


@dataclass(frozen=True)
class Derivative:
    """The derivative of a function in q, v or a; the last index is that of the joint.

    of: the function; by: the argument
    """

    of: Written
    by: Literal["q", "v", "a"]

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        n, rows = state[0].shape[0], state[0].shape[-1]

        def held(y: Array) -> Array:
            """A number at the state itself, in place of those at the steps from it; the last step is none."""
            if y.shape[-1] == 1:
                return y
            by_step = y.reshape(*y.shape[:-1], n, -1, rows)
            return np.broadcast_to(by_step[..., -1:, :], by_step.shape).reshape(y.shape)

        def slipped(code: DynamicsCode, x: Numbers, moved: State) -> Array:
            do.see(moved[0].shape[-1], float, held)
            return self.of(code, x, moved, do)

        return self._slopes(slipped, code, x, state, no_step=[0.0])

    def right(self, code: DynamicsCode, x: Numbers, state: State) -> Array:
        return self._slopes(self.of.right, code, x, state)

    def _slopes(
        self, of: Answering, code: DynamicsCode, x: Numbers, state: State, no_step: Sequence[float] = ()
    ) -> Array:
        """no_step: a step of zero after the others, with the weight zero, where the state itself is asked for"""
        n, rows = state[0].shape[0], state[0].shape[-1]
        steps, weights = np.tile(RATE_OFFSETS, (n, 1)), np.tile(RATE_WEIGHTS, (n, 1))
        if self.by == "q":
            hinge = np.logical_not(code.prismatic)[:, None]
            steps, weights = np.where(hinge, TURNS, OFFSETS), np.where(hinge, TURN_WEIGHTS, OFFSET_WEIGHTS)
        steps, weights = (np.hstack([y, np.tile(no_step, (n, 1))]) for y in (steps, weights))
        count = steps.shape[1]
        moved = [np.repeat(y[..., None, :], n * count, axis=-2) for y in state]
        place = "qva".index(self.by)
        moved[place] = moved[place] + (np.eye(n)[..., None] * steps).reshape(n, 1, n * count, 1)
        q, v, a = (y.reshape(*y.shape[:-2], -1) for y in moved)
        found = of(code, x, (q, v, a))
        found = np.broadcast_to(found, (*found.shape[:2], n * count * rows))
        slopes = np.einsum("dkjcr,jc->djkr", found.reshape(*found.shape[:2], n, count, rows), weights)
        return np.asarray(slopes.reshape(-1, *slopes.shape[2:]))


@dataclass(frozen=True)
class AccelerationDerivative:
    """∂a/∂q or ∂a/∂v at given torques: −M⁻¹ ∂τ/∂q at the accelerations that belong to them (n n, K, R)."""

    by: Literal["q", "v"]

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        q, v, tau = state
        n = len(q)
        still = torque_recursion(code, x, (q, v, 0 * q))
        free = replace(x, gravity=0 * x.gravity)
        columns = [torque_recursion(code, free, (q, 0 * v, unit[:, None, None] + 0 * q)) for unit in np.eye(n)]
        mass = np.moveaxis(np.stack(np.broadcast_arrays(*columns), axis=1), (0, 1), (-2, -1))  # (K, R, n, n)
        rest = np.moveaxis(np.broadcast_to(tau - still, (n, *mass.shape[:2])), 0, -1)
        singular = np.linalg.slogdet(mass)[0] == 0
        mass = np.where(singular[..., None, None], np.nan, mass)
        a = np.moveaxis(np.linalg.solve(mass, rest[..., None])[..., 0], -1, 0)
        slopes = Derivative(TorqueRecursion(), self.by).right(code, x, (q, v, a))
        slopes = np.moveaxis(slopes.reshape(n, n, *slopes.shape[1:]), (0, 1), (-2, -1))
        found = np.moveaxis(-np.linalg.solve(mass, slopes), (-2, -1), (0, 1))
        return np.asarray(found.reshape(n * n, *found.shape[2:]))
