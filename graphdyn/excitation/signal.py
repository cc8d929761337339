"""Numbers over time that have to stay below 1, and their smooth maximum.

A limit is one number: a smooth maximum over the grid of time and over all numbers that are limited together,

    K = m + ln Σ exp(ρ (g - m)) / ρ,    m = max g ≤ K ≤ m + ln(number of g) / ρ,    g = |v_t| / v_max and so on

(Kreisselmeier and Steinhauser, 1979): never below the true maximum, and differentiable. A motion keeps the limit
where K ≤ 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.layout import Array


@dataclass(frozen=True)
class Usage:
    """Of one limit.

    kind: "position", "velocity", "acceleration", "jerk", "torque", "plane" or "clearance"
    name: of the joint, of the plane, or of the two parts of the robot
    used: largest part of the limit that the motion uses; above 1 it is violated. Of a position, a plane or a clearance
        it is 1 at the limit
    """

    kind: str
    name: str
    used: float


@dataclass(frozen=True, eq=False)
class Signal:
    """Of one limit.

    values: of any shape
    slopes: from weights of the values (their shape) to the derivatives of their weighted sum: by order of the
        derivative of the motion, (N, n)
    """

    kind: str
    name: str
    values: Array
    slopes: Callable[[Array], Mapping[int, Array]]


def usage(signal: Signal) -> Usage:
    """The true maximum over the grid."""
    return Usage(signal.kind, signal.name, float(signal.values.max()))


def smooth_maximum(signal: Signal, sharpness: float) -> float:
    """K"""
    top = signal.values.max()
    return float(top + np.log(np.exp(sharpness * (signal.values - top)).sum()) / sharpness)


def smooth_slope(signal: Signal, phi: Sequence[Array], sharpness: float) -> Array:
    """Derivative of K by the coefficients (n, K_basis). phi: the rows of the basis, of orders 0 … 3."""
    grown = np.exp(sharpness * (signal.values - signal.values.max()))
    return np.asarray(sum(part.T @ phi[order] for order, part in signal.slopes(grown / grown.sum()).items()))
