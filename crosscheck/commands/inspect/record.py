"""The format `graphdyn inspect 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from crosscheck.report.records.record import CommandRecord, Index, Keywords, Record, attribute, written
from urdf import Finding, Inspection


class InspectFindingRecord(Record, of=Finding):
    """One fault or oddity."""

    code: Annotated[str, Keywords(pattern="^[a-z]+(-[a-z]+)*$")]
    line: Index | None


class FileRecord(Record, of=Inspection):
    """A file."""

    verdict = attribute()
    usable = attribute()
    reasons = attribute()
    findings: Sequence[InspectFindingRecord]


class InspectFailureRecord(Record):
    """An argument.

    robot: the argument
    message: what is wrong with it
    code: of the error, as in docs/loading.md
    file, line: the place, null where there is none
    """

    robot: str
    message: str
    code: str
    file: str | None
    line: Index | None


class InspectRecord(CommandRecord, format="graphdyn inspect 1"):
    """What is odd or wrong about URDF files.

    usable: every file is good for dynamics, and no argument failed
    files: one record per file, in the order of the arguments; those of a folder by path
    occurrences: number of files by code of a finding, the most frequent first
    failures: arguments that are no file, no robot's name and no folder with URDF files
    """

    usable: bool
    files: Sequence[FileRecord]
    occurrences: Mapping[str, Index]
    failures: Sequence[InspectFailureRecord]


def record(
    reports: Sequence[Inspection],
    occurrences: Mapping[str, int],
    failures: Sequence[Mapping[str, Any]],
    command: Sequence[str],
) -> dict[str, Any]:
    """All files. failures: robot and message of each argument that stands for no file"""
    return written(
        InspectRecord,
        command=command,
        usable=all(report.usable for report in reports) and not failures,
        files=reports,
        occurrences=occurrences,
        failures=failures,
    )
