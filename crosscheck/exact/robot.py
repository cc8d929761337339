"""A robot in balls: of its URDF file, whose decimals are the truth, or of its model in memory, whose doubles are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from crosscheck.exact.balls import (
    Ball,
    Balls,
    as_balls,
    ball,
    cross,
    eye,
    nearest_rotation,
    norm,
    rotation_about,
    zeros,
)
from crosscheck.exact.couplings import ExactCouplings, Ratios, exact_couplings, ratios_of_model
from graphdyn import InvalidInput, RobotModel
from urdf import WrittenInertial, WrittenOrigin, WrittenRobot

Truth = Literal["file", "model"]
"""What counts as exact: the decimals of the file, or the doubles of the model that was read from it."""


@dataclass(frozen=True, eq=False)
class ExactPlacement:
    """rotation (3, 3) and translation (3,) of a frame, in balls."""

    rotation: Balls
    translation: Balls

    def __matmul__(self, other: ExactPlacement) -> ExactPlacement:
        return ExactPlacement(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)


@dataclass(frozen=True, eq=False)
class ExactBody:
    """Body j and its inside joint, as in RobotModel, in balls.

    inside: number of the inside body, 0 for the ground; prismatic: whether the joint slides
    placement: of the joint frame in the link frame of the inside body
    joint_axes: columns t_1, t_2, p in joint axes           (3, 3)
    mass; center_of_mass (3,) and tensor about it (3, 3), in link axes
    """

    inside: int
    prismatic: bool
    placement: ExactPlacement
    joint_axes: Balls
    mass: Ball
    center_of_mass: Balls
    tensor: Balls


@dataclass(frozen=True, eq=False)
class ExactRobot:
    """model: whose numbers of bodies and joints these are; frames: number of the body and placement, by name.

    couplings: fractions
    """

    model: RobotModel
    bodies: tuple[ExactBody, ...]
    base: ExactPlacement
    gravity: Balls
    frames: dict[str, tuple[int, ExactPlacement]]
    couplings: ExactCouplings


def of_model(model: RobotModel) -> ExactRobot:
    """The doubles of a model. Rotations are replaced by the nearest orthogonal matrix, axes by unit vectors."""
    _refuse_loops(model)
    bodies = []
    for body, joint in zip(model.bodies, model.joints, strict=True):
        tensor = as_balls(body.inertia)
        bodies.append(
            ExactBody(
                inside=joint.inside,
                prismatic=joint.is_prismatic,
                placement=_orthonormal(joint.placement.rotation, joint.placement.translation),
                joint_axes=_joint_axes(as_balls(joint.axis), joint.axis_normals),
                mass=ball(body.mass),
                center_of_mass=as_balls(body.center_of_mass),
                tensor=(tensor + tensor.T) * ball(0.5),
            )
        )
    frames = {
        name: (frame.body, _orthonormal(frame.placement.rotation, frame.placement.translation))
        for frame in model.frames
        for name in (frame.name, *frame.aliases)
    }
    base = _orthonormal(model.base.rotation, model.base.translation)
    couplings = exact_couplings(model, ratios_of_model(model))
    return ExactRobot(model, tuple(bodies), base, as_balls(model.gravity), _with_bodies(model, frames), couplings)


def of_file(model: RobotModel, written: WrittenRobot) -> ExactRobot:
    """The decimals of a file. model: what was read from it; of gravity and base its doubles count."""
    _refuse_loops(model)
    places: dict[str, tuple[int, ExactPlacement]] = {written.root: (0, ExactPlacement(eye(), zeros(3)))}
    members: list[list[str]] = [[written.root]]
    joints = []
    for joint in written.joints:
        inside, place = places[joint.parent]
        place = place @ _origin(joint.origin)
        axis = as_balls(joint.axis)
        if joint.held is None:
            places[joint.child] = len(members), ExactPlacement(eye(), zeros(3))
            members.append([joint.child])
            joints.append((inside, place, axis / norm(axis)))
        else:
            places[joint.child] = inside, place @ _held(joint.prismatic, axis, ball(joint.held))
            members[inside].append(joint.child)
    bodies = []
    for moving, names, (inside, place, axis) in zip(model.joints, members[1:], joints, strict=True):
        parts = [(places[name][1], written.inertials[name]) for name in names if name in written.inertials]
        mass, center, tensor = _fused(parts)
        joint_axes = _joint_axes(axis, moving.axis_normals)
        bodies.append(ExactBody(inside, moving.is_prismatic, place, joint_axes, mass, center, tensor))
    frames = {name: places[frame.name] for frame in model.frames for name in (frame.name, *frame.aliases)}
    base = _orthonormal(model.base.rotation, model.base.translation)
    couplings = exact_couplings(model, _ratios(model, written))
    return ExactRobot(model, tuple(bodies), base, as_balls(model.gravity), _with_bodies(model, frames), couplings)


def _ratios(model: RobotModel, written: WrittenRobot) -> Ratios:
    """Raises InvalidInput where a <coupling> drives a joint, which follows from a way of joints, not from a decimal."""
    for coupling in model.couplings:
        if coupling.joint not in written.mimics:
            raise InvalidInput(
                f"robot '{model.name}' has a <coupling>, which drives joint '{coupling.joint}': there are exact values "
                "of its model only; use truth='model'"
            )
    mimics = (written.mimics[coupling.joint] for coupling in model.couplings)
    return {mimic.joint: ({mimic.driver: mimic.ratio}, mimic.offset) for mimic in mimics}


def _refuse_loops(model: RobotModel) -> None:
    """Raises InvalidInput for robots with loops, whose files close them only to the digits that they write."""
    if model.chords:
        raise InvalidInput(f"robot '{model.name}' has loops: there are no exact values of it; give a tree without")


def _with_bodies(
    model: RobotModel, frames: dict[str, tuple[int, ExactPlacement]]
) -> dict[str, tuple[int, ExactPlacement]]:
    names = (model.base_name, *model.body_names)
    return {name: (number, ExactPlacement(eye(), zeros(3))) for number, name in enumerate(names)} | frames


def _orthonormal(rotation: object, translation: object) -> ExactPlacement:
    return ExactPlacement(nearest_rotation(as_balls(rotation)), as_balls(translation))


def _joint_axes(axis: Balls, normals: np.ndarray) -> Balls:
    """Columns t_1, t_2, p, by the rule of graphdyn.Joint.axis_normals. normals: what that gives in doubles."""
    axis = axis if (norm(axis) - 1).is_zero() else axis / norm(axis)
    along = np.cross(np.cross(*normals), np.eye(3)) @ normals[0]  # t_1 is p × e, normal to e, for a coordinate axis e
    first = cross(axis, eye()[int(np.argmax(np.where(normals[0] == 0, along, -1)))])
    first = first / norm(first)
    return np.column_stack([first, cross(axis, first), axis])


def _origin(origin: WrittenOrigin) -> ExactPlacement:
    """R_z(yaw) R_y(pitch) R_x(roll)."""
    rotation = eye()
    for axis, angle in zip(eye(), origin.rpy, strict=True):
        if angle != 0:
            rotation = rotation_about(axis, ball(angle)) @ rotation
    return ExactPlacement(rotation, as_balls(origin.xyz))


def _held(prismatic: bool, axis: Balls, value: Ball) -> ExactPlacement:
    if value == 0:
        return ExactPlacement(eye(), zeros(3))
    axis = axis / norm(axis)
    if prismatic:
        return ExactPlacement(eye(), axis * value)
    return ExactPlacement(rotation_about(axis, value), zeros(3))


def _fused(parts: Sequence[tuple[ExactPlacement, WrittenInertial]]) -> tuple[Ball, Balls, Balls]:
    """Mass, center of mass and tensor about it of links that move as one body."""
    masses, centers, tensors = [], [], []
    for place, inertial in parts:
        own = place @ _origin(inertial.origin)
        masses.append(ball(inertial.mass))
        centers.append(own.translation)
        tensors.append(own.rotation @ as_balls(inertial.tensor) @ own.rotation.T)
    mass = sum(masses, ball(0))
    if not mass > 0:
        return mass, zeros(3), sum(tensors, zeros(3, 3))
    center = sum((m * c for m, c in zip(masses, centers, strict=True)), zeros(3)) / mass
    about = zeros(3, 3)
    for m, c, tensor in zip(masses, centers, tensors, strict=True):
        d = c - center
        about = about + tensor + (eye() * (d @ d) - np.outer(d, d)) * m
    return mass, center, about
