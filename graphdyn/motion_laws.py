"""Motion laws: one coordinate, a joint's or the moving base's, as a function of time.

A law is called with times (N,) [s] and answers position, velocity and acceleration (N,) [rad or m, …/s, …/s²]. Any
function that does so is one. Rail and Turntable say which coordinate of the moving base a law moves.

Every law refuses, with InvalidInput, data that are not finite real numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array

__all__ = [
    "ConstantAcceleration",
    "Course",
    "FourierSeries",
    "Locked",
    "MotionLaw",
    "Polynomial",
    "Rail",
    "TabulatedMotion",
    "Turntable",
]

Course = tuple[Array, Array, Array]
"""Position, velocity, acceleration (N,) each."""

SPLINE_DEGREE = 5
"""Quintic: the acceleration is a cubic spline, twice continuously differentiable, and its error is O(h⁴)."""

EDGE_TOLERANCE = 1e-12
"""Relative to the span of a table: a time this close outside is rounding, not extrapolation."""


class MotionLaw(Protocol):
    """Position, velocity and acceleration of one coordinate at the times (N,) [s]."""

    def __call__(self, times: Array, /) -> Course: ...


@dataclass(frozen=True)
class Locked:
    """The coordinate stands still at a position [rad or m]."""

    position: float = 0.0

    def __post_init__(self) -> None:
        _convert(self, position=())

    def __call__(self, times: Array, /) -> Course:
        rest = np.zeros_like(times, dtype=float)
        return rest + self.position, rest, rest


@dataclass(frozen=True)
class ConstantAcceleration:
    """position + velocity t + acceleration t²/2. [rad/s² or m/s², rad/s or m/s, rad or m], the latter two at t = 0"""

    acceleration: float
    velocity: float = 0.0
    position: float = 0.0

    def __post_init__(self) -> None:
        _convert(self, acceleration=(), velocity=(), position=())

    def __call__(self, times: Array, /) -> Course:
        return Polynomial((self.position, self.velocity, self.acceleration / 2))(times)


@dataclass(frozen=True)
@short_repr
class Polynomial:
    """c_0 + c_1 t + c_2 t² + …; coefficients in ascending order, c_k in rad/s^k or m/s^k."""

    coefficients: Sequence[float]

    def __post_init__(self) -> None:
        _convert(self, coefficients=("k",))

    def __call__(self, times: Array, /) -> Course:
        c = np.array(self.coefficients)
        position, velocity, acceleration = (
            np.asarray(polynomial.polyval(times, polynomial.polyder(c, order)), dtype=float) for order in range(3)
        )
        return position, velocity, acceleration


@dataclass(frozen=True)
@short_repr
class FourierSeries:
    """offset + Σ_l (a_l sin(l ω t) - b_l cos(l ω t)) / (l ω), l = 1 … L, ω = 2π frequency.

    The periodic excitation of Swevers et al., Optimal robot excitation and identification, IEEE Trans. Robotics and
    Automation 13 (1997) 730-740: a_l and b_l are the amplitudes of the velocity.

    frequency: of the fundamental, above zero               [Hz]
    a, b: of the harmonics, as many of each                 (L,)  [rad/s or m/s]
    offset: mean position                                   [rad or m]
    """

    frequency: float
    a: Sequence[float]
    b: Sequence[float]
    offset: float = 0.0

    def __post_init__(self) -> None:
        _convert(self, frequency=(), a=("L",), b=("L",), offset=())
        if self.frequency <= 0:
            raise InvalidInput(f"FourierSeries: frequency is {self.frequency} Hz; give one above zero")
        if len(self.a) != len(self.b):
            raise InvalidInput(
                f"FourierSeries: a has {len(self.a)} harmonics and b {len(self.b)}; give as many, zeros included"
            )

    def __call__(self, times: Array, /) -> Course:
        a, b = np.array(self.a), np.array(self.b)
        w = 2 * np.pi * self.frequency * np.arange(1, len(a) + 1)  # l ω
        phase = np.asarray(times, dtype=float)[..., None] * w
        sine, cosine = np.sin(phase), np.cos(phase)
        position = self.offset + sine @ (a / w) - cosine @ (b / w)
        return position, cosine @ a + sine @ b, cosine @ (w * b) - sine @ (w * a)


@dataclass(frozen=True, eq=False)
@short_repr
class TabulatedMotion:
    """Positions at given times, joined by an interpolating quintic spline.

    times: increasing, at least six                         (K,)  [s]
    positions:                                              (K,)  [rad or m]

    The spline is scipy.interpolate.make_interp_spline of degree 5 with not-a-knot ends; velocity and acceleration are
    its exact derivatives. A call raises InvalidInput for times outside the table: nothing is extrapolated.
    """

    times: Array
    positions: Array

    def __post_init__(self) -> None:
        for name in ("times", "positions"):
            array = _finite("TabulatedMotion", name, getattr(self, name), ("K",))
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if len(self.times) != len(self.positions):
            raise InvalidInput(
                f"TabulatedMotion: {len(self.times)} times and {len(self.positions)} positions; give one for each"
            )
        if len(self.times) <= SPLINE_DEGREE:
            raise InvalidInput(
                f"TabulatedMotion: {len(self.times)} rows; a quintic spline needs at least {SPLINE_DEGREE + 1}"
            )
        if np.any(np.diff(self.times) <= 0):
            row = int(np.argmax(np.diff(self.times) <= 0)) + 1
            raise InvalidInput(
                f"TabulatedMotion: time {self.times[row]:g} s in row {row} does not increase; sort the rows"
            )

    @cached_property
    def _derivatives(self) -> tuple[Any, Any, Any]:
        from scipy.interpolate import make_interp_spline

        spline = make_interp_spline(self.times, self.positions, k=SPLINE_DEGREE)
        return spline, spline.derivative(1), spline.derivative(2)

    def __call__(self, times: Array, /) -> Course:
        times, (first, last) = np.asarray(times, dtype=float), self.times[[0, -1]]
        slack = EDGE_TOLERANCE * (last - first)
        outside = (times < first - slack) | (times > last + slack)
        if outside.any():
            raise InvalidInput(
                f"TabulatedMotion: time {times[outside][0]:g} s is outside the table ({first:g} … {last:g} s); "
                "nothing is extrapolated: give a longer table or fewer times"
            )
        position, velocity, acceleration = (spline(np.clip(times, first, last)) for spline in self._derivatives)
        return position, velocity, acceleration


@dataclass(frozen=True)
@short_repr
class Rail:
    """The moving base slides along a fixed direction, in world axes; the law is in m. direction (3,), normalized
    here."""

    direction: Sequence[float]
    law: MotionLaw

    def __post_init__(self) -> None:
        _convert_direction(self, "direction")


@dataclass(frozen=True)
@short_repr
class Turntable:
    """The moving base turns about a fixed axis through its origin, in world axes; the law is in rad. axis (3,),
    normalized here.
    """

    axis: Sequence[float]
    law: MotionLaw

    def __post_init__(self) -> None:
        _convert_direction(self, "axis")


def _convert_direction(owner: object, name: str) -> None:
    _convert(owner, **{name: (3,)})
    vector = np.array(getattr(owner, name))
    if not vector.any():
        raise InvalidInput(f"{type(owner).__name__}: {name} is zero; give a direction in world axes")
    vector = np.ldexp(vector, -np.frexp(np.abs(vector).max())[1])  # exact; keeps tiny squares from underflowing
    object.__setattr__(owner, name, tuple((vector / np.linalg.norm(vector)).tolist()))


def _convert(owner: object, **shapes: tuple[int | str, ...]) -> None:
    """The named fields as floats or tuples of floats, so that equal laws compare equal."""
    for name, shape in shapes.items():
        array = _finite(type(owner).__name__, name, getattr(owner, name), shape)
        object.__setattr__(owner, name, tuple(array.tolist()) if shape else float(array))


def _finite(who: str, name: str, value: ArrayLike, shape: tuple[int | str, ...]) -> Array:
    """A fresh float array; a letter in the shape stands for any length but zero."""
    array = np.array(as_floats(f"{who}: {name}", value))
    fits = len(shape) == array.ndim and all(
        n == k if isinstance(k, int) else n > 0 for n, k in zip(array.shape, shape, strict=True)
    )
    if not fits:
        expected = ", ".join(map(str, shape)) + ("," if len(shape) == 1 else "")
        raise InvalidInput(f"{who}: {name} has shape {array.shape}, expected ({expected})")
    if not np.all(np.isfinite(array)):
        raise InvalidInput(f"{who}: {name} contains NaN or infinity: {array.tolist()}")
    return array
