"""Points of the robot that planes of the working space keep on one side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn._kinematics import joint_axes, link_origins, maximal_state
from graphdyn._model import RobotModel
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Ball:
    """A ball fixed in a body, numbered from 1: center in its link frame (3,) [m], and radius [m]; 0 is a point."""

    body: int
    center: Array
    radius: float = 0.0


def frame_origins(model: RobotModel) -> tuple[Ball, ...]:
    """The origins of all frames that move: bodies and the links that are fused into them, a tool among them."""
    origins = [(body, (0.0, 0.0, 0.0)) for body in range(1, model.n_bodies + 1)]
    origins += [(frame.body, tuple(frame.placement.translation.tolist())) for frame in model.frames if frame.body]
    return tuple(Ball(body, np.array(center)) for body, center in dict.fromkeys(origins))


def centers(model: RobotModel, balls: Sequence[Ball], q: Array) -> tuple[Array, Array]:
    """World positions (N, balls, 3) [m] and their derivatives by q (N, balls, 3, n_freedoms) [m or 1].

    A revolute joint on the path to the ball moves its center p by p_j × (p - O_j), a prismatic one by p_j.
    """
    state = maximal_state(model, q, method="recursive")
    origins, axes = link_origins(state), joint_axes(state)
    carrying = np.array([ball.body - 1 for ball in balls])
    local = np.array([ball.center for ball in balls])
    positions = origins[:, carrying] + np.einsum("tbxy,by->tbx", state.rotation[:, carrying], local)
    arms = positions[:, :, None] - origins[:, None]
    turned = np.cross(np.broadcast_to(axes[:, None], arms.shape), arms)
    revolute = np.array([not joint.is_prismatic for joint in model.joints])[:, None]
    moved = np.where(revolute, turned, axes[:, None]) * model.graph.path_matrix().T[carrying][:, :, None]
    return positions, np.einsum("tbjx,jn->tbxn", moved, model.freedoms.matrix)
