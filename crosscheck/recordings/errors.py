"""Findings about a recording, with their rows, and errors of reading recordings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from reprlib import Repr
from typing import Literal

import numpy as np

from graphdyn import InvalidInput
from urdf.errors import one_line

MAX_LISTED_SPANS = 5
"""Largest number of runs of rows that a message lists; RecordingFinding.rows has them all."""

DROPPED_UNASKED = ("truncated-last-line", "blank-line")
"""Codes of rows that are always dropped: they hold no measurement, or are the cut-off last line."""

DROPPABLE = (
    *DROPPED_UNASKED,
    "wrong-column-count",
    "not-a-number",
    "implausible-value",
    "repeated-stamp",
    "backward-stamp",
    "saturation",
    "unterminated-last-line",
)
"""Codes of findings whose rows can be dropped."""

MAX_QUOTED_CHARACTERS = 80
"""Largest number of characters of a name or cell that a message quotes."""


def quoted(value: object) -> str:
    """A name or cell of a file for a message: as Python writes it, a long one without its middle."""
    shortened = Repr()
    shortened.maxstring = shortened.maxother = MAX_QUOTED_CHARACTERS
    return shortened.repr(value)


MAX_REASON_CHARACTERS = 200
"""Largest number of characters that a message repeats of what a library says."""


def reason(error: BaseException) -> str:
    """What a library says of a file, on one line; a long text, which may quote the file, without its middle."""
    half = MAX_REASON_CHARACTERS // 2
    text = str(error)
    if len(text) > MAX_REASON_CHARACTERS:
        text = f"{text[:half]} … {text[-half:]}"
    return one_line(" ".join(text.split())) or type(error).__name__


@dataclass(frozen=True)
class RecordingFinding:
    """One kind of fault or oddity in one file.

    code: stable name of its kind ("repeated-stamp")
    severity: "error": refused unless its rows are dropped; "warning": suspicious; "note": for information
    file, column: position; column is None if it concerns whole rows
    rows: rows of data, counted from 0 as NumPy and pandas do, including malformed lines; empty: all rows
    message: what was found; remedy: what to do
    lines: line of row 0 in the file; None if the file has no lines
    """

    code: str
    severity: Literal["error", "warning", "note"]
    file: str
    column: str | None
    rows: tuple[int, ...]
    message: str
    remedy: str
    lines: int | None = None

    @property
    def text(self) -> str:
        """File, column, rows, message and remedy, in one line."""
        place = [
            self.file,
            *([f"column {quoted(self.column)}"] if self.column else []),
            *([where] if (where := self._where) else []),
        ]
        return f"{', '.join(place)}: {self.message}; {self.remedy} [{self.code}]"

    @property
    def _where(self) -> str:
        if not self.rows:
            return ""
        where = f"row{'s' if len(self.rows) > 1 else ''} {spans(self.rows)}"
        if self.lines is None:
            return where
        lines = [row + self.lines for row in self.rows]
        return f"{where} (line{'s' if len(lines) > 1 else ''} {spans(lines)})"


def noted(file: str, code: str, message: str, remedy: str) -> RecordingFinding:
    """A note about a whole file."""
    return RecordingFinding(code, "note", file, None, (), message, remedy)


def spans(rows: Iterable[int]) -> str:
    """Increasing rows as text, such as "3, 7–9, 12", limited to the first few runs."""
    rows = np.fromiter(rows, dtype=int)
    runs = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)
    texts = [str(run[0]) if len(run) == 1 else f"{run[0]}–{run[-1]}" for run in runs[:MAX_LISTED_SPANS]]
    return ", ".join(texts) + (f", … ({len(rows)} in all)" if len(runs) > MAX_LISTED_SPANS else "")


class BadRecordingFile(InvalidInput):
    """A file that does not hold one whole recording; the message names file, line or row, column and remedy."""


class AmbiguousColumns(BadRecordingFile):
    """Columns whose names are ambiguous; the message lists the candidates."""


class DirtyRecording(BadRecordingFile):
    """A file with faulty rows.

    findings: all findings, including the harmless ones
    """

    def __init__(self, findings: tuple[RecordingFinding, ...]):
        self.findings = findings
        self.problems = tuple(finding.text for finding in findings if finding.severity == "error")
        super().__init__("\n".join(self.problems))


class BadMapping(InvalidInput):
    """A mapping of columns that is incomplete, contradictory or does not fit the file."""
