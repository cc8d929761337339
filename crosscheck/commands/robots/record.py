"""The format `graphdyn robots 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crosscheck.report.record import Record, written
from urdf import RobotEntry


class CatalogueEntryRecord(Record, of=RobotEntry, leave_out=("gravity",)):
    """A robot."""


class RobotsRecord(Record, format="graphdyn robots 1"):
    """The robots known by name.

    robots: the catalogue, in the order of the table
    """

    robots: Sequence[CatalogueEntryRecord]


def record(entries: Sequence[RobotEntry]) -> dict[str, Any]:
    """The catalogue. entries: as urdf.robots gives them"""
    return written(RobotsRecord, robots=entries)
