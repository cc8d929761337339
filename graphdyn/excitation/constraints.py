"""Use of every limit by a motion, and its derivatives by the motion.

Among the limits are distances between the bounding spheres of two parts of a robot. Only spheres nearly as close to
each other as the closest two count: those farther apart have no weight in the smooth maximum.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np

from graphdyn.excitation.limits import Clearance, MotionLimits, Numbers, Plane, Poses, Sphere
from graphdyn.excitation.trajectory import JointMotion, Signal
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.derivatives import inverse_dynamics_derivatives
from graphdyn.verbs.dynamics import joint_torques

DISTANCE_SCALE = 0.01
"""Unit of distances [m]: the smooth maximum is sharp to some DISTANCE_SCALE / ρ, and a pair that is farther apart than
the closest one by DISTANCE_SCALE has the weight exp(-ρ)."""

NEAREST_SPHERES = 5
"""Number of spheres, closest to the sphere around all others, among which the search for the closest pair starts."""


def clearance_signal(clearance: Clearance, poses: Poses) -> Signal:
    """1 - (|c_i - c_j| - r_i - r_j - distance) / DISTANCE_SCALE of the spheres i of one body and j of the other."""
    row, i, j, distance = _near(clearance, poses)

    def slopes(weights: Array) -> dict[int, Array]:
        one, other = poses.centers(clearance.one)[row, i], poses.centers(clearance.other)[row, j]
        apart = one - other
        length = np.linalg.norm(apart, axis=-1, keepdims=True)
        pull = -weights[:, None] / DISTANCE_SCALE * apart / np.where(length > 0, length, 1.0)
        ends = [np.full(len(row), spheres[0].body) for spheres in (clearance.one, clearance.other)]
        return {0: poses.joint_forces(row, ends[0], one, pull) + poses.joint_forces(row, ends[1], other, -pull)}

    return Signal("clearance", clearance.name, 1 - (distance - clearance.distance) / DISTANCE_SCALE, slopes)


def smallest_distances(clearance: Clearance, poses: Poses) -> Array:
    """Smallest distance between any two spheres, in each pose (N,) [m]."""
    local = _in_frame_of_one(clearance, poses)
    distances = _distances(clearance, local.reshape(-1, 3), np.tile(np.arange(len(clearance.other)), len(local)))
    return np.asarray(distances.reshape(len(local), -1).min(axis=1))


def _near(clearance: Clearance, poses: Poses) -> tuple[Numbers, Numbers, Numbers, Array]:
    """Pose, sphere of one, sphere of the other, distance (K,) of all pairs within DISTANCE_SCALE of the closest.

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
    own = np.array([sphere.center for sphere in clearance.one])
    square = (centers**2).sum(axis=-1)[:, None] + (own**2).sum(axis=-1) - 2 * centers @ own.T
    return np.asarray(np.sqrt(np.maximum(square, 0.0)) - _radii(clearance.one) - _radii(clearance.other)[j, None])


def _radii(spheres: Sequence[Sphere]) -> Array:
    return np.array([sphere.radius for sphere in spheres])


UNBOUNDED_SCALE = 1.0
"""Unit of positions with one limit alone [rad or m], and of speeds of planes [m]."""

NEGLIGIBLE_WEIGHT = 1e-15
"""Weight in a smooth maximum below which a point does not change its slope."""


def signals(
    model: RobotModel, limits: MotionLimits, spheres: Sequence[Sphere], motion: JointMotion
) -> Iterator[Signal]:
    """Signals of all limits, in a fixed order; the slowest come last."""
    yield from _of_positions(model, limits, motion)
    matrix = model.degrees_of_freedom.matrix
    for order, kind in enumerate(("velocity", "acceleration", "jerk"), start=1):
        largest = getattr(limits, kind)
        for j in np.flatnonzero(np.isfinite(largest)):
            rate = motion[order] @ matrix[j] / largest[j]
            weights = np.stack([matrix[j], -matrix[j]]) / largest[j]
            yield _linear(kind, model.joint_names[j], np.stack([rate, -rate], 1), order, weights)
    yield from _of_torques(model, limits, motion)
    if limits.planes or limits.clearances:
        poses = Poses(model, motion.q)
        yield from _of_planes(limits, spheres, poses)
        for clearance in limits.clearances:
            yield clearance_signal(clearance, poses)


def _linear(kind: str, name: str, values: Array, order: int, weights: Array) -> Signal:
    """Signal of values (N, m) that are linear in one derivative of the motion; weights of the joints (m, n)."""
    return Signal(kind, name, values, lambda share: {order: share @ weights})


def _of_positions(model: RobotModel, limits: MotionLimits, motion: JointMotion) -> list[Signal]:
    found = []
    matrix, offset = model.degrees_of_freedom.matrix, model.degrees_of_freedom.offset
    for j, (lower, upper) in enumerate(zip(limits.lower, limits.upper, strict=True)):
        half = (upper - lower) / 2 if np.isfinite(upper - lower) else UNBOUNDED_SCALE
        position = motion.q @ matrix[j] + offset[j]
        sides = [(1.0, upper), (-1.0, -lower)]
        bounded = [(sign, limit) for sign, limit in sides if np.isfinite(limit)]
        if bounded:
            values = np.stack([1 + (sign * position - limit) / half for sign, limit in bounded], axis=1)
            weights = np.stack([sign * matrix[j] / half for sign, _ in bounded])
            found.append(_linear("position", model.joint_names[j], values, 0, weights))
    return found


def _of_torques(model: RobotModel, limits: MotionLimits, motion: JointMotion) -> list[Signal]:
    """Signal of the torques: rigid bodies, and the friction that the model states."""
    limited = np.flatnonzero(np.isfinite(limits.torque))
    if not limited.size:
        return []
    q, v, a = motion[:3]
    joints = [model.joints[k] for k in model.degrees_of_freedom.independent]
    damping = np.array([joint.damping for joint in joints])
    friction = np.array([joint.friction for joint in joints])
    tau = joint_torques(model, q, v, a, method="recursive") + damping * v

    @cache
    def derivatives() -> tuple[Array, Array, Array]:
        by = inverse_dynamics_derivatives(model, q, v, a, method="recursive")
        return by.dtau_dq, by.dtau_dv + np.diag(damping), by.dtau_da

    def signal(j: int) -> Signal:
        largest = limits.torque[j]
        values = (np.stack([tau[:, j], -tau[:, j]], axis=1) + friction[j]) / largest

        def slopes(share: Array) -> dict[int, Array]:
            weight = (share[:, :1] - share[:, 1:]) / largest
            return {order: weight * part[:, j] for order, part in enumerate(derivatives())}

        return Signal("torque", joints[j].name, values, slopes)

    return [signal(int(j)) for j in limited]


def _of_planes(limits: MotionLimits, spheres: Sequence[Sphere], poses: Poses) -> list[Signal]:
    if not limits.planes:
        return []
    centers = poses.centers(tuple(spheres))
    radii = np.array([sphere.radius for sphere in spheres])
    bodies = np.array([sphere.body for sphere in spheres])

    def signal(number: int, plane: Plane) -> Signal:
        normal = np.asarray(plane.normal, dtype=float)
        height = centers @ normal - radii - plane.distance

        def slopes(share: Array) -> dict[int, Array]:
            row, sphere = np.nonzero(share > NEGLIGIBLE_WEIGHT)
            forces = -share[row, sphere, None] / UNBOUNDED_SCALE * normal
            return {0: poses.joint_forces(row, bodies[sphere], centers[row, sphere], forces)}

        return Signal("plane", f"plane {number}", 1 - height / UNBOUNDED_SCALE, slopes)

    return [signal(number, plane) for number, plane in enumerate(limits.planes, start=1)]
