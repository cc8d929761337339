"""Wrong placements of the joints: rotations, axes in which translations are expressed, joint axes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.judging.faults.changes import E1, E2, E3, Changed, of_joints
from crosscheck.judging.faults.fault import CodeFault
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import rotation_about
from urdf.document import rpy_from_rotation


def frames(model: RobotModel) -> Iterator[CodeFault]:
    place = "compare the placement of the joint frame in the inside body's link frame (forward kinematics)"
    changes: tuple[tuple[str, Changed], ...] = (
        ("the rotation of {who} is transposed", lambda x, j: {"rotations": x.rotations[j].T}),
        ("the rotation of {who} is left out", lambda x, j: {"rotations": np.eye(3)}),
        (
            "the rpy angles of {who} are applied in the opposite order",
            lambda x, j: {"rotations": _opposite(rpy_from_rotation(x.rotations[j]))},
        ),
        (
            "the translation of {who} is expressed in the axes of the joint frame",
            lambda x, j: {"translations": x.rotations[j] @ x.translations[j]},
        ),
        (
            "the translation of {who} is expressed in the axes of the joint frame and turned the wrong way",
            lambda x, j: {"translations": x.rotations[j].T @ x.translations[j]},
        ),
        ("the translation of {who} is left out", lambda x, j: {"translations": np.zeros(3)}),
        ("the translation of {who} has the opposite sign", lambda x, j: {"translations": -x.translations[j]}),
        (
            "the placement of {who} is inverted",
            lambda x, j: {"rotations": x.rotations[j].T, "translations": -x.rotations[j].T @ x.translations[j]},
        ),
        (
            "the axis of {who} is expressed in the inside body's axes",
            lambda x, j: {"axes": x.rotations[j].T @ x.axes[j]},
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
            lambda x, j, axis=axis: {"axes": axis},  # type: ignore[misc]
        )
    carried = [k for k, joint in enumerate(model.joints) if joint.inside > 0]  # the others: gravity, or a turned base
    for name, axis in (("x", E1), ("y", E2), ("z", E3)):
        for degrees in (90, 180, 270):
            turn = rotation_about(axis, np.deg2rad(degrees))
            yield from of_joints(
                model,
                "frame",
                f"the placement of {{who}} is turned by {degrees}° about its {name} axis",
                place,
                lambda x, j, turn=turn: {"rotations": x.rotations[j] @ turn},  # type: ignore[misc]
                size=2,
                joints=carried,
            )


def _opposite(rpy: Array) -> Array:
    """R_x(roll) R_y(pitch) R_z(yaw)."""
    roll, pitch, yaw = rpy
    return rotation_about(E1, roll) @ rotation_about(E2, pitch) @ rotation_about(E3, yaw)
