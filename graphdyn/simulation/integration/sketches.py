"""Motions between the ends of steps of Runge-Kutta methods: exactly, by steps as far as that, and sketched.

A sketch is the polynomial of degree four through q and v at both ends and the acceleration at the first. Its
coefficient of the fourth power says how far from a polynomial of degree three the motion is, and how far it may be off:
more than it is where steps are smooth, and enough for what a method or dry friction breaks within a step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array
from graphdyn.simulation.integration.crossings import Pieces
from graphdyn.simulation.integration.steps import joints_of

ROUNDING = 1e-13
"""A sketch that is off by less than this part of q is exact."""

DOUBT_SHARE = 0.25
"""A sketch may be off by so much of its last coefficient; a smooth step is by a fraction of 1/16."""


@dataclass(frozen=True, eq=False)
class RowSteps:
    """The steps between rows of a motion.

    edges: times of the rows                                (m + 1,)  [s]
    q, v: at these                                          (m + 1, n)
    a: where each step begins, under its torque             (m, n)
    parts: pieces of each step
    state: number of a step and a time → q, v, work and loss at that time in this step   (2n + 2,)
    closed: what puts a sketched q and v onto closed loops
    """

    edges: Array
    q: Array
    v: Array
    a: Array
    parts: int
    state: Callable[[int, float], Array]
    closed: Callable[[Array, Array], tuple[Array, Array]] | None = None

    def pieces(self) -> Pieces:
        shares = np.arange(self.parts) / self.parts
        edges = (self.edges[:-1, None] + shares * np.diff(self.edges)[:, None]).ravel()
        last = self._coefficients[-1]
        is_exact = np.abs(last) <= ROUNDING * np.maximum(np.abs(self.q[:-1]), np.abs(self.q[1:]))
        return Pieces(
            np.append(edges, self.edges[-1]),
            self._joints,
            self._sketch,
            self._beside,
            np.repeat(is_exact.all(axis=-1), self.parts),
        )

    @cached_property
    def _coefficients(self) -> tuple[Array, Array, Array, Array]:
        """The coefficients of the first to the fourth power of the share of a step that is past, (m, n) each."""
        h, q, v = np.diff(self.edges)[:, None], self.q, self.v
        first, second = h * v[:-1], h**2 * self.a / 2
        rest, turn = q[1:] - q[:-1] - first - second, h * (v[1:] - v[:-1]) - 2 * second
        return first, second, 4 * rest - turn, turn - 3 * rest

    def _joints(self, pieces: NDArray[np.int64], times: Array) -> tuple[Array, Array]:
        numbers = (pieces // self.parts).ravel().tolist()
        states = [joints_of(self.state(k, time)) for k, time in zip(numbers, times.ravel().tolist(), strict=True)]
        q, v = (np.array(part).reshape(*times.shape, -1) for part in zip(*states, strict=True))
        return q, v

    def _sketch(self, pieces: NDArray[np.int64], times: Array) -> tuple[Array, Array]:
        return self._sketched(pieces // self.parts, times, moved=0.0)

    def _beside(self, pieces: NDArray[np.int64], times: Array) -> tuple[Array, Array]:
        return self._sketched(pieces // self.parts, times, moved=1.0)

    def _sketched(self, k: NDArray[np.int64], times: Array, moved: float) -> tuple[Array, Array]:
        """What is constant stays so exactly."""
        h = (self.edges[k + 1] - self.edges[k])[..., None]
        s = (times - self.edges[k])[..., None] / h
        first, second, third, fourth = (coefficient[k] for coefficient in self._coefficients)
        q = self.q[k] + first * s + second * s**2 + third * s**3 + fourth * (s**4 + moved * DOUBT_SHARE)
        v = self.v[k] + (2 * second * s + 3 * third * s**2 + fourth * (4 * s**3 + moved)) / h
        return self.closed(q, v) if self.closed else (q, v)
