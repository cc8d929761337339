"""Distances between the bounding spheres of two parts of a robot, as a limit of its motion.

Only spheres nearly as close to each other as the closest two count: those farther apart have no weight
in the smooth maximum.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.excitation.limits import Clearance
from graphdyn.excitation.trajectory import Signal
from graphdyn.excitation.watched_points import Ball, Numbers, Poses
from graphdyn.layout import Array

DISTANCE_SCALE = 0.01
"""[m] Unit of distances: the smooth maximum is sharp to some DISTANCE_SCALE / ρ, and what is by DISTANCE_SCALE farther
away than the nearest has the weight exp(-ρ)."""

NEAREST_SPHERES = 5
"""Balls that are nearest to the ball around all others: the nearest two are looked for there first."""


def clearance_signal(clearance: Clearance, poses: Poses) -> Signal:
    """1 - (|c_i - c_j| - r_i - r_j - distance) / SCALE of the spheres i of one body and j of the other."""
    row, i, j, distance = _near(clearance, poses)

    def slopes(weights: Array) -> dict[int, Array]:
        one, other = poses.centers(clearance.one)[row, i], poses.centers(clearance.other)[row, j]
        apart = one - other
        length = np.linalg.norm(apart, axis=-1, keepdims=True)
        pull = -weights[:, None] / DISTANCE_SCALE * apart / np.where(length > 0, length, 1.0)
        ends = [np.full(len(row), balls[0].body) for balls in (clearance.one, clearance.other)]
        return {0: poses.joint_forces(row, ends[0], one, pull) + poses.joint_forces(row, ends[1], other, -pull)}

    return Signal("clearance", clearance.name, 1 - (distance - clearance.distance) / DISTANCE_SCALE, slopes)


def smallest_distances(clearance: Clearance, poses: Poses) -> Array:
    """Smallest distance between any two spheres, in each pose (N,) [m]."""
    local = _in_frame_of_one(clearance, poses)
    distances = _distances(clearance, local.reshape(-1, 3), np.tile(np.arange(len(clearance.other)), len(local)))
    return np.asarray(distances.reshape(len(local), -1).min(axis=1))


def _near(clearance: Clearance, poses: Poses) -> tuple[Numbers, Numbers, Numbers, Array]:
    """Pose, sphere of one, sphere of the other, distance (K,) of all pairs within SCALE of the closest.

    Spheres of the other that are farther away from the sphere around all of one are skipped.
    """
    local = _in_frame_of_one(clearance, poses)
    around, radius = clearance.around, _radii(clearance.other)
    bound = np.linalg.norm(local - around[0].center, axis=-1) - around[0].radius - radius
    first = np.argpartition(bound.ravel(), min(NEAREST_SPHERES, bound.size - 1))[:NEAREST_SPHERES]
    row, j = np.unravel_index(first, bound.shape)
    limit = DISTANCE_SCALE + _distances(clearance, local[row, j], j).min()
    row, j = np.nonzero(bound <= limit)
    distances = _distances(clearance, local[row, j], j)
    k, i = np.nonzero(distances <= distances.min() + DISTANCE_SCALE)
    return row[k], i, j[k], distances[k, i]


def _in_frame_of_one(clearance: Clearance, poses: Poses) -> Array:
    """Centers of the other's spheres in the link frame of one (N, spheres of the other, 3) [m]."""
    rotation, origin = poses.of_body(clearance.one[0].body)
    return np.asarray((poses.centers(clearance.other) - origin[:, None]) @ rotation)


def _distances(clearance: Clearance, centers: Array, j: Numbers) -> Array:
    """Distances between surfaces from spheres j of the other, at centers (K, 3) in the frame of one, to all spheres of
    one.

    The result has the shape (K, spheres).
    """
    own = np.array([ball.center for ball in clearance.one])
    square = (centers**2).sum(axis=-1)[:, None] + (own**2).sum(axis=-1) - 2 * centers @ own.T
    return np.asarray(np.sqrt(np.maximum(square, 0.0)) - _radii(clearance.one) - _radii(clearance.other)[j, None])


def _radii(balls: Sequence[Ball]) -> Array:
    return np.array([ball.radius for ball in balls])
