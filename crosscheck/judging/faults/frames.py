"""Wrong placements of the joints: rotations, axes in which translations are expressed, joint axes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.faults.changes import E1, E2, E3, moved, of_joints, rpy_of, turned
from crosscheck.judging.faults.fault import Fault
from graphdyn import Joint, Placement, RobotModel
from graphdyn._rotation import rotation_about
from graphdyn.layout import Array


def frames(model: RobotModel) -> Iterator[Fault]:
    place = "compare the placement of the joint frame in the inside body's link frame (forward kinematics)"
    changes: tuple[tuple[str, Callable[[Joint], Joint]], ...] = (
        ("the rotation of {who} is transposed", lambda j: turned(j, j.placement.rotation.T)),
        ("the rotation of {who} is left out", lambda j: turned(j, np.eye(3))),
        ("the rpy angles of {who} are applied in the opposite order", lambda j: turned(j, _opposite(rpy_of(j)))),
        (
            "the translation of {who} is expressed in the axes of the joint frame",
            lambda j: moved(j, j.placement.rotation @ j.placement.translation),
        ),
        (
            "the translation of {who} is expressed in the axes of the joint frame and turned the wrong way",
            lambda j: moved(j, j.placement.rotation.T @ j.placement.translation),
        ),
        ("the translation of {who} is left out", lambda j: moved(j, np.zeros(3))),
        ("the translation of {who} has the opposite sign", lambda j: moved(j, -j.placement.translation)),
        (
            "the placement of {who} is inverted",
            lambda j: dataclasses.replace(
                j, placement=Placement(j.placement.rotation.T, -j.placement.rotation.T @ j.placement.translation)
            ),
        ),
        (
            "the axis of {who} is expressed in the inside body's axes",
            lambda j: dataclasses.replace(j, axis=j.placement.rotation.T @ j.axis),
        ),
    )
    for message, change in changes:
        yield from of_joints(model, "frame", message, place, change)
    for name, axis in (("x", E1), ("y", E2), ("z", E3)):
        yield from of_joints(
            model,
            "frame",
            f"the axis of {{who}} is taken as {name}",
            "read the axis from the model",
            lambda joint, axis=axis: dataclasses.replace(joint, axis=axis),  # type: ignore[misc]
        )


def _opposite(rpy: Array) -> Array:
    """R_x(roll) R_y(pitch) R_z(yaw)."""
    roll, pitch, yaw = rpy
    return rotation_about(E1, roll) @ rotation_about(E2, pitch) @ rotation_about(E3, yaw)
