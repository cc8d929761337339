"""The format of a planned motion by the name of its file, and the one without a file of its own: a table.

The table is CSV with a header and the columns of recordings, one row for each time: time [s], JOINT.q [rad],
JOINT.v [rad/s], JOINT.a [rad/s^2]. Numbers lose no digits.
"""

from __future__ import annotations

import csv
import io
import re
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats import joint_trajectory, krl, urscript
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.program_lines import NAME
from crosscheck.exciting.motion_formats.timed_motion import GivenMotion, TimedMotion, dividing_rate
from crosscheck.recordings import load_recording
from crosscheck.recordings.errors import BadRecordingFile, quoted
from crosscheck.recordings.virtual import JOINT_UNITS
from graphdyn import InvalidInput, RobotModel
from graphdyn.excitation import FiniteMotion, TabulatedCourse

MAX_SLOPE_ERROR = 0.1
"""Largest difference, relative to the largest value, between the rates that a file states and those of its positions;
rows that are far apart show the motion between them less well."""

_MOTION_COLUMN = re.compile(r"(.+)\.[qva] \[(?:rad|m)(?:/s(?:\^2)?)?\]")


def table_document(motion: TimedMotion) -> bytes:
    rows = np.column_stack([motion.time, motion.q, motion.v, motion.a]).tolist()
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(_header(motion.joint_names, motion.prismatic))
    return "\n".join([text.getvalue()[:-1], *(",".join(map(repr, row)) for row in rows), ""]).encode()


def _header(joint_names: Sequence[str], prismatic: Sequence[bool]) -> list[str]:
    joints = list(zip(joint_names, prismatic, strict=True))
    return [
        "time [s]",
        *(f"{name}.{symbol} [{JOINT_UNITS[symbol][slides]}]" for symbol in "qva" for name, slides in joints),
    ]


WRITTEN_SUFFIXES = (".csv", ".yaml", ".yml", ".script", ".src")
"""Endings of files: a table, ROS 2, Universal Robots, KUKA."""

PROGRAM_SUFFIXES = (".script", ".src")
"""Endings of programs whose steps of time are all equal."""


def document(motion: TimedMotion, path: Path, settings: AxisSettings) -> bytes:
    """The content of a file of this name. Raises InvalidInput for another ending, and for programs of unequal steps."""
    match path.suffix.lower():
        case ".csv":
            return table_document(motion)
        case ".yaml" | ".yml":
            return joint_trajectory.document(motion)
        case ".script":
            return urscript.document(motion, program_name(path))
        case ".src":
            return krl.document(motion, settings, program_name(path))
    raise InvalidInput(f"{path}: a planned motion is written as {', '.join(WRITTEN_SUFFIXES)}, not as '{path.suffix}'")


def program_name(path: Path) -> str:
    """That of the file, as far as it can be the name of a program."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", path.stem)
    return name if re.fullmatch(NAME, name) else f"motion_{name}"


def written_rate(course: FiniteMotion, path: Path, rate: float) -> float:
    """The rate of the rows of a file of this name [Hz]: programs have equal steps, so theirs divides the duration.

    Of URScript it is one that a controller has, if there is one.
    """
    suffix = path.suffix.lower()
    of_controller = urscript.controller_rate(course.duration, rate) if suffix == ".script" else None
    return of_controller or (dividing_rate(course.duration, rate) if suffix in PROGRAM_SUFFIXES else rate)


def read_motion(path: Path, model: RobotModel, settings: AxisSettings) -> TabulatedCourse:
    """The motion of a file; what has none of the endings of planned motions is read as a recording, one of torques too.

    Warns where velocities and accelerations of the file are not those of the spline through its positions.

    Raises BadRecordingFile, InvalidInput; OSError.
    """
    joints = model.independent_joints
    match path.suffix.lower():
        case ".yaml" | ".yml":
            given = joint_trajectory.read(path, joints)
        case ".script":
            given = urscript.read(path, joints)
        case ".src":
            given = krl.read(path, slides(model), settings)
        case _:
            given = _recorded(path, model)
    try:
        course = TabulatedCourse(given.times, given.positions)
    except InvalidInput as error:
        raise BadRecordingFile(f"{path}: {error}") from None
    _warn_of_other_slopes(path, given, course, joints)
    return course


def _recorded(path: Path, model: RobotModel) -> GivenMotion:
    """The motion of a table or a recording. Raises as load_recording, and BadRecordingFile for columns left over."""
    recording = load_recording(path, joints=model.independent_joints)
    header = _header(model.independent_joints, slides(model))
    names = _first_cells(path) if path.suffix.lower() == ".csv" else []
    is_table = names[: len(header)] == header
    of_joints = [column for name in names if (column := _MOTION_COLUMN.fullmatch(name))]
    others = [column[0] for column in of_joints if column[1] not in model.joint_names]
    torques = tuple(f".tau [{unit}]" for unit in JOINT_UNITS["tau"])
    if is_table:
        others += [name for name in names[len(header) :] if not name.endswith(torques)]
    if others:
        raise BadRecordingFile(
            f"{path}: column {quoted(others[0])} is left over: the robot's joints are {', '.join(model.joint_names)}; "
            "leave it out"
        )
    cut_off = [finding for finding in recording.findings if finding.code == "truncated-last-line"]
    if is_table and cut_off:
        raise BadRecordingFile(f"{cut_off[0].text}; give the whole motion")
    if is_table:
        return GivenMotion(recording.t, recording.q, recording.v, recording.a)
    for finding in recording.findings:
        if finding.severity == "warning":
            warnings.warn(finding.text, stacklevel=3)
    return GivenMotion(recording.t, recording.q)


def _first_cells(path: Path) -> list[str]:
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as opened:
        return [cell.strip() for cell in next(csv.reader(opened), [])]


def _warn_of_other_slopes(path: Path, given: GivenMotion, course: TabulatedCourse, joints: Sequence[str]) -> None:
    motion = course.motion(course.times)
    stated = (("velocities", given.velocities, motion.v), ("accelerations", given.accelerations, motion.a))
    for what, values, of_spline in stated:
        if values is None:
            continue
        largest = np.maximum(np.abs(values), np.abs(of_spline)).max(axis=0)
        off = np.abs(values - of_spline).max(axis=0)
        other = [name for name, is_other in zip(joints, off > MAX_SLOPE_ERROR * largest, strict=True) if is_other]
        if other:
            warnings.warn(
                f"{path}: {what} of {', '.join(other)} are not those of the spline through the positions, whose limits "
                "are checked; correct them, or give more rows",
                stacklevel=3,
            )


def slides(model: RobotModel) -> tuple[bool, ...]:
    """Which of the joints that no others drive are prismatic."""
    return tuple(model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent)
