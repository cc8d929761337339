"""How a frame fixed in a body moves, as the equations read.

With the reference "world" the point that is spoken of is not the origin of the frame but the world's origin, as a point
of the body or of the space that it carries with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.arguments.base_motion import ground
from graphdyn.equations.kinematics import MaximalState, joint_axes, link_origins
from graphdyn.equations.specification import Arguments
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.spatial import apply, cross


def frame_jacobian(x: Arguments) -> dict[str, Array]:
    """J (…, 6, n): per joint up to the frame, p × (from O_k to the point) over p; of a slide, p over 0."""
    state, seen = _seen(x)
    axes = joint_axes(state)
    revolute = np.array([not joint.is_prismatic for joint in x.model.joints])[:, None]
    linear = np.where(revolute, cross(axes, seen.point[..., None, :] - link_origins(state)), axes)
    columns = [linear, np.where(revolute, axes, 0.0)]
    on_path = x.model.graph.path_matrix()[:, seen.body - 1] if seen.body else np.zeros(x.model.n_bodies)
    rows = [seen.axes @ np.swapaxes(column * on_path[:, None], -1, -2) for column in columns]
    jacobian = np.concatenate(rows, axis=-2)
    return {"frame_jacobian": jacobian @ x.model.degrees_of_freedom.matrix if x.model.couplings else jacobian}


def frame_velocity(x: Arguments) -> dict[str, Array]:
    """ẋ = ṙ + ω × (x - r) of the point x, and ω (…, 6)."""
    _, seen = _seen(x)
    return {"frame_velocity": seen.turned(seen.velocity, seen.omega)}


def frame_acceleration(x: Arguments) -> dict[str, Array]:
    """ẍ = r̈ + ω̇ × (x - r) + ω × (ω × (x - r)) of the point x, less ω × ẋ if spatial, and ω̇ (…, 6)."""
    state, seen = _seen(x)
    assert state.acceleration is not None
    assert state.ground is not None
    assert x.frame is not None
    at_center, alpha = state.ground.acceleration[..., LINEAR], state.ground.acceleration[..., ANGULAR]
    if seen.body:
        at_center = state.acceleration[..., seen.body - 1, LINEAR]
        alpha = apply(state.rotation[..., seen.body - 1, :, :], state.acceleration[..., seen.body - 1, ANGULAR])
    linear = at_center + cross(alpha, seen.arm) + cross(seen.omega, cross(seen.omega, seen.arm))
    if not x.frame.classical:
        linear = linear - cross(seen.omega, seen.velocity)
    return {"frame_acceleration": seen.turned(linear, alpha)}


@dataclass(frozen=True, eq=False)
class _FramePoint:
    """What the choice of frame and reference means at a rooted state.

    body: the vertex that the frame is fixed in
    axes: from world axes to those of the reference         (…, 3, 3)
    point: the point that is spoken of, in the coordinates of the state   (…, 3)  [m]
    arm: from the center of mass of the vertex to it        (…, 3)  [m]
    velocity, omega: ẋ of the point, ω                      (…, 3)  [m/s, rad/s]
    """

    body: int
    axes: Array
    point: Array
    arm: Array
    velocity: Array
    omega: Array

    def turned(self, linear: Array, angular: Array) -> Array:
        return np.concatenate([apply(self.axes, linear), apply(self.axes, angular)], axis=-1)


def _seen(x: Arguments) -> tuple[MaximalState, _FramePoint]:
    """The rooted state of the robot, and where the frame is there."""
    state = x.rooted_state()
    assert state.ground is not None
    assert x.frame is not None
    chosen, vertices = x.model.frame(x.frame.name), state.vertices
    i, own = chosen.body, chosen.placement
    center, omega = vertices.position[..., i, :], vertices.angular_velocity[..., i, :]
    point = center + vertices.arm(i, own.translation)
    if x.frame.reference == "world":
        point = state.ground.position - ground(x.model, x.base, center.shape[:-1]).position
    axes = np.eye(3)
    if x.frame.reference == "local":
        axes = np.swapaxes(vertices.rotation[..., i, :, :] @ own.rotation, -1, -2)
    arm = point - center
    return state, _FramePoint(i, axes, point, arm, vertices.velocity[..., i, :] + cross(omega, arm), omega)
