"""Boxes that hold the links of a robot without meshes, from its kinematics.

A link reaches from its joint to the joints that it carries, and about as far again in every direction: drives, flanges
and counterweights lie beyond the axes, and the origin of a frame may lie anywhere on its axis.
"""

from __future__ import annotations

import numpy as np

from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

UNIFORM_EXTENT = np.sqrt(3.0)
"""Half the extent of a uniform rod in units of the root mean square distance from its center."""


def reach_boxes(model: RobotModel) -> Array:
    """Lower and upper corner of a box per body, in link axes from the link origin (n, 2, 3) [m].

    The box holds the origins of the own joint and of those that the body carries, and on every side a margin: the
    longest distance of these joints and of the one before, at least the mean over the robot.
    """
    own = np.array([np.linalg.norm(joint.placement.translation) for joint in model.joints])
    least = own[own > 0].mean() if np.any(own > 0) else 0.0
    boxes = np.empty((model.n_bodies, 2, 3))
    for i in range(model.n_bodies):
        ahead = [joint.placement.translation for joint in model.joints if joint.inside == i + 1]
        margin = max([least, own[i], *(float(np.linalg.norm(place)) for place in ahead)])
        points = np.array([np.zeros(3), *ahead])
        boxes[i] = points.min(axis=0) - margin, points.max(axis=0) + margin
    return boxes


MAX_GYRATION_RATIO, MIN_LINK_SIZE, MAX_GYRATION_RADIUS = 5.0, 0.1, 2.0
"""A radius of gyration beyond MAX_GYRATION_RATIO times the size of a link, and no link counts as smaller than
MIN_LINK_SIZE, or beyond MAX_GYRATION_RADIUS [m] does not fit its mass: where `urdf.inspect` warns."""


def gyration_radii(model: RobotModel) -> Array:
    """Largest radius of gyration of every body by its joints (n,) [m]."""
    sizes = np.full(model.n_bodies, MIN_LINK_SIZE)
    for joint in model.joints:
        if joint.inside > 0:
            far = float(np.linalg.norm(joint.placement.translation))
            sizes[joint.inside - 1] = max(sizes[joint.inside - 1], far)
    return np.minimum(MAX_GYRATION_RATIO * sizes, MAX_GYRATION_RADIUS)


def extents(pseudo_inertia: Array) -> Array:
    """Boxes of uniform bodies with these pseudo-inertia matrices (n, 4, 4), lower and upper corners (n, 2, 3) [m]."""
    center, squares = _moments(pseudo_inertia)
    half = UNIFORM_EXTENT * np.sqrt(squares)
    return np.stack([center - half, center + half], axis=1)


def spreads(pseudo_inertia: Array) -> Array:
    """Root mean square distance of the matter of each body from its center (n,) [m], at least the radius of
    gyration about any axis."""
    return np.asarray(np.sqrt(_moments(pseudo_inertia)[1].sum(axis=1)))


def _moments(pseudo_inertia: Array) -> tuple[Array, Array]:
    """Centers of mass (n, 3), and mean squares of the distance from them along each axis (n, 3)."""
    mass = pseudo_inertia[:, 3, 3, None]
    center = pseudo_inertia[:, :3, 3] / mass
    return center, np.einsum("nkk->nk", pseudo_inertia[:, :3, :3]) / mass - center**2


def joined(boxes: Array, others: Array) -> Array:
    """The smallest boxes that hold both (…, 2, 3)."""
    return np.stack(
        [np.minimum(boxes[..., 0, :], others[..., 0, :]), np.maximum(boxes[..., 1, :], others[..., 1, :])], axis=-2
    )
