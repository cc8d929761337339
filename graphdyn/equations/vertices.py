"""All vertices of the graph at one instant, the ground included, and what each joint holds together there.

Row 0 is the ground, so that no equation needs a special case for the joints that stand on it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.arguments.base_motion import Ground
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import apply


class Vertices:
    """Positions of the centers of mass, orientations and velocities of ground and bodies, in world axes.

    position (…, n+1, 3), rotation (…, n+1, 3, 3), velocity (…, n+1, 3), angular_velocity (…, n+1, 3);
    center (n+1, 3): centers of mass in link axes, zero for the ground.
    """

    def __init__(self, model: RobotModel, position: Array, rotation: Array, velocity: Array, ground: Ground):
        batch = position.shape[:-2]

        def grounded(at_ground: Array, bodies: Array) -> Array:
            trailing = bodies.ndim - len(batch) - 1
            first = np.expand_dims(at_ground, -trailing - 1)
            first = np.broadcast_to(first, (*batch, 1, *bodies.shape[-trailing:]))
            return np.concatenate([first, bodies], axis=len(batch))

        omega = np.einsum("...ab,...b->...a", rotation, velocity[..., ANGULAR])
        self.position = grounded(ground.position, position)
        self.rotation = grounded(ground.rotation, rotation)
        self.velocity = grounded(ground.velocity[..., LINEAR], velocity[..., LINEAR])
        self.angular_velocity = grounded(ground.velocity[..., ANGULAR], omega)
        self.center = np.stack([np.zeros(3), *(body.center_of_mass for body in model.bodies)])

    def arm(self, i: int, point: Array) -> Array:
        """Vector from the center of mass of vertex i to a point given in its link axes (3,), in world axes (…, 3)
        [m]."""
        return self.seen(i, point - self.center[i])

    def seen(self, i: int, vector: Array, axes: int | None = None) -> Array:
        """A vector given in the link axes of vertex i (3,), in world axes (…, 3), or in the link axes of a vertex: of
        the same one as it is, without rounding."""
        if axes == i:
            return vector
        in_world = self.rotation[..., i, :, :] @ vector
        return in_world if axes is None else self.turned(in_world, axes)

    def turned(self, vector: Array, axes: int) -> Array:
        """A vector given in world axes (…, 3), in the link axes of a vertex."""
        return apply(np.swapaxes(self.rotation[..., axes, :, :], -1, -2), vector)


@dataclass(frozen=True, eq=False)
class JointVectors:
    """What joint j holds, as vectors in the axes of the world or of a body: the data that make a joint type.

    arm_i, arm_j: c_ij and c_jj, from the centers of mass to the joint        (…, 3)    [m]
    gap: r_i + c_ij - r_j - c_jj                                              (…, 3)    [m]
    held: directions along which the gap is held at zero                      (…, k, 3)
    held_turns: whether these directions turn with the inside body, or are the world axes
    inside, outside: pairs of vectors a (fixed in body i), b (fixed in body j) held normal   (…, 5-k, 3)
    axis: p, fixed in body j                                                  (…, 3)

    Revolute: the gap along the three world axes (Eq. 65); t_2·p = 0 and -t_1·p = 0.
    Prismatic: the gap along t_1 and t_2; t_2·p = 0, -t_1·p = 0 and t_1·t_2 = 0.
    """

    arm_i: Array
    arm_j: Array
    gap: Array
    held: Array
    held_turns: bool
    inside: Array
    outside: Array
    axis: Array


def joint_vectors(model: RobotModel, vertices: Vertices, j: int, axes: int | None = None) -> JointVectors:
    """The vectors of joint j (1 … n) at the given poses, in world axes, or in the link axes of a vertex."""
    joint = model.joints[j - 1]
    i = joint.inside

    def on(body: int, *vectors: Array) -> Array:
        return np.stack([vertices.seen(body, x, axes) for x in vectors], axis=-2)

    t_1, t_2 = (joint.placement.rotation @ t for t in joint.axis_normals)  # fixed in body i
    inside, outside = [t_2, -t_1], [joint.axis, joint.axis]  # on body j the same axes: they coincide at q = 0
    if joint.is_prismatic:
        held = on(i, t_1, t_2)
        inside.append(t_1)
        outside.append(joint.axis_normals[1])
    else:
        held = np.eye(3) if axes is None else vertices.rotation[..., axes, :, :]
    arm_i, arm_j = vertices.arm(i, joint.placement.translation), vertices.arm(j, np.zeros(3))
    gap = vertices.position[..., i, :] + arm_i - vertices.position[..., j, :] - arm_j
    return JointVectors(
        arm_i=vertices.seen(i, joint.placement.translation - vertices.center[i], axes),
        arm_j=vertices.seen(j, -vertices.center[j], axes),
        gap=gap if axes is None else vertices.turned(gap, axes),
        held=held,
        held_turns=joint.is_prismatic,
        inside=on(i, *inside),
        outside=on(j, *outside),
        axis=vertices.seen(j, joint.axis, axes),
    )


def constraint_values(model: RobotModel, vertices: Vertices) -> Array:
    """φ (…, n, 5), Eq. (65)-(105) with the axis rows of docs/deviations.md, A2. [m, -]"""
    rows = []
    for j in range(1, model.n_bodies + 1):
        joint = joint_vectors(model, vertices, j)
        along = np.einsum("...ka,...a->...k", joint.held, joint.gap)
        across = np.einsum("...ka,...ka->...k", joint.inside, joint.outside)
        rows.append(np.concatenate([along, across], axis=-1))
    return np.stack(rows, axis=-2)
