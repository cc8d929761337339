"""How a frame fixed in a body moves, and how the joint velocities move it.

All of them speak of the point of the body where the reference has its origin: that of the frame, or with "world" the
point of the body, or of the space it carries with it, that passes the world's origin.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from graphdyn.arguments.choices import FrameChoice
from graphdyn.layout import BODY_DOF
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.declarations import ArraySpec, recursion
from graphdyn.recursions.mechanism.mechanism import Links, path
from graphdyn.recursions.motion import BodyMotion, Root, motions, origins, places, rotations, twists
from graphdyn.scalars.differentiation import directional
from graphdyn.scalars.vectors import PerJoint, Scalars, cross, scalars, zeros


@dataclass(frozen=True, eq=False)
class FixedFrame:
    """A chosen frame: index of its body, -1 for the ground; rotation and translation in joint axes of the body."""

    body: int
    rotation: Scalars
    translation: Scalars
    choice: FrameChoice


def fixed_frame(model: RobotModel, links: Links, choice: FrameChoice) -> FixedFrame:
    frame = model.frame(choice.name)
    to_joint_axes = links[frame.body - 1].link_axes.T if frame.body else scalars(np.eye(3))
    placement = frame.placement
    return FixedFrame(
        body=frame.body - 1,
        rotation=to_joint_axes @ scalars(placement.rotation),
        translation=to_joint_axes @ scalars(placement.translation),
        choice=choice,
    )


@recursion(frame_jacobian=ArraySpec((BODY_DOF, "n"), "m, 1 or 1, 0"))
def frame_jacobian(links: Links, root: Root, q: PerJoint, frame: FixedFrame) -> Scalars:
    """J (6, n): per joint up to the frame, p × (from O_k to the point) over p; of a slide, p over 0."""
    joints = path(links, frame.body)
    if not joints:
        return zeros(6, len(links))
    near = replace(root, position=-(root.rotation @ links[joints[0]].translation))  # joint 1 of the path at the origin
    at = places(links, q)
    axes = rotations(links, at, near)
    where = origins(links, at, axes, near)
    tip = where[frame.body] + axes[frame.body] @ frame.translation
    if frame.choice.reference == "world":
        tip = near.position - root.position
    turned = (axes[frame.body] @ frame.rotation).T if frame.choice.reference == "local" else None
    matrix = zeros(6, len(links))
    for k in joints:
        axis = axes[k][:, 2]
        linear, angular = (axis, zeros(3)) if links[k].prismatic else (cross(axis, tip - where[k]), axis)
        matrix[:, k] = np.concatenate([x if turned is None else turned @ x for x in (linear, angular)])
    return matrix


@recursion(frame_jacobian_derivative=ArraySpec((BODY_DOF, "n"), "m/s, 1/s"))
def frame_jacobian_derivative(links: Links, root: Root, q: PerJoint, v: PerJoint, frame: FixedFrame) -> list[Any]:
    """dJ/dt (6 n) of a robot on a base at rest."""
    return directional(list(frame_jacobian(links, root, q, frame).ravel()), q, v)


@recursion(frame_velocity=ArraySpec((BODY_DOF,), "m/s, rad/s"))
def frame_velocity(links: Links, root: Root, q: PerJoint, v: PerJoint, frame: FixedFrame) -> list[Any]:
    """Frame velocity of the point, then ω (6)."""
    to_reference, point = _view(links, root, q, frame)
    at = places(links, q)
    linear, omega = (root.velocity, root.omega) if frame.body < 0 else twists(links, at, root, v)[frame.body]
    return [*(to_reference @ (linear + cross(omega, point))), *(to_reference @ omega)]


@recursion(frame_acceleration=ArraySpec((BODY_DOF,), "m/s², rad/s²"))
def frame_acceleration(links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, frame: FixedFrame) -> list[Any]:
    """Frame acceleration of the point, classical or spatial, then ω̇ (6)."""
    to_reference, point = _view(links, root, q, frame)
    at = places(links, q)
    here = BodyMotion(root.omega, root.alpha, root.acceleration)
    if frame.body >= 0:
        here = motions(links, at, replace(root, compensated=root.acceleration), v, a)[frame.body]
    linear = here.compensated + here.spread() @ point
    if not frame.choice.classical:
        velocity = root.velocity if frame.body < 0 else twists(links, at, root, v)[frame.body][0]
        linear = linear - cross(here.omega, velocity + cross(here.omega, point))
    return [*(to_reference @ linear), *(to_reference @ here.alpha)]


def _view(links: Links, root: Root, q: PerJoint, frame: FixedFrame) -> tuple[Scalars, Scalars]:
    """The rotation from joint axes of the body to the axes of the reference; from O_j to the point that is spoken of,
    joint axes."""
    rotation, origin = root.rotation, root.position
    if frame.body >= 0:
        at = places(links, q)
        axes = rotations(links, at, root)
        rotation, origin = axes[frame.body], origins(links, at, axes, root)[frame.body]
    if frame.choice.reference == "local":
        return frame.rotation.T, frame.translation
    return rotation, -(rotation.T @ origin) if frame.choice.reference == "world" else frame.translation
