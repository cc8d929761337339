"""Zeros that functions of the motion reach or pass: within steps too, twice within one, and from the start on.

Each function is compared with the polynomial through its values at the nodes of Chebyshev and Lobatto of a piece of the
motion: a step, or a part of one. The sum of the coefficients bounds the polynomial. A sketch of the motion, and how far
it may be off, tell where the function may vanish; there it is evaluated along the motion itself, at the nodes and at
the extrema of the polynomial through them, and each change of sign between these is located. Positions and velocities
resemble polynomials between steps, so that nothing of them is missed; functions of the caller are near theirs where a
piece resolves them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.layout import Array

DEGREE = 7
"""Degree of the polynomials: that of the dense output of DOP853."""

BOUND_MARGIN = 1.1
"""The bound of a polynomial is taken so much wider, for functions that only resemble it."""

ZERO_SHARE = 64 * float(np.finfo(float).eps)
"""A value that is smaller than this part of the largest in its piece and in the one before is zero."""

LEAVING_SHARE = 1e-4
"""A function that has left zero after this part of an interval has left it at the beginning."""

LARGEST_VALUE = 1e300
"""What stands for infinity."""

MAX_BISECTIONS = 100
"""Halvings of an interval until its ends are neighbors."""

MAX_ROOT_ITERATIONS = 1000
"""Iterations of the search for a zero, for functions that jump as well."""

JointsAt = Callable[[NDArray[np.int64], Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class Pieces:
    """A part of a motion, in pieces.

    edges: of the pieces, increasing                        (m + 1,)  [s]
    joints: numbers of pieces and times of any shape → q and v at these
    sketch: the same at less expense; None where it is cheap
    beside: the sketch, moved as far as it may be off
    is_exact: whether the sketch is the motion, but for rounding  (m,)
    """

    edges: Array
    joints: JointsAt
    sketch: JointsAt | None = None
    beside: JointsAt | None = None
    is_exact: NDArray[np.bool_] | None = None
    _nodes: dict[int, tuple[Array, Array, Array]] = field(default_factory=dict, repr=False)

    def nodes(self, degree: int) -> tuple[Array, Array, Array]:
        """Times of the nodes of all pieces (m, degree + 1), and q and v of the sketch there; found once for all."""
        if degree not in self._nodes:
            fractions, _ = _basis(degree)
            begin, end = self.edges[:-1, None], self.edges[1:, None]
            times = np.where(fractions == 1, end, begin + fractions * (end - begin))
            numbers = np.broadcast_to(np.arange(len(begin))[:, None], times.shape)
            self._nodes[degree] = (times, *(self.sketch or self.joints)(numbers, times))
        return self._nodes[degree]

    def moved(self, degree: int) -> tuple[Array, Array, Array] | None:
        """The middle nodes of all pieces (m,), and q and v as far beside the sketch as it may be off there."""
        if self.beside is None:
            return None
        times = self.nodes(degree)[0][:, degree // 2]
        return (times, *self.beside(np.arange(len(times)), times))

    def cheapest(self, piece: int) -> JointsAt:
        """The motion along a piece."""
        known = self.sketch is not None and self.is_exact is not None and self.is_exact[piece]
        return self.sketch if known and self.sketch is not None else self.joints


class Watch:
    """One function through a motion.

    values: times, q and v → values                         (k,), (k, n), (k, n) → (k,)
    direction: 1 for a rise, -1 for a fall, 0 for both
    stop: whether the motion ends there
    inside: whether it starts on its own side of zero, whatever rounding says
    degree: of the polynomial

    failure: when and why the function had no value
    """

    def __init__(
        self,
        values: Callable[[Array, Array, Array], Array],
        name: str = "",
        direction: int = 0,
        stop: bool = True,
        inside: bool = False,
        degree: int = DEGREE,
    ) -> None:
        self._values, self.name, self.direction, self.stop = values, name, direction, stop
        self._inside, self._degree = inside, degree
        # the sign seen last; at_start: zero, and never anything else; None before the start
        self._side: float | None = None
        self._size = 0.0  # largest value in the last piece
        self._at_start = True
        self.failure: tuple[float, InvalidInput] | None = None

    def crossings(self, pieces: Pieces) -> Iterator[tuple[float, int]]:
        """Time and piece of each."""
        times = pieces.nodes(self._degree)[0]
        signs, sizes = self._overview(pieces)
        for k, (sign, size) in enumerate(zip(signs.tolist(), sizes.tolist(), strict=True)):
            if sign == 0 or sign != self._side:
                yield from self._within(pieces, k, times[k], ZERO_SHARE * max(size, self._size))
            if self.failure is not None:
                return
            self._size = size

    def _overview(self, pieces: Pieces) -> tuple[Array, Array]:
        """The sign of each piece, zero where the function may vanish or has no value (m,); its largest value (m,)."""
        times, *joints = pieces.nodes(self._degree)
        values = self._evaluated(times, *joints)
        series = values @ _basis(self._degree)[1].T
        bound = BOUND_MARGIN * np.abs(series[:, 1:]).sum(axis=-1)
        moved = pieces.moved(self._degree)
        if moved is not None:
            bound += np.abs(self._evaluated(*moved) - values[:, self._degree // 2])
        self.failure = None  # what has no value on a sketch may have one on the motion
        signs = np.where(np.abs(series[:, 0]) > bound, np.sign(series[:, 0]), 0.0)
        return signs, np.where(np.abs(values) < LARGEST_VALUE, np.abs(values), 0.0).max(axis=-1)

    def _within(self, pieces: Pieces, k: int, nodes: Array, zero: float) -> Iterator[tuple[float, int]]:
        joints, before = pieces.cheapest(k), float(nodes[0])

        def values_at(times: Array) -> Array:
            if not times.size:
                return times
            return self._evaluated(times, *joints(np.full(len(times), k), times))

        values = values_at(nodes)
        extrema = _extrema(_basis(self._degree)[1] @ values, before, float(nodes[-1]))
        times, first = np.unique(np.concatenate([nodes, extrema]), return_index=True)
        values = np.concatenate([values, values_at(extrema)])[first]
        for time, value in zip(times.tolist(), values.tolist(), strict=True):
            if np.isnan(value):
                return
            sign = 0.0 if abs(value) <= zero else float(np.sign(value))
            if self._side is None:
                self._side = 0.0 if self._inside and sign == self.direction else sign
            elif sign != self._side:
                direction, happens = sign or -self._side, self._side != 0 or self._at_start
                if happens and self.direction in (0, direction):
                    yield self._located(pieces, k, before, time, self._side), k
                self._side = sign
            self._at_start = self._at_start and self._side == 0
            before = time

    def _located(self, pieces: Pieces, k: int, low: float, high: float, side: float) -> float:
        """When the function leaves the side on which it is at the first of two times."""
        from scipy.optimize import brentq

        def value(time: float) -> float:
            found = float(self._evaluated(np.array([time]), *pieces.joints(np.array([k]), np.array([time])))[0])
            if self.failure is not None and np.isnan(found):
                raise self.failure[1]
            return found

        if side:
            if np.sign(value(low)) != side:
                return low
            end = np.sign(value(high))
            if end == side:
                return high
            if end == 0:
                return _first(lambda time: np.sign(value(time)) != side, low, high)[1]
            width = 4 * float(np.finfo(float).eps) * max(abs(high), float(np.finfo(float).tiny))
            return float(brentq(value, low, high, xtol=width, maxiter=MAX_ROOT_ITERATIONS))
        if value(low + LEAVING_SHARE * (high - low)):
            return low
        return _first(lambda time: value(time) != 0, low, high)[0]

    def _evaluated(self, times: Array, q: Array, v: Array) -> Array:
        """The values at times of any shape."""
        n = q.shape[-1]
        return self._values(times.ravel(), q.reshape(-1, n), v.reshape(-1, n)).reshape(times.shape)


@dataclass(frozen=True, eq=False)
class Crossing:
    """A function that reaches or passes zero at a time, in a piece."""

    time: float
    piece: int
    watch: Watch


def crossings(watches: Sequence[Watch], pieces: Pieces) -> list[Crossing]:
    """The crossings of all functions in their order, up to the first that stops.

    Raises InvalidInput where a function has no value before.
    """
    found = [Crossing(time, k, watch) for watch in watches for time, k in watch.crossings(pieces)]
    found.sort(key=lambda crossing: crossing.time)
    last = next((number for number, crossing in enumerate(found) if crossing.watch.stop), None)
    if last is not None:
        found = found[: last + 1]
    end = np.inf if last is None else found[-1].time
    failures = [watch.failure for watch in watches if watch.failure is not None and watch.failure[0] < end]
    if failures:
        raise min(failures, key=lambda failure: failure[0])[1]
    return found


def _first(happens: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """Neighboring times, or nearly so, between which something has begun that has at the second of two."""
    for _ in range(MAX_BISECTIONS):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        low, high = (low, middle) if happens(middle) else (middle, high)
    return low, high


@cache
def _basis(degree: int) -> tuple[Array, Array]:
    """Nodes in 0 … 1 (degree + 1,), and the matrix from values at these to coefficients of Chebyshev's polynomials."""
    nodes = -np.cos(np.pi * np.arange(degree + 1) / degree)
    fractions = (1 + nodes) / 2
    fractions[0], fractions[-1] = 0.0, 1.0
    return fractions, np.asarray(np.linalg.inv(chebyshev.chebvander(nodes, degree)), dtype=float)


def _extrema(series: Array, begin: float, end: float) -> Array:
    """The times between two at which the polynomial has extrema."""
    size = np.abs(series).max()
    if not np.isfinite(size) or size == 0:
        return np.empty(0)
    roots = chebyshev.chebroots(chebyshev.chebtrim(chebyshev.chebder(series / size), np.finfo(float).eps))
    found = roots.real[(np.abs(roots.imag) < 1e-6) & (np.abs(roots.real) < 1)]
    return begin + (1 + found) / 2 * (end - begin)
