"""ROS 2: a trajectory_msgs/msg/JointTrajectory as YAML, which `ros2 topic pub` takes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats.plain_yaml import YamlNode, fault, read_yaml
from crosscheck.exciting.motion_formats.timed_motion import GivenMotion, TimedMotion
from crosscheck.recordings.errors import BadRecordingFile, quoted
from graphdyn.errors import counted
from graphdyn.layout import Array
from urdf.document import finite_number

NANOSECONDS_PER_SECOND = 10**9

POINT_KEYS = ("positions", "velocities", "accelerations", "effort", "time_from_start")


def document(motion: TimedMotion) -> bytes:
    lines = ["header:", "  stamp: {sec: 0, nanosec: 0}", "  frame_id: ''", f"joint_names: {_texts(motion.joint_names)}"]
    lines.append("points:")
    stamps = np.round(motion.time * NANOSECONDS_PER_SECOND).astype(np.int64).tolist()
    for stamp, q, v, a in zip(stamps, motion.q.tolist(), motion.v.tolist(), motion.a.tolist(), strict=True):
        seconds, rest = divmod(stamp, NANOSECONDS_PER_SECOND)
        lines += [
            f"- positions: {_numbers(q)}",
            f"  velocities: {_numbers(v)}",
            f"  accelerations: {_numbers(a)}",
            "  effort: []",
            f"  time_from_start: {{sec: {seconds}, nanosec: {rest}}}",
        ]
    return "\n".join([*lines, ""]).encode()


def read(path: Path, joints: Sequence[str]) -> GivenMotion:
    """Raises BadRecordingFile where it is no such message, or one of other joints; OSError."""
    return _Message(path).read(joints)


class _Message:
    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self, joints: Sequence[str]) -> GivenMotion:
        message = read_yaml(self.path)
        if not isinstance(message.content, dict) or not {"joint_names", "points"} <= set(message.content):
            raise BadRecordingFile(
                f"{self.path}: has no joint_names and points; a trajectory_msgs/msg/JointTrajectory is needed"
            )
        parts = self._mapping(message, "message", ("header", "joint_names", "points"))
        names = [str(name.content) for name in self._list(parts["joint_names"], "joint_names")]
        if sorted(names) != sorted(joints):
            odd = [f"lacks joint '{name}'" for name in joints if name not in names]
            odd += [f"has '{name}', no joint of the robot that no other drives" for name in names if name not in joints]
            raise BadRecordingFile(
                f"{self.path}: joint_names {odd[0] if odd else 'repeats a joint'}; it has {', '.join(names)}"
            )
        order = [names.index(name) for name in joints]
        points = [self._mapping(one, "a point", POINT_KEYS) for one in self._list(parts["points"], "points")]
        times: list[float] = []
        for point, node in zip(points, self._list(parts["points"], "points"), strict=True):
            times.append(self._time(point, node))
            if len(times) > 1 and times[-1] <= times[-2]:
                raise self._fault(point["time_from_start"], "time_from_start does not increase", "give points in order")
            self._rows([point], "effort", 0)
        rows = {key: self._rows(points, key, len(joints)) for key in POINT_KEYS[:3]}
        positions, velocities, accelerations = (None if row is None else row[:, order] for row in rows.values())
        if positions is None:
            raise BadRecordingFile(f"{self.path}: the points lack positions; a motion of positions is needed")
        return GivenMotion(np.array(times), positions, velocities, accelerations)

    def _rows(self, points: Sequence[dict[str, YamlNode]], key: str, count: int) -> Array | None:
        """The numbers of all points (N, count); None where all are left out."""
        given = [point[key] for point in points if key in point and point[key].content != []]
        for node in given:
            found = len(self._list(node, key))
            if found != count:
                raise self._fault(node, f"{counted(found, 'number')} in {key}", f"give {count}")
        if not given:
            return None
        if len(given) < len(points):
            raise BadRecordingFile(f"{self.path}: {len(points) - len(given)} points lack {key}; give them for all")
        return np.array([[self._number(one) for one in self._list(node, key)] for node in given])

    def _time(self, point: dict[str, YamlNode], node: YamlNode) -> float:
        if "time_from_start" not in point:
            raise self._fault(node, "a point lacks time_from_start", "give {sec, nanosec}")
        stamp = self._mapping(point["time_from_start"], "time_from_start", ("sec", "nanosec"))
        texts = [str(stamp[key].content) if key in stamp else "" for key in ("sec", "nanosec")]
        if not all(re.fullmatch("0|[1-9][0-9]{0,9}", text) for text in texts) or len(texts[1]) > 9:
            raise self._fault(
                point["time_from_start"], "time_from_start is not {sec, nanosec} as whole numbers", "give both"
            )
        return int(texts[0]) + int(texts[1]) / NANOSECONDS_PER_SECOND

    def _number(self, node: YamlNode) -> float:
        number = finite_number(node.content) if isinstance(node.content, str) else None
        if number is None:
            raise self._fault(node, f"{quoted(node.content)} is not a finite number", "correct it")
        return number

    def _mapping(self, node: YamlNode, what: str, keys: Sequence[str]) -> dict[str, YamlNode]:
        if not isinstance(node.content, dict):
            raise self._fault(node, f"{what} is no mapping", f"give one of {', '.join(keys)}")
        other = [key for key in node.content if key not in keys]
        if other:
            raise self._fault(node, f"{what} has {quoted(other[0])}", f"it has {', '.join(keys)} alone; leave it out")
        return node.content

    def _list(self, node: YamlNode, what: str) -> list[YamlNode]:
        if not isinstance(node.content, list):
            raise self._fault(node, f"{what} is no list", "give a list: [ … ]")
        return node.content

    def _fault(self, node: YamlNode, problem: str, remedy: str) -> BadRecordingFile:
        return fault(self.path, node.line, problem, remedy)


def _texts(names: Sequence[str]) -> str:
    """A YAML list of texts in single quotes."""
    return "[" + ", ".join("'" + name.replace("'", "''") + "'" for name in names) + "]"


def _numbers(row: Sequence[float]) -> str:
    """A YAML list of numbers; one without a point, as 1e-05, would be a text in YAML 1.1."""
    texts = map(repr, row)
    return "[" + ", ".join(text if "." in text else text.replace("e", ".0e") for text in texts) + "]"
