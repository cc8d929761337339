"""The joint axes of a serial robot as lines in the world at q = 0, and motions that carry lines onto others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphdyn.display import short_repr
from graphdyn.layout import Array
from graphdyn.model import cross, rotation_about, rotation_vector
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import Placement


@dataclass(frozen=True, eq=False)
@short_repr
class JointAxes:
    """The axes of n joints, in the world at q = 0.

    links: link frame of every body in the world             (n, 4, 4)
    directions: unit vectors                                (n, 3)
    points: the joint origins, points of the axes           (n, 3)  [m]
    slides: whether the joint is prismatic                  (n,)
    """

    links: Array
    directions: Array
    points: Array
    slides: tuple[bool, ...]

    @classmethod
    def of(cls, model: RobotModel) -> JointAxes:
        """The axes of a serial robot."""
        link, links = matrix(model.base), []
        for joint in model.joints:
            link = link @ matrix(joint.placement)
            links.append(link)
        stacked = np.array(links)
        axes = np.array([joint.axis for joint in model.joints])
        directions = (stacked[:, :3, :3] @ axes[:, :, None])[:, :, 0]
        return cls(stacked, directions, stacked[:, :3, 3], tuple(joint.is_prismatic for joint in model.joints))

    @cached_property
    def reach(self) -> float:
        """Length of the robot from the first joint, along the joint origins [m]; 1 where there is none."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum()) or 1.0

    @property
    def outer(self) -> JointAxes:
        """The axes without the first."""
        return JointAxes(self.links[1:], self.directions[1:], self.points[1:], self.slides[1:])


def matrix(placement: Placement) -> Array:
    """The homogeneous matrix (4, 4) of a placement."""
    return _homogeneous(placement.rotation, placement.translation)


def placement_of(homogeneous: Array) -> Placement:
    """The placement of a homogeneous matrix (4, 4), with a rotation freed of what rounding has added."""
    u, _, vt = np.linalg.svd(homogeneous[:3, :3])
    return Placement(u @ vt, homogeneous[:3, 3])


def moved_by(vector: Array) -> Array:
    """The homogeneous matrix (4, 4) of a translation [m]."""
    return _homogeneous(np.eye(3), vector)


def turned_about(direction: Array, point: Array, angle: float) -> Array:
    """The homogeneous matrix (4, 4) of a rotation [rad] about a line."""
    rotation = rotation_about(direction, angle)
    return _homogeneous(rotation, point - rotation @ point)


def carried(motion: Array, direction: Array, point: Array) -> tuple[Array, Array]:
    """Direction and point of a line that a homogeneous matrix (4, 4) moves."""
    return motion[:3, :3] @ direction, motion[:3, :3] @ point + motion[:3, 3]


def turned_onto(start: Array, end: Array, point: Array) -> Array:
    """The smallest rotation about a point that turns one unit vector onto another, as a homogeneous matrix (4, 4)."""
    normal = cross(start, end)
    sine, cosine = float(np.linalg.norm(normal)), float(start @ end)
    if sine == 0.0:
        if cosine > 0:
            return np.eye(4)
        normal = cross(start, np.eye(3)[int(np.argmin(np.abs(start)))])
    return turned_about(normal / np.linalg.norm(normal), point, float(np.arctan2(sine, cosine)))


def angle_between(a: Array, b: Array) -> float:
    """The angle of two unit vectors, from 0 to π [rad], exact for small ones."""
    return float(np.arctan2(np.linalg.norm(cross(a, b)), a @ b))


def turn_about(direction: Array, start: Array, end: Array) -> float:
    """The angle by which start must turn about a unit vector, to lie in one half plane with end [rad]."""
    first, second = across(direction, start), across(direction, end)
    return float(np.arctan2(direction @ cross(first, second), first @ second))


def across(direction: Array, vector: Array) -> Array:
    """The part of a vector that is perpendicular to a unit vector."""
    part: Array = vector - (direction @ vector) * direction
    return part


def rotation_angle(rotation: Array) -> float:
    """The angle of a rotation matrix, from 0 to π [rad], exact for small ones."""
    return float(np.linalg.norm(rotation_vector(rotation)))


def twist_about(direction: Array, rotation: Array) -> float:
    """The angle about a unit vector of the rotation about it that is nearest to a rotation matrix [rad]."""
    along = float(direction @ rotation @ direction)
    sines = np.array([rotation[b, a] - rotation[a, b] for a, b in ((1, 2), (2, 0), (0, 1))])  # 2 axis sine, of R - Rᵀ
    return float(np.arctan2(direction @ sines, np.trace(rotation) - along))


def _homogeneous(rotation: Array, translation: Array) -> Array:
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = rotation, translation
    return whole
