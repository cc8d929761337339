"""The catalog of `graphdyn robots`: the format `graphdyn robots 1`, and the report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crosscheck.report.records.record import Record, written
from crosscheck.report.report import Column, Report, Row, Section, Table
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


def robots_report(entries: Sequence[RobotEntry]) -> Report:
    table = Table(
        (Column("name", "name"), Column("origin"), Column("licence")),
        tuple(Row((entry.name, entry.origin, entry.licence)) for entry in entries),
        caption="Robots that every command takes by name",
    )
    return Report("Robots known by name", None, (Section("robots", "", (table,)),), record=lambda _: record(entries))
