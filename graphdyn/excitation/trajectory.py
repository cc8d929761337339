"""Motions of all joints as functions of time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from graphdyn._arrays import as_floats
from graphdyn._errors import InvalidInput
from graphdyn.excitation.bases import SPLINE_DEGREE, Basis
from graphdyn.layout import Array


class JointMotion(NamedTuple):
    """Positions, velocities, accelerations, jerks (N, n) of the joints that no others drive [rad or m, …/s, …]."""

    q: Array
    v: Array
    a: Array
    jerk: Array


class Course(Protocol):
    """A motion from time zero to duration."""

    @property
    def duration(self) -> float:
        """[s]"""
        ...

    def motion(self, times: Array) -> JointMotion:
        """At the times (N,) [s]."""
        ...


@dataclass(frozen=True, eq=False)
class Trajectory:
    """q_j(t) = Σ_k coefficients[j, k] φ_k(t); coefficients (n, K)."""

    basis: Basis
    coefficients: Array

    @property
    def duration(self) -> float:
        """[s]"""
        return self.basis.duration

    def motion(self, times: Array) -> JointMotion:
        """At the times (N,) [s]."""
        return JointMotion(*(self.basis.rows(times, order) @ self.coefficients.T for order in range(4)))


@dataclass(frozen=True, eq=False)
class TabulatedCourse:
    """Positions at given times, joined by interpolating quintic splines; time counts from the first row.

    times: increasing                                       (K,)    [s]
    positions: of the joints that no others drive           (K, n)  [rad or m]

    Raises InvalidInput for fewer than six rows, times that do not increase, other shapes, NaN and infinity.
    """

    times: Array
    positions: Array

    def __post_init__(self) -> None:
        times, positions = as_floats("times", self.times), as_floats("positions", self.positions)
        if times.ndim != 1 or positions.ndim != 2 or len(times) != len(positions):
            raise InvalidInput(f"times have shape {times.shape}, positions {positions.shape}; (K,) and (K, n) needed")
        if len(times) <= SPLINE_DEGREE:
            raise InvalidInput(f"a motion of {len(times)} rows is too short; {SPLINE_DEGREE + 1} are needed")
        if not (np.all(np.isfinite(times)) and np.all(np.isfinite(positions)) and np.all(np.diff(times) > 0)):
            raise InvalidInput("the times of a motion must increase, and its positions be finite")
        object.__setattr__(self, "times", times - times[0])
        object.__setattr__(self, "positions", positions)

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.times[-1])

    def motion(self, times: Array) -> JointMotion:
        """At the times (N,) [s]; those outside count as the ends."""
        inside = np.clip(times, 0.0, self.duration)
        return JointMotion(*(np.asarray(spline(inside)) for spline in self._derivatives))

    @cached_property
    def _derivatives(self) -> tuple[Any, ...]:
        from scipy.interpolate import make_interp_spline  # imported where first used: import graphdyn stays light

        spline = make_interp_spline(self.times, self.positions, k=SPLINE_DEGREE)
        return (spline, *(spline.derivative(order) for order in (1, 2, 3)))


def sample_times(duration: float, rate: float) -> Array:
    """From zero to a duration at a rate [s, Hz], the end included where it is a multiple of the period."""
    return np.arange(int(duration * rate * (1 + 1e-12)) + 1) / rate
