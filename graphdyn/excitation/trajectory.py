"""Motions of all joints as functions of time, and limits as numbers that have to stay below 1.

A limit is one number: a smooth maximum over the grid of time and over all numbers that are limited together,

    K = m + ln Σ exp(ρ (g - m)) / ρ,    m = max g ≤ K ≤ m + ln(number of g) / ρ,    g = |v_t| / v_max and so on

(Kreisselmeier and Steinhauser, 1979): never below the true maximum, and differentiable. A motion keeps the limit
if K ≤ 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.excitation.bases import SPLINE_DEGREE, Basis
from graphdyn.layout import Array


class JointMotion(NamedTuple):
    """Positions, velocities, accelerations, jerks (N, n) of the independent joints [rad or m, …/s, …]."""

    q: Array
    v: Array
    a: Array
    jerk: Array


class FiniteMotion(Protocol):
    """A motion from time zero to duration."""

    @property
    def duration(self) -> float:
        """Duration [s]."""
        ...

    def motion(self, times: Array) -> JointMotion:
        """Motion at the times (N,) [s]."""
        ...


@dataclass(frozen=True, eq=False)
@short_repr
class Trajectory:
    """The motion q_j(t) = Σ_k coefficients[j, k] φ_k(t); coefficients (n, K)."""

    basis: Basis
    coefficients: Array

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.basis.duration

    def motion(self, times: Array) -> JointMotion:
        """Motion at the times (N,) [s]."""
        return JointMotion(*(self.basis.rows(times, order) @ self.coefficients.T for order in range(4)))

    def of(self, basis: Basis) -> Trajectory:
        """The nearest motion of another basis of the same duration, by least squares of the positions: the same one
        where that basis has it."""
        times = np.linspace(0.0, self.duration, 4 * max(basis.size, self.basis.size))
        positions = self.basis.rows(times, 0) @ self.coefficients.T
        coefficients = np.linalg.lstsq(basis.rows(times, 0), positions, rcond=None)[0].T
        return Trajectory(basis, np.asarray(coefficients, dtype=float))


LARGEST_COEFFICIENT = 1e150
"""Bound of the splines of a motion and of their derivatives, whose squares are numbers then [SI units]."""


@dataclass(frozen=True, eq=False)
@short_repr
class TabulatedCourse:
    """Positions at given times, joined by interpolating quintic splines; time counts from the first row.

    times: increasing                                       (K,)    [s]
    positions: of the independent joints                    (K, n)  [rad or m]

    Raises InvalidInput for fewer than six rows, times that do not increase, other shapes, NaN and infinity, positions
    and derivatives of LARGEST_COEFFICIENT.
    """

    times: Array
    positions: Array

    def __post_init__(self) -> None:
        times, positions = as_floats("times", self.times), as_floats("positions", self.positions)
        if times.ndim != 1 or positions.ndim != 2 or len(times) != len(positions):
            raise InvalidInput(f"times have shape {times.shape}, positions {positions.shape}; (K,) and (K, n) needed")
        if len(times) <= SPLINE_DEGREE:
            raise InvalidInput(f"a motion of {len(times)} rows is too short; {SPLINE_DEGREE + 1} are needed")
        finite = np.all(np.isfinite(times)) and np.all(np.isfinite(positions))
        if not (finite and np.all(times[1:] > times[:-1])):
            raise InvalidInput("the times of a motion must increase, and its positions be finite")
        with np.errstate(all="ignore"):
            object.__setattr__(self, "times", times - times[0])
            object.__setattr__(self, "positions", positions)
            try:
                largest = np.max([np.abs(spline.c).max() for spline in self._derivatives])
            except ValueError:  # whose equations overflow
                largest = np.inf
        if not largest < LARGEST_COEFFICIENT:
            raise InvalidInput(
                f"a motion whose positions or derivatives reach {LARGEST_COEFFICIENT:g} is not computed; correct its "
                "numbers"
            )

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.times[-1])

    def motion(self, times: Array) -> JointMotion:
        """Motion at the times (N,) [s]; times outside count as the ends."""
        inside = np.clip(times, 0.0, self.duration)
        return JointMotion(*(np.asarray(spline(inside)) for spline in self._derivatives))

    @cached_property
    def _derivatives(self) -> tuple[Any, ...]:
        from scipy.interpolate import make_interp_spline  # imported where first used: import graphdyn stays light

        spline = make_interp_spline(self.times, self.positions, k=SPLINE_DEGREE)
        return (spline, *(spline.derivative(order) for order in (1, 2, 3)))


def sample_times(duration: float, rate: float) -> Array:
    """Times from zero to a duration at a rate [s, Hz], the end included if it is a multiple of the period."""
    return np.arange(int(duration * rate * (1 + 1e-12)) + 1) / rate


@dataclass(frozen=True)
class Usage:
    """Use of one limit by a motion.

    kind: "position", "velocity", "acceleration", "jerk", "torque", "plane" or "clearance"
    name: of the joint, of the plane, or of the two parts of the robot
    used: largest part of the limit that the motion uses; above 1 it is violated. For a position, a plane or a clearance
        it is 1 at the limit
    """

    kind: str
    name: str
    used: float


@dataclass(frozen=True, eq=False)
class Signal:
    """Values of one limit over time, with their slopes.

    values: of any shape
    slopes: from weights of the values (their shape) to the derivatives of their weighted sum: by order of the
        derivative of the motion, (N, n)
    """

    kind: str
    name: str
    values: Array
    slopes: Callable[[Array], Mapping[int, Array]]


def usage(signal: Signal) -> Usage:
    """Use of a limit: the true maximum over the grid."""
    return Usage(signal.kind, signal.name, float(signal.values.max()))


def smooth_maximum(signal: Signal, sharpness: float) -> float:
    """Smooth maximum K of the values."""
    top = signal.values.max()
    return float(top + np.log(np.exp(sharpness * (signal.values - top)).sum()) / sharpness)


def smooth_slope(signal: Signal, phi: Sequence[Array], sharpness: float) -> Array:
    """Derivative of K by the coefficients (n, K_basis). phi: the rows of the basis, of orders 0 … 3."""
    grown = np.exp(sharpness * (signal.values - signal.values.max()))
    return np.asarray(sum(part.T @ phi[order] for order, part in signal.slopes(grown / grown.sum()).items()))
