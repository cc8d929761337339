"""Errors of reading recordings."""

from __future__ import annotations

from crosscheck.recordings.findings import RecordingFinding
from graphdyn import InvalidInput


class BadRecordingFile(InvalidInput):
    """A file that does not hold one whole recording; the message names file, line or row, column and remedy."""


class AmbiguousColumns(BadRecordingFile):
    """Columns whose names are ambiguous; the message lists the candidates."""


class DirtyRecording(BadRecordingFile):
    """A file with faulty rows.

    findings: all findings, the harmless ones too
    """

    def __init__(self, findings: tuple[RecordingFinding, ...]):
        self.findings = findings
        errors = [finding for finding in findings if finding.severity == "error"]
        super().__init__("\n".join(finding.text for finding in errors))


class BadMapping(InvalidInput):
    """A mapping of columns that is incomplete, contradictory or does not fit the file."""
