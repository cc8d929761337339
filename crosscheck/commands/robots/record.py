"""The format `graphdyn robots 1`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, taken
from urdf import RobotEntry


@dataclass(frozen=True, kw_only=True)
class CatalogueEntryRecord:
    """A robot."""

    name: str
    """What to call it: graphdyn crosscheck NAME."""

    path: str
    """Its URDF file on this machine."""

    origin: str
    """Where the file comes from."""

    licence: str
    """An SPDX expression, or where to read the licence."""


@dataclass(frozen=True, kw_only=True)
class RobotsRecord:
    """The robots known by name."""

    format: Annotated[Literal["graphdyn robots 1"], FORMAT] = "graphdyn robots 1"

    robots: Sequence[CatalogueEntryRecord]
    """The catalogue, in the order of the table."""


def record(entries: Sequence[RobotEntry]) -> RobotsRecord:
    """The catalogue. entries: as urdf.robots gives them"""
    return RobotsRecord(robots=[taken(CatalogueEntryRecord, entry, path=str(entry.path)) for entry in entries])
