"""The format `graphdyn show 1`."""

from __future__ import annotations

from typing import Any

from crosscheck.commands.show.description import RobotDescription
from crosscheck.report.record import Record, written
from crosscheck.report.record_fields import Versions


class ShowRecord(Record, of=RobotDescription, format="graphdyn show 1"):
    """A robot of n bodies: its parts, its graph, and the pattern of its equations."""

    versions: Versions


def record(robot: RobotDescription) -> dict[str, Any]:
    return written(ShowRecord, robot)
