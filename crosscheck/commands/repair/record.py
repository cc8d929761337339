"""A repaired file: the format `graphdyn repair 1`."""

from __future__ import annotations

from typing import Any

from crosscheck.report.records.record import Record, written
from urdf import RepairedFile


class RepairRecord(Record, of=RepairedFile, format="graphdyn repair 1"):
    """Changes of a URDF file, each with line, element, old and new value.

    robot: as given; path: of the copy, null where nothing was written
    """

    robot: str
    path: str | None


def record(robot: str, found: RepairedFile) -> dict[str, Any]:
    return written(RepairRecord, found, robot=robot, path=None if found.path is None else str(found.path))
