"""The JSON file of a sweep: written as robots are finished, so that a later sweep can take over what is still valid."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from crosscheck.commands.crosscheck.record import CrosscheckRecord, RobotRecord, sweep_record
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.reference.subject import content_sha256
from crosscheck.report.records.record import as_bytes, has_form, plain, versions
from graphdyn import InvalidInput
from urdf import InvalidXacro

MAX_WRITING_SHARE = 0.1
"""Largest part of the time spent on writing: the file is always written whole, which takes long for many robots."""


FORMATS_TAKEN_OVER = tuple(f"graphdyn crosscheck {number}" for number in (2, 3))
NAMES_BEFORE = {
    "torque": "inverse_dynamics",
    "acceleration": "forward_dynamics",
    "joint_wrench": "joint_wrenches",
    "forward_joint_wrench": "forward_joint_wrenches",
    "link_twist": "body_velocities",
    "body_acceleration": "body_accelerations",
    "forward_body_acceleration": "forward_body_accelerations",
    "torque_regressor": "joint_torque_regressor",
    "centroidal_momentum": "momentum",
    "da_dpi": "forward_dynamics_parameter_derivatives",
    "coupled_torque": "coupled_inverse_dynamics",
    "coupled_acceleration": "coupled_forward_dynamics",
    "coupled_regressor": "coupled_joint_torque_regressor",
    "motor_torque": "closed_inverse_dynamics",
    "closed_acceleration": "closed_forward_dynamics",
    "closed_joint_wrench": "closed_joint_wrenches",
}
"""Names before of quantities in files of format 2, and what they are called now."""


class SweepFile:
    """Records and failures of a sweep, and the file they are written to, if any.

    robots: all of them, in order; records, failures: by robot, those known so far
    """

    def __init__(
        self,
        file: OutputFile | None,
        command: Sequence[str],
        robots: Sequence[str],
        failures: Sequence[Mapping[str, Any]],
    ):
        self.robots, self.records = robots, dict[str, dict[str, Any]]()
        self.failures = {failure["robot"]: failure for failure in failures}
        self._file, self._command = file, command
        self._not_before = 0.0

    def write(self, finished: bool = False) -> None:
        """Write everything known, unless too much time went into writing. Raises OSError.

        finished: write in any case; a pipe or a device is written to only then
        """
        start = time.monotonic()
        if self._file is None or (not finished and (start < self._not_before or not self._file.is_regular)):
            return
        unfinished = [robot for robot in self.robots if robot not in self.records and robot not in self.failures]
        records = [self.records[robot] for robot in self.robots if robot in self.records]
        record = sweep_record(records, list(self.failures.values()), unfinished, self._command)
        self._file.write(as_bytes(plain(record)))
        end = time.monotonic()
        self._not_before = end + (end - start) * (1 / MAX_WRITING_SHARE - 1)


def taken_over(path: Path, robots: Sequence[str], samples: int, seed: int) -> dict[str, dict[str, Any]]:
    """Records of an earlier sweep, by robot, that a new one would repeat: same content, states, lock and versions.

    A record that is not whole is left out, so that its robot is compared again.

    Empty where there is no file. Raises InvalidInput for a file of another format, OSError.
    """
    if not path.exists():
        return {}
    try:
        earlier = json.loads(path.read_bytes())
    except (ValueError, RecursionError):
        earlier = None
    known = isinstance(earlier, dict) and earlier.get("format") in FORMATS_TAKEN_OVER
    if not known or not isinstance(earlier.get("robots"), list):
        raise InvalidInput(
            f"--resume: {path} is not a file of the format '{CrosscheckRecord.format}'; name another, or delete it"
        )
    there = earlier.get("versions")
    if not isinstance(there, dict) or any(there.get(name) != number for name, number in versions().items()):
        return {}
    wanted = {"samples": samples, "seed": seed, "locked": {}, "chain": None}
    renamed = (_renamed(record) for record in earlier["robots"] if _is_whole(record))
    records = {
        str(record["robot"]): record
        for record in renamed
        if record["file_sha256"] and all(record[name] == value for name, value in wanted.items())
    }
    return {robot: records[robot] for robot in robots if robot in records and _unchanged(records[robot])}


def _is_whole(record: object) -> bool:
    return has_form(RobotRecord, record) and all(
        isinstance(record[field], dict)  # type: ignore[index]  # has_form has seen it
        for field in ("quantities", "not_compared")
    )


def _renamed(record: Mapping[str, Any]) -> dict[str, Any]:
    """A record with the quantities under their present names."""

    def present(name: str) -> str:
        stem = re.sub(r"(_projected|_external|_recursive)*$", "", name)
        return NAMES_BEFORE.get(stem, stem) + name[len(stem) :]

    renamed = {
        field: {present(name): value for name, value in record[field].items()}
        for field in ("quantities", "not_compared")
    }
    return {**record, **renamed}


def _unchanged(record: Mapping[str, Any]) -> bool:
    """Whether the file of a robot still has the content that was compared."""
    try:
        return bool(content_sha256(record["robot"]) == record["file_sha256"])
    except (OSError, InvalidXacro):
        return False
