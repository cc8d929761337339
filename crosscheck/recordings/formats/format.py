"""Description of a file format of recordings: a Format in the file that reads it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import RecordedTable
from crosscheck.recordings.virtual.files import RecordedMotion


@dataclass(frozen=True)
class Format:
    """A file format of recordings; formats() collects those in FORMATS of the modules of this room.

    suffixes: endings of its files in lower case; a motion is written with the first
    read: the table of a file, given the mapping and the joints wanted, if they are known
    batches: column names and Arrow batches of at most this number of rows, given the delimiter of a mapping; None
        for a format that is only read as a whole
    write: the content of a file with this motion and metadata; None for a format that is only read
    """

    suffixes: tuple[str, ...]
    read: Callable[[Path, ColumnMapping | None, tuple[str, ...] | None], RecordedTable]
    batches: Callable[[Path, str | None, int], tuple[Sequence[str], Iterable[Any]]] | None = None
    write: Callable[[RecordedMotion, Path, Mapping[str, str]], bytes] | None = None
