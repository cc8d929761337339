"""All vertices of the graph at one instant, the ground included, and what each joint holds together there.

Row 0 is the ground, so that no equation needs a special case for the joints that stand on it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.arguments.base_motion import Ground
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel


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
        arm: Array = self.rotation[..., i, :, :] @ (point - self.center[i])
        return arm

    def from_link(self, i: int, vectors: Array) -> Array:
        """Vectors in the link axes of vertex i as rows (k, 3), in world axes (…, k, 3)."""
        return vectors @ np.swapaxes(self.rotation[..., i, :, :], -1, -2)

    def to_link(self, i: int, vectors: Array) -> Array:
        """Vectors in world axes as rows (…, k, 3), in the link axes of vertex i (…, k, 3)."""
        return vectors @ self.rotation[..., i, :, :]


@dataclass(frozen=True, eq=False)
class JointVectors:
    """What joint j holds, as vectors in world axes: the data that make a joint type.

    gap: r_i + c_ij - r_j - c_jj                                              (…, 3)    [m]
    arm_i, arm_j: c_ij and c_jj, from the centers of mass to the joint        (…, 3)    [m]
    held: directions along which the gap is held at zero                      (…, k, 3)
    held_turns: whether these directions turn with the inside body, or are the world axes
    inside, outside: pairs of vectors a (fixed in body i), b (fixed in body j) held normal   (…, 5-k, 3)
    on_i, on_j: the arm above pairs a, or b, in the link axes in which they are fixed        (6-k, 3)

    Revolute: the gap along the three world axes (Eq. 65); t_2·p = 0 and -t_1·p = 0.
    Prismatic: the gap along t_1 and t_2; t_2·p = 0, -t_1·p = 0 and t_1·t_2 = 0.
    """

    gap: Array
    arm_i: Array
    arm_j: Array
    held: Array
    held_turns: bool
    inside: Array
    outside: Array
    on_i: Array
    on_j: Array


def joint_vectors(model: RobotModel, vertices: Vertices, j: int) -> JointVectors:
    """The vectors of joint j (1 … n) at the given poses."""
    joint = model.joints[j - 1]
    i = joint.inside
    t_1, t_2 = joint.axis_normals @ joint.placement.rotation.T  # joint axes, fixed in body i
    on_i = [joint.placement.translation - vertices.center[i], t_2, -t_1]
    on_j = [-vertices.center[j], joint.axis, joint.axis]  # the same axes, fixed in body j: they coincide at q = 0
    held = np.eye(3)
    if joint.is_prismatic:
        on_i.append(t_1)
        on_j.append(joint.axis_normals[1])
        held = vertices.from_link(i, np.stack([t_1, t_2]))
    rows_i, rows_j = np.stack(on_i), np.stack(on_j)
    of_i, of_j = vertices.from_link(i, rows_i), vertices.from_link(j, rows_j)
    arm_i, arm_j = of_i[..., 0, :], of_j[..., 0, :]
    return JointVectors(
        gap=vertices.position[..., i, :] + arm_i - vertices.position[..., j, :] - arm_j,
        arm_i=arm_i,
        arm_j=arm_j,
        held=held,
        held_turns=joint.is_prismatic,
        inside=of_i[..., 1:, :],
        outside=of_j[..., 1:, :],
        on_i=rows_i,
        on_j=rows_j,
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
