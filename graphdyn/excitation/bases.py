"""Basis functions of time for the position of every joint: q_j(t) = Σ_k c_jk φ_k(t).

All of them begin and end with zero velocity and acceleration. Velocities, accelerations and jerks are the exact
derivatives, so that every limit of a joint's motion is linear in the coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from graphdyn.errors import InvalidInput
from graphdyn.layout import Array

SPLINE_DEGREE = 5
"""Degree of the splines: with quintic ones the jerk is continuous."""


class Basis(Protocol):
    """K functions of time on 0 … duration."""

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        ...

    @property
    def size(self) -> int:
        """Number of functions K."""
        ...

    @property
    def middle(self) -> Array:
        """Coefficients (K,) of the constant function 1."""
        ...

    def rows(self, times: Array, order: int) -> Array:
        """Derivatives φ_k^(order) (N, K) at the times (N,) [1/s^order]."""
        ...


@dataclass(frozen=True)
class FourierBasis:
    """Harmonics 1 … L of one period, as long as the whole motion, and a constant: K = 2 L - 1 functions.

    The periodic excitation of Swevers et al., "Optimal robot excitation and identification", IEEE Transactions on
    Robotics and Automation 13(5), 1997, restricted to series whose velocity and acceleration are zero at the ends of
    the period. In the notation of motion_laws.FourierSeries: Σ_l a_l = 0 and Σ_l l b_l = 0.
    """

    duration: float
    harmonics: int = 5

    def __post_init__(self) -> None:
        _check_duration(self.duration)
        if self.harmonics < 2:
            raise InvalidInput(f"{self.harmonics} harmonics cannot start and stop smoothly; give two or more")

    @property
    def size(self) -> int:
        """Number of functions K."""
        return 2 * self.harmonics - 1

    @property
    def middle(self) -> Array:
        """Coefficients (K,) of the constant function 1."""
        return np.asarray(np.eye(self.size)[0])

    def rows(self, times: Array, order: int) -> Array:
        """Derivatives φ_k^(order) (N, K) at the times (N,) [1/s^order]."""
        w = self._frequencies
        turned = np.asarray(times, dtype=float)[:, None] * w + (order - 1) * np.pi / 2  # each derivative turns by π/2
        sines, cosines = w ** (order - 1) * np.cos(turned), w ** (order - 1) * np.sin(turned)
        constant = np.full((len(turned), 1), 1.0 if order == 0 else 0.0)
        of_a, of_b = self._combinations
        return np.hstack([constant, sines @ of_a, cosines @ of_b])

    def series(self, coefficients: Array) -> tuple[Array, Array, float]:
        """a, b (L,) and offset of motion_laws.FourierSeries for one joint's coefficients (K,)."""
        of_a, of_b = self._combinations
        split = self.harmonics
        return of_a @ coefficients[1:split], of_b @ coefficients[split:], float(coefficients[0])

    @cached_property
    def _frequencies(self) -> Array:
        """Angular frequencies l ω (L,) [rad/s]."""
        return np.asarray(2 * np.pi / self.duration * np.arange(1, self.harmonics + 1))

    @cached_property
    def _combinations(self) -> tuple[Array, Array]:
        """Orthonormal a and b (L, L - 1) each, with v = 0 and a = 0 at the ends."""
        harmonic = np.arange(1, self.harmonics + 1)
        return _normal_to(np.ones(self.harmonics)), _normal_to(harmonic.astype(float))


@dataclass(frozen=True)
class SplineBasis:
    """Quintic B-splines over pieces of equal length; start and end may be different poses. K = pieces + 1 functions."""

    duration: float
    pieces: int = 12

    def __post_init__(self) -> None:
        _check_duration(self.duration)
        if self.pieces < 2:
            raise InvalidInput(f"{self.pieces} piece of a spline cannot move; give two or more")

    @property
    def size(self) -> int:
        """Number of functions K."""
        return self.pieces + 1

    @property
    def middle(self) -> Array:
        """Coefficients (K,) of the constant function 1."""
        return np.full(self.size, 1 / self._length)

    def rows(self, times: Array, order: int) -> Array:
        """Derivatives φ_k^(order) (N, K) at the times (N,) [1/s^order]."""
        from scipy.interpolate import BSpline  # imported where first used: import graphdyn stays light

        degree, n = SPLINE_DEGREE, self.pieces + SPLINE_DEGREE
        ends = [0.0] * degree, [self.duration] * degree
        knots = np.concatenate([ends[0], np.linspace(0, self.duration, self.pieces + 1), ends[1]])
        spline = BSpline(knots, np.eye(n), degree)
        inside = np.clip(np.asarray(times, dtype=float), 0.0, self.duration)
        whole = np.asarray((spline.derivative(order) if order else spline)(inside))
        # velocity and acceleration are zero at an end where its first three coefficients are equal
        first, inner, last = whole[:, :3].sum(axis=1), whole[:, 3:-3], whole[:, -3:].sum(axis=1)
        return np.asarray(self._length * np.column_stack([first, inner, last]))

    @property
    def _length(self) -> float:
        """Length of a piece [s]: coefficients have the size of velocities, like those of FourierBasis."""
        return self.duration / self.pieces


def _normal_to(direction: Array) -> Array:
    """An orthonormal basis (L, L - 1) of the vectors normal to a direction (L,)."""
    basis, _ = np.linalg.qr(direction[:, None], mode="complete")
    return np.asarray(basis[:, 1:])


def _check_duration(duration: float) -> None:
    if not (duration > 0 and np.isfinite(duration)):
        raise InvalidInput(f"duration is {duration!r}; give seconds above zero")
