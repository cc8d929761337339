"""`graphdyn robots`: the catalog, as a report."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.commands.robots.record import record
from crosscheck.report.report import Column, Report, Row, Section, Table
from urdf import RobotEntry


def robots_report(entries: Sequence[RobotEntry]) -> Report:
    table = Table(
        (Column("name", "name"), Column("origin"), Column("licence")),
        tuple(Row((entry.name, entry.origin, entry.licence)) for entry in entries),
        caption="Robots that every command takes by name",
    )
    return Report("Robots known by name", None, (Section("robots", "", (table,)),), record=lambda _: record(entries))
