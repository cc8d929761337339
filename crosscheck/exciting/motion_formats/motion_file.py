"""The format of a planned motion by the name of its file, and the one without a file of its own: a table.

The table is CSV with a header and the columns of recordings, one row for each time: time [s], JOINT.q [rad],
JOINT.v [rad/s], JOINT.a [rad/s^2]. Numbers lose no digits.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats import joint_trajectory, krl, urscript
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
from crosscheck.recordings import load_recording
from crosscheck.recordings.virtual import JOINT_UNITS
from graphdyn import InvalidInput, RobotModel
from graphdyn.excitation import TabulatedCourse


def table_document(motion: TimedMotion) -> bytes:
    joints = list(zip(motion.joint_names, motion.prismatic, strict=True))
    header = ["time [s]"]
    for symbol in ("q", "v", "a"):
        header += [f"{name}.{symbol} [{JOINT_UNITS[symbol][slides]}]" for name, slides in joints]
    rows = np.column_stack([motion.time, motion.q, motion.v, motion.a]).tolist()
    return "\n".join([",".join(header), *(",".join(map(repr, row)) for row in rows), ""]).encode()


WRITTEN_SUFFIXES = (".csv", ".yaml", ".yml", ".script", ".src")
"""Endings of files: a table, ROS 2, Universal Robots, KUKA."""


def document(motion: TimedMotion, path: Path, settings: AxisSettings) -> bytes:
    """The content of a file of this name. Raises InvalidInput for another ending."""
    match path.suffix.lower():
        case ".csv":
            return table_document(motion)
        case ".yaml" | ".yml":
            return joint_trajectory.document(motion)
        case ".script":
            return urscript.document(motion)
        case ".src":
            return krl.document(motion, settings)
    raise InvalidInput(f"{path}: a planned motion is written as {', '.join(WRITTEN_SUFFIXES)}, not as '{path.suffix}'")


def read_motion(path: Path, model: RobotModel, settings: AxisSettings) -> TabulatedCourse:
    """The motion of a file; what has none of the endings of planned motions is read as a recording, one of torques too.

    Raises BadRecordingFile, InvalidInput; OSError.
    """
    joints = model.independent_joints
    match path.suffix.lower():
        case ".yaml" | ".yml":
            return joint_trajectory.read(path, joints)
        case ".script":
            return urscript.read(path, joints)
        case ".src":
            return krl.read(path, slides(model), settings)
    recording = load_recording(path, joints=joints)
    return TabulatedCourse(recording.t, recording.q)


def slides(model: RobotModel) -> tuple[bool, ...]:
    """Which of the joints that no others drive are prismatic."""
    return tuple(model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent)
