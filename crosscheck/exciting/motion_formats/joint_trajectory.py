"""ROS 2: a trajectory_msgs/msg/JointTrajectory as YAML, which `ros2 topic pub` takes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
from crosscheck.recordings.errors import BadRecordingFile
from graphdyn.excitation import TabulatedCourse

NANOSECONDS_PER_SECOND = 10**9


def document(motion: TimedMotion) -> bytes:
    lines = ["header:", "  stamp: {sec: 0, nanosec: 0}", "  frame_id: ''", f"joint_names: {_texts(motion.joint_names)}"]
    lines.append("points:")
    stamps = np.round(motion.time * NANOSECONDS_PER_SECOND).astype(np.int64).tolist()
    for stamp, q, v, a in zip(stamps, motion.q.tolist(), motion.v.tolist(), motion.a.tolist(), strict=True):
        seconds, rest = divmod(stamp, NANOSECONDS_PER_SECOND)
        lines += [
            f"- positions: {q}",
            f"  velocities: {v}",
            f"  accelerations: {a}",
            "  effort: []",
            f"  time_from_start: {{sec: {seconds}, nanosec: {rest}}}",
        ]
    return "\n".join([*lines, ""]).encode()


def read(path: Path, joints: Sequence[str]) -> TabulatedCourse:
    """Raises BadRecordingFile where it is no such message, or lacks a joint."""
    message = _message(path)
    names = message["joint_names"]
    missing = [name for name in joints if name not in names]
    if missing:
        raise BadRecordingFile(f"{path}: joint_names lacks joint '{missing[0]}'; it has {', '.join(map(str, names))}")
    try:
        stamps = [point["time_from_start"] for point in message["points"]]
        times = np.array([stamp["sec"] + stamp["nanosec"] / NANOSECONDS_PER_SECOND for stamp in stamps], dtype=float)
        positions = np.array([point["positions"] for point in message["points"]], dtype=float)
        positions = positions[:, [names.index(name) for name in joints]]
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise BadRecordingFile(
            f"{path}: a point lacks {len(names)} positions or time_from_start {{sec, nanosec}} ({error})"
        ) from None
    return TabulatedCourse(times, positions)


def _message(path: Path) -> dict[str, Any]:
    try:
        import yaml
    except ImportError as error:
        raise BadRecordingFile(f"{path}: to read YAML, install PyYAML") from error
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        message = yaml.load(path.read_bytes(), loader)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BadRecordingFile(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    if not isinstance(message, dict) or not isinstance(message.get("joint_names"), list) or "points" not in message:
        raise BadRecordingFile(
            f"{path}: has no joint_names and points; a trajectory_msgs/msg/JointTrajectory is needed"
        )
    return message


def _texts(names: Sequence[str]) -> str:
    """A YAML list of texts in single quotes."""
    return "[" + ", ".join("'" + name.replace("'", "''") + "'" for name in names) + "]"
