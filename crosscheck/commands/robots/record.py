"""The format `graphdyn robots 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crosscheck.report.records.record import Record, written
from urdf import RobotEntry


class CatalogEntryRecord(Record, of=RobotEntry, leave_out=("gravity",)):
    """A robot."""


class RobotsRecord(Record, format="graphdyn robots 1"):
    """The robots known by name.

    robots: the catalog, in the order of the table
    """

    robots: Sequence[CatalogEntryRecord]


def record(entries: Sequence[RobotEntry]) -> dict[str, Any]:
    """The catalog. entries: as urdf.robots gives them"""
    return written(RobotsRecord, robots=entries)
