"""The format `graphdyn inspect 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, Command, Index, Keywords, Versions, taken
from crosscheck.report.versions import versions
from urdf import Inspection


@dataclass(frozen=True, kw_only=True)
class InspectFindingRecord:
    """One fault or oddity."""

    code: Annotated[str, Keywords(pattern="^[a-z]+(-[a-z]+)*$")]
    """Stable name of its kind."""

    severity: Literal["error", "warning", "note"]
    """error: urdf.load refuses the file; warning: it loads, its dynamics are doubtful; note: good to know."""

    element: str | None
    """The element by name; null for the file as a whole."""

    line: Index | None
    """Line in the file, from 1; null where there is none."""

    message: str
    """What is there, and what Pinocchio and yourdfpy do with it."""

    remedy: str
    """What to do about it."""


@dataclass(frozen=True, kw_only=True)
class FileRecord:
    """A file."""

    robot: str
    """Path or name as asked for."""

    path: str | None
    """The file; null where there is none."""

    verdict: Literal["dynamics", "kinematics only", "refused"]
    """Fit for dynamics; torques do not determine accelerations; urdf.load refuses the file."""

    usable: bool
    """The verdict is dynamics."""

    reasons: Sequence[str]
    """Why the verdict is not dynamics; empty where it is."""

    findings: Sequence[InspectFindingRecord]
    """Errors, warnings, notes, each in the order of the file."""


@dataclass(frozen=True, kw_only=True)
class InspectFailureRecord:
    """An argument."""

    robot: str
    """The argument."""

    message: str
    """What is wrong with it."""


@dataclass(frozen=True, kw_only=True)
class InspectRecord:
    """What is odd or wrong about URDF files."""

    format: Annotated[Literal["graphdyn inspect 1"], FORMAT] = "graphdyn inspect 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    usable: bool
    """Every file is good for dynamics, and no argument failed."""

    files: Sequence[FileRecord]
    """One record per file, in the order of the arguments; those of a folder by path."""

    occurrences: Mapping[str, Index]
    """Number of files by code of a finding, the most frequent first."""

    failures: Sequence[InspectFailureRecord]
    """Arguments that are no file, no robot's name and no folder with URDF files."""


def file_record(report: Inspection) -> FileRecord:
    """One inspected file."""
    return taken(FileRecord, report, findings=[taken(InspectFindingRecord, finding) for finding in report.findings])


def record(
    reports: Sequence[Inspection],
    occurrences: Mapping[str, int],
    failures: Sequence[Mapping[str, str]],
    command: Sequence[str],
) -> InspectRecord:
    """All files. failures: robot and message of each argument that stands for no file"""
    return InspectRecord(
        command=command,
        usable=all(report.usable for report in reports) and not failures,
        files=[file_record(report) for report in reports],
        occurrences=occurrences,
        failures=[InspectFailureRecord(**failure) for failure in failures],
    )
