"""Random motions within limits: starts of the search, and a comparison for its result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.excitation.bases import Basis
from graphdyn.excitation.constraints import signals
from graphdyn.excitation.limits import MotionLimits, Sphere
from graphdyn.excitation.trajectory import Trajectory, usage
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

LIMIT_CHECK_POINTS = 240
"""Number of instants at which limits are checked; in between a random motion may violate them slightly."""

SCALE_HALVINGS = 12
"""Halvings of the interval in the search for the largest scale within all limits: to a part in 4000."""

LIMIT_TOLERANCE = 1e-9
"""Relative amount by which rounding may exceed a limit."""

MAX_DRAWS = 20
"""Most positions that are drawn: some robots cannot hold themselves in every pose, or hardly move there."""


def random_trajectory(
    model: RobotModel,
    limits: MotionLimits,
    spheres: Sequence[Sphere],
    basis: Basis,
    rng: np.random.Generator,
    least: float = 0.0,
) -> Trajectory:
    """A motion with normal random coefficients that reaches a limit with every joint, as far as the others allow.

    Each joint is scaled until it reaches its own limit of position, velocity, acceleration or jerk, and placed at
    random within its range. Then all joints are scaled together until torques, planes and clearances are kept. If even
    standstill in that pose violates a limit, or the scale is not above least, another motion is drawn; the largest of
    all is returned.
    """
    times = np.linspace(0.0, basis.duration, LIMIT_CHECK_POINTS)
    phi = [basis.rows(times, order) for order in range(4)]
    largest = -1.0
    for _ in range(MAX_DRAWS):
        moving, middle = _within_own_limits(model, limits, basis, phi, rng)
        scale = _largest_scale(model, limits, spheres, basis, times, moving, middle)
        if scale > largest:
            largest, coefficients = scale, scale * moving + middle[:, None] * basis.middle
        if scale > least:
            break
    return Trajectory(basis, coefficients)


def _within_own_limits(
    model: RobotModel, limits: MotionLimits, basis: Basis, phi: Sequence[Array], rng: np.random.Generator
) -> tuple[Array, Array]:
    """Coefficients (n, K) of a motion about zero, and its mean positions (n,)."""
    free = list(model.degrees_of_freedom.independent)
    moving, middle = rng.normal(size=(len(free), basis.size)), np.zeros(len(free))
    for row, j in enumerate(free):
        q = phi[0] @ moving[row]
        moving[row] -= (q.max() + q.min()) / 2 * basis.middle
        reach = np.ptp(q) / 2
        lower, upper = limits.lower[j], limits.upper[j]
        room = (upper - lower) / 2
        sizes = [np.abs(rows @ moving[row]).max() for rows in phi[1:]]
        largest = (limits.velocity[j], limits.acceleration[j], limits.jerk[j])
        scale = min([room / reach, *(most / size for most, size in zip(largest, sizes, strict=True))])
        moving[row] *= scale
        nearest, farthest = lower + scale * reach, upper - scale * reach
        if not np.isfinite(room):
            nearest, farthest = _drawing_range(nearest, farthest)
        middle[row] = rng.uniform(nearest, max(nearest, farthest))
    return moving, middle


def _drawing_range(lower: float, upper: float) -> tuple[float, float]:
    """Range of positions: half a turn to both sides of zero, or a turn from the only limit."""
    if np.isfinite(lower):
        return lower, lower + 2 * np.pi
    return (upper - 2 * np.pi, upper) if np.isfinite(upper) else (-np.pi, np.pi)


def _largest_scale(
    model: RobotModel,
    limits: MotionLimits,
    spheres: Sequence[Sphere],
    basis: Basis,
    times: Array,
    moving: Array,
    middle: Array,
) -> float:
    """Largest scale in 0 … 1, to a part in 2^SCALE_HALVINGS; zero if the robot cannot stand still there."""

    def kept(scale: float) -> bool:
        instants = times if scale else times[:1]
        motion = Trajectory(basis, scale * moving + middle[:, None] * basis.middle).motion(instants)
        return all(usage(one).used <= 1 + LIMIT_TOLERANCE for one in signals(model, limits, spheres, motion))

    if kept(1.0):
        return 1.0
    if not kept(0.0):
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(SCALE_HALVINGS):
        scale = (low + high) / 2
        low, high = (scale, high) if kept(scale) else (low, scale)
    return low
