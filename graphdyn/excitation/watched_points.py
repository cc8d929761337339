"""Points of the robot that planes of the working space keep on one side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn._frames import frame_jacobian
from graphdyn._kinematics import frame_placement
from graphdyn._model import RobotModel
from graphdyn.layout import ANGULAR, LINEAR, Array


@dataclass(frozen=True, eq=False)
class Ball:
    """A ball fixed in a named frame: center in its axes, (3,) [m], and radius [m]; a point without one."""

    frame: str
    center: Array
    radius: float = 0.0


def frame_origins(model: RobotModel) -> tuple[Ball, ...]:
    """The origins of all frames that move: bodies and the links that are fused into them, a tool among them."""
    names = list(model.body_names) + [frame.name for frame in model.frames if frame.body and frame.name]
    return tuple(Ball(name, np.zeros(3)) for name in dict.fromkeys(names))


def centers(model: RobotModel, balls: Sequence[Ball], q: Array) -> tuple[Array, Array]:
    """World positions (N, balls, 3) [m] and their derivatives by q (N, balls, 3, n_freedoms)."""
    positions, slopes = np.empty((len(q), len(balls), 3)), np.empty((len(q), len(balls), 3, model.n_freedoms))
    for name in dict.fromkeys(ball.frame for ball in balls):
        rotation, origin = frame_placement(model, q, name)
        jacobian = frame_jacobian(model, q, name, reference="local_world_aligned")
        for k in (k for k, ball in enumerate(balls) if ball.frame == name):
            arm = rotation @ balls[k].center
            positions[:, k] = origin + arm
            slopes[:, k] = jacobian[:, LINEAR] + np.cross(jacobian[:, ANGULAR], arm[:, :, None], axis=1)
    return positions, slopes
