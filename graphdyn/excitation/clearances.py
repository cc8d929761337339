"""Points and balls of the robot that planes keep on one side, and that keep clear of each other.

Distances between the balls of two parts of a robot, as a limit of its motion.

Only balls that come nearly as near to each other as the nearest two are looked at: what is farther apart has no weight
in the smooth maximum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from graphdyn.equations.kinematics import joint_axes, link_origins, maximal_state
from graphdyn.excitation.limits import Clearance
from graphdyn.excitation.trajectory import Signal
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import cross

Numbers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Ball:
    """A ball fixed in a body: center in its link frame (3,) [m], and radius [m]; 0 is a point. Body 0 is the ground."""

    body: int
    center: Array
    radius: float = 0.0


def frame_origins(model: RobotModel) -> tuple[Ball, ...]:
    """The origins of all frames that move: bodies and the links that are fused into them, a tool among them."""
    origins = [(body, (0.0, 0.0, 0.0)) for body in range(1, model.n_bodies + 1)]
    origins += [(frame.body, tuple(frame.placement.translation.tolist())) for frame in model.frames if frame.body]
    return tuple(Ball(body, np.array(center)) for body, center in dict.fromkeys(origins))


def ball_around(balls: Sequence[Ball]) -> Ball:
    """Around balls of one body."""
    centers = np.array([ball.center for ball in balls])
    radii = np.array([ball.radius for ball in balls])
    middle = (centers.max(axis=0) + centers.min(axis=0)) / 2
    return Ball(balls[0].body, middle, float(np.max(np.linalg.norm(centers - middle, axis=1) + radii)))


class Poses:
    """Where the bodies of a robot are at positions q (N, n_freedoms), and how forces on balls act on its joints."""

    def __init__(self, model: RobotModel, q: Array) -> None:
        self._model = model
        self._state = maximal_state(model, q, method="recursive")
        self._origins = link_origins(self._state)
        self._centers: dict[tuple[Ball, ...], Array] = {}

    def __len__(self) -> int:
        return len(self._origins)

    def of_body(self, body: int) -> tuple[Array, Array]:
        """Rotation (N, 3, 3) and origin of the link frame (N, 3) [m], world axes; of the ground for 0."""
        vertices = self._state.vertices
        origin = self._state.ground.position if body == 0 else self._origins[:, body - 1]  # type: ignore[union-attr]
        return vertices.rotation[:, body], origin

    def centers(self, balls: tuple[Ball, ...]) -> Array:
        """World positions (N, balls, 3) [m], computed once for the same balls."""
        if balls not in self._centers:
            self._centers[balls] = self._computed(balls)
        return self._centers[balls]

    def _computed(self, balls: tuple[Ball, ...]) -> Array:
        carrying = np.array([ball.body for ball in balls])
        local = np.array([ball.center for ball in balls])
        found = np.empty((len(self._origins), len(balls), 3))
        for body in np.unique(carrying).tolist():
            rotation, origin = self.of_body(body)
            mine = carrying == body
            found[:, mine] = local[mine] @ rotation.swapaxes(-1, -2) + origin[:, None]
        return found

    def joint_forces(self, rows: Numbers, bodies: Numbers, points: Array, forces: Array) -> Array:
        """Generalised forces (N, n_freedoms) of forces (K, 3) at points (K, 3) of bodies (K,) in the poses rows (K,).

        A revolute joint feels the moment of all forces beyond it about its axis, a prismatic one their part along it:
        Jᵀ f. World axes [m].
        """
        model = self._model
        moments = cross(points[:, None] - self._origins[rows], forces[:, None])
        felt = np.where(self._is_revolute[:, None], moments, forces[:, None])
        along = (felt * self._axes[rows]).sum(axis=-1) * self._beyond[bodies]
        total = np.zeros((len(self), model.n_bodies))
        np.add.at(total, rows, along)
        return np.asarray(total @ model.freedoms.matrix)

    @cached_property
    def _is_revolute(self) -> NDArray[np.bool_]:
        return np.array([not joint.is_prismatic for joint in self._model.joints])

    @cached_property
    def _axes(self) -> Array:
        """Of the joints (N, n, 3)."""
        return joint_axes(self._state)

    @cached_property
    def _beyond(self) -> Array:
        """1 in row i, column j if joint j carries body i; the ground is row 0 (n + 1, n)."""
        carried = self._model.graph.path_matrix().T.astype(float)
        return np.vstack([np.zeros(self._model.n_bodies), carried])


SCALE = 0.01
"""[m] In which distances are measured: the smooth maximum is sharp to some SCALE / ρ, and what is by SCALE farther
away than the nearest has the weight exp(-ρ)."""

FIRST = 5
"""Balls that are nearest to the ball around all others: the nearest two are looked for there first."""


def clearance_signal(clearance: Clearance, poses: Poses) -> Signal:
    """1 - (|c_i - c_j| - r_i - r_j - distance) / SCALE of the balls i of one body and j of the other."""
    row, i, j, distance = _near(clearance, poses)

    def slopes(weights: Array) -> dict[int, Array]:
        one, other = poses.centers(clearance.one)[row, i], poses.centers(clearance.other)[row, j]
        apart = one - other
        length = np.linalg.norm(apart, axis=-1, keepdims=True)
        pull = -weights[:, None] / SCALE * apart / np.where(length > 0, length, 1.0)
        ends = [np.full(len(row), balls[0].body) for balls in (clearance.one, clearance.other)]
        return {0: poses.joint_forces(row, ends[0], one, pull) + poses.joint_forces(row, ends[1], other, -pull)}

    return Signal("clearance", clearance.name, 1 - (distance - clearance.distance) / SCALE, slopes)


def smallest_distances(clearance: Clearance, poses: Poses) -> Array:
    """Of any two balls, in each pose (N,) [m]."""
    local = _in_frame_of_one(clearance, poses)
    distances = _distances(clearance, local.reshape(-1, 3), np.tile(np.arange(len(clearance.other)), len(local)))
    return np.asarray(distances.reshape(len(local), -1).min(axis=1))


def _near(clearance: Clearance, poses: Poses) -> tuple[Numbers, Numbers, Numbers, Array]:
    """Pose, ball of one, ball of the other, distance (K,) of all that are less than SCALE farther than the nearest.

    What each ball of the other keeps farther away from the ball around all of one is passed over.
    """
    local = _in_frame_of_one(clearance, poses)
    around, radius = clearance.around, _radii(clearance.other)
    bound = np.linalg.norm(local - around[0].center, axis=-1) - around[0].radius - radius
    first = np.argpartition(bound.ravel(), min(FIRST, bound.size - 1))[:FIRST]
    row, j = np.unravel_index(first, bound.shape)
    limit = SCALE + _distances(clearance, local[row, j], j).min()
    row, j = np.nonzero(bound <= limit)
    distances = _distances(clearance, local[row, j], j)
    k, i = np.nonzero(distances <= distances.min() + SCALE)
    return row[k], i, j[k], distances[k, i]


def _in_frame_of_one(clearance: Clearance, poses: Poses) -> Array:
    """Centers of the other's balls in the link frame of one (N, balls of the other, 3) [m]."""
    rotation, origin = poses.of_body(clearance.one[0].body)
    return np.asarray((poses.centers(clearance.other) - origin[:, None]) @ rotation)


def _distances(clearance: Clearance, centers: Array, j: Numbers) -> Array:
    """From balls j of the other, at centers (K, 3) in the frame of one, to all of one (K, balls), between surfaces."""
    own = np.array([ball.center for ball in clearance.one])
    square = (centers**2).sum(axis=-1)[:, None] + (own**2).sum(axis=-1) - 2 * centers @ own.T
    return np.asarray(np.sqrt(np.maximum(square, 0.0)) - _radii(clearance.one) - _radii(clearance.other)[j, None])


def _radii(balls: Sequence[Ball]) -> Array:
    return np.array([ball.radius for ball in balls])
