"""The format of a planned motion by the name of its file."""

from __future__ import annotations

from pathlib import Path

from crosscheck.exciting.motion_formats import joint_table, joint_trajectory, krl, urscript
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
from graphdyn import InvalidInput, RobotModel
from graphdyn.excitation import TabulatedCourse

WRITTEN_SUFFIXES = (".csv", ".yaml", ".yml", ".script", ".src")
"""Endings of files: a table, ROS 2, Universal Robots, KUKA."""


def document(motion: TimedMotion, path: Path, settings: AxisSettings) -> bytes:
    """The content of a file of this name. Raises InvalidInput for another ending."""
    suffix = path.suffix.lower()
    if suffix == ".csv":
        return joint_table.document(motion)
    if suffix in (".yaml", ".yml"):
        return joint_trajectory.document(motion)
    if suffix == ".script":
        return urscript.document(motion)
    if suffix == ".src":
        return krl.document(motion, settings)
    raise InvalidInput(f"{path}: a planned motion is written as {', '.join(WRITTEN_SUFFIXES)}, not as '{path.suffix}'")


def read_motion(path: Path, model: RobotModel, settings: AxisSettings) -> TabulatedCourse:
    """The motion of a file; what has none of the endings of planned motions is read as a recording.

    Raises BadRecordingFile, InvalidInput; OSError.
    """
    joints = model.independent_joints
    suffix = path.suffix.lower()
    if suffix in (".yaml", ".yml"):
        found = joint_trajectory.read(path, joints)
    elif suffix == ".script":
        found = urscript.read(path, joints)
    elif suffix == ".src":
        found = krl.read(path, slides(model), settings)
    else:
        found = joint_table.read(path, joints)
    return TabulatedCourse(*found)


def slides(model: RobotModel) -> tuple[bool, ...]:
    """Which of the joints that no others drive are prismatic."""
    return tuple(model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent)
