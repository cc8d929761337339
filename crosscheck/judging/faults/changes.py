"""What the faults are made of: joints, bodies and parameters changed, and who has the fault in words."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from crosscheck.judging.experiments import Function, torques
from crosscheck.judging.faults.fault import Fault
from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn._inertia import parameters_from_inertia
from graphdyn._rotation import rotation_about
from graphdyn.layout import Array, parameter_columns
from urdf._rpy import rpy_from_rotation

E1, E2, E3 = np.eye(3)


def of_joints(
    model: RobotModel, kind: str, message: str, remedy: str, change: Callable[[Joint], Joint]
) -> Iterator[Fault]:
    """The same fault at one joint, for each joint, and at every joint at once."""
    for name in model.joint_names:
        yield Fault(
            kind, message.format(who=f"joint '{name}'"), remedy,
            with_joints(model, lambda joint, name=name: change(joint) if joint.name == name else joint),  # type: ignore[misc]
        )  # fmt: skip
    if model.n_bodies > 1:
        yield Fault(kind, message.format(who="every joint"), remedy, with_joints(model, change))


def of_bodies(
    model: RobotModel, kind: str, message: str, remedy: str, change: Callable[[Body, Array], Body]
) -> Iterator[Fault]:
    """The same fault at one body, for each body, and at every body at once; change(body, rotation of its joint)."""
    changed = []
    for body, joint in zip(model.bodies, model.joints, strict=True):
        other = change(body, joint.placement.rotation)
        changed.append(parameters_from_inertia(other.mass, other.center_of_mass, other.inertia))
    for k, name in enumerate(model.body_names, start=1):
        parameters = np.array(model.inertial_parameters)
        parameters[parameter_columns(k)] = changed[k - 1]
        yield Fault(kind, message.format(who=f"body '{name}'"), remedy, with_parameters(model, parameters))
    if model.n_bodies > 1:
        yield Fault(kind, message.format(who="every body"), remedy, with_parameters(model, np.concatenate(changed)))


def with_parameters(model: RobotModel, parameters: Array) -> Function:
    """Torques of the robot with other inertial parameters (10n,)."""
    return torques(model.with_inertial_parameters(parameters))


def with_joints(model: RobotModel, change: Callable[[Joint], Joint]) -> Function:
    """Torques of the robot with every joint changed."""
    return torques(dataclasses.replace(model, joints=tuple(map(change, model.joints))))


def turned(joint: Joint, rotation: Array) -> Joint:
    """The joint with another rotation of its placement (3, 3)."""
    return dataclasses.replace(joint, placement=Placement(rotation, joint.placement.translation))


def moved(joint: Joint, translation: Array) -> Joint:
    """The joint with another translation of its placement (3,) [m]."""
    return dataclasses.replace(joint, placement=Placement(joint.placement.rotation, translation))


def rpy_of(joint: Joint) -> Array:
    """Roll, pitch and yaw of its placement (3,) [rad]."""
    return rpy_from_rotation(joint.placement.rotation)


def rotation_from(rpy: Array) -> Array:
    """R_z(yaw) R_y(pitch) R_x(roll)."""
    roll, pitch, yaw = rpy
    return rotation_about(E3, yaw) @ rotation_about(E2, pitch) @ rotation_about(E1, roll)


def joints_said(model: RobotModel, joints: Sequence[int]) -> str:
    """every joint; joints 'a', 'b'"""
    every = len(joints) == model.n_bodies > 1
    return "every joint" if every else named("joint", [model.joint_names[k] for k in joints])


def named(what: str, names: list[str]) -> str:
    """joint 'a'; joints 'a', 'b'"""
    return f"{what}{'s' if len(names) > 1 else ''} {', '.join(repr(name) for name in names)}"
