"""Parts of long logs, each read with the rows around it that filters need, so that it is independent of the others.

A long log is one Parquet file, or a folder of consecutive Parquet files, as Dask and Spark write. The parts of one log
are in one folder. A file that is named individually is a log of its own, whose filters begin and end with it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from errno import ENOENT
from functools import cached_property
from itertools import pairwise
from os import PathLike
from pathlib import Path

import numpy as np

from crosscheck.recordings.arrow import check_arrow
from crosscheck.recordings.checks import Origin
from crosscheck.recordings.errors import BadRecordingFile, RecordingFinding
from crosscheck.recordings.formats.format import refusing_damage
from crosscheck.recordings.formats.parquet_files import FORMATS, parquet_rows
from crosscheck.recordings.loading import reordered
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.mapping.mapping_by_name import mapping_by_name
from crosscheck.recordings.parts.free_memory import give_back_free_memory
from crosscheck.recordings.parts.streaming import RowPosition, appended, refuse_uneven, window_of
from crosscheck.recordings.parts.text_logs import as_parquet, is_text_log
from crosscheck.recordings.preparation.derivatives import STENCIL_ROWS, differentiated
from crosscheck.recordings.preparation.filtering import (
    FORGETTING_BORDERS,
    border,
    check_cutoff,
    samples_with,
    torque_filter,
)
from crosscheck.recordings.preparation.resampling import refuse_delays, sampling_rate
from crosscheck.recordings.preparation.splits import GUARD_TIME
from crosscheck.recordings.recording import Recording
from crosscheck.recordings.table import RecordedTable
from graphdyn import InvalidInput
from graphdyn.errors import counted
from graphdyn.identification import Samples

PARQUET_SUFFIXES = FORMATS[0].suffixes


@dataclass(frozen=True)
class Log:
    """A long log. path: as given; files: in the order of time."""

    path: Path
    files: tuple[Path, ...]

    @cached_property
    def rows(self) -> tuple[int, ...]:
        """Number of rows of every file. Raises BadRecordingFile for one not Parquet, or with other columns."""
        counts, first = [], None
        for file in self.files:
            rows, names = _told(file)
            first = first or names
            if names != first:
                raise BadRecordingFile(
                    f"{file}: its columns are not those of {self.files[0]}; the files of a folder are parts of one "
                    "log, in the order of the numbers in their names: put different logs into different folders"
                )
            counts.append(rows)
        return tuple(counts)

    @property
    def n_rows(self) -> int:
        return sum(self.rows)

    def told(self, file: Path) -> Path:
        """What messages call one of the files: text logs by their own name."""
        return self.path if is_text_log(self.path) else file

    def table(self, file: Path, first: int, last: int) -> RecordedTable:
        """The rows first … last - 1 of one of the files. Raises BadRecordingFile."""
        table = replace(parquet_rows(file, first, last), path=self.told(file))
        give_back_free_memory()  # Arrow takes 60 MB for the smallest part
        return table


def log_of(path: str | PathLike[str], mapping: ColumnMapping | None = None) -> Log:
    """The log of a file, or of a folder; that of a text file is converted. mapping: says how text is read

    Raises BadRecordingFile for a folder without Parquet files, and for text that is no even table; FileNotFoundError.
    """
    place = Path(path)
    if not place.exists():
        raise FileNotFoundError(ENOENT, "no such file or folder", str(place))
    if not place.is_dir():
        return Log(place, (as_parquet(place, mapping) if is_text_log(place) else place,))
    files = [file for file in place.iterdir() if file.suffix.lower() in PARQUET_SUFFIXES]
    if not files:
        raise BadRecordingFile(f"{place}: no Parquet file in this folder; a folder is one log in parts")
    return Log(place, tuple(sorted(files, key=_number_order)))


def _number_order(file: Path) -> list[tuple[int, str]]:
    """Sort key by the numbers in a name: part.2 before part.10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", file.name)]


def _told(file: Path) -> tuple[int, list[str]]:
    check_arrow(file)
    from pyarrow import parquet

    if file.suffix.lower() not in PARQUET_SUFFIXES:
        raise BadRecordingFile(f"{file}: only Parquet and CSV files are read in parts; convert it to one")
    with refusing_damage(file, "Parquet file", "repair the file"):
        metadata = parquet.ParquetFile(file)
        return metadata.metadata.num_rows, metadata.schema_arrow.names


HEAD_ROWS = 1000
"""Number of rows from which the sampling rate of a log is estimated."""


@dataclass(frozen=True, eq=False)
class ReadableLog:
    """The rows begin … end - 1 of a log, and the settings for reading them.

    origin: of its times; cutoff: as in differentiated
    cut: largest number of rows that differentiation cuts at each end; memory: of the filter of the torque, in rows
    findings: assumptions on the columns, if they were found by name
    """

    log: Log
    mapping: ColumnMapping
    origin: Origin | None
    joints: tuple[str, ...] | None
    cutoff: float | Mapping[str, float] | None
    cut: int
    memory: int
    begin: int
    end: int
    findings: tuple[RecordingFinding, ...]

    @classmethod
    def of(
        cls,
        log: Log,
        mapping: ColumnMapping | None,
        joints: tuple[str, ...] | None,
        rate: float | None,
        cutoff: float | Mapping[str, float] | None,
        between: tuple[float, float],
    ) -> ReadableLog:
        """Settings from the first rows. between: parts of the rows. Raises as PartitionedRecording."""
        if not log.n_rows:
            raise InvalidInput(f"{log.path}: no rows; leave it out")
        file, count = next(found for found in zip(log.files, log.rows, strict=True) if found[1])
        head = log.table(file, 0, min(HEAD_ROWS, count))
        mapping, findings = (mapping, []) if mapping else mapping_by_name(head, joints, rate)
        refuse_delays(mapping)
        window, origin = window_of(head, mapping, RowPosition(0, 0), None)
        found = sampling_rate(window)
        cutoffs = dict(cutoff) if isinstance(cutoff, Mapping) else dict.fromkeys(("q", "tau"), cutoff) if cutoff else {}
        for frequency in cutoffs.values():
            check_cutoff(found, frequency)
        torque = cutoffs.pop("tau", None)
        cut = max((border(found, frequency) for frequency in cutoffs.values()), default=0) + STENCIL_ROWS
        memory = FORGETTING_BORDERS * (border(found, torque) + 1) if torque else 0
        begin, end = (int(log.n_rows * part) for part in between)
        end -= round(GUARD_TIME * found) if end < log.n_rows else 0
        source = cls(log, mapping, origin, joints, cutoff, cut, memory, begin, end, tuple(findings))
        if source.n_rows <= source.shortest:
            raise InvalidInput(
                f"{log.path}: {max(source.n_rows, 0)} of {counted(log.n_rows, 'row')}, too few for the borders of the "
                f"filter, which need {source.shortest + 1}; leave the log out, or choose a higher cutoff"
            )
        return source

    @property
    def n_rows(self) -> int:
        return self.end - self.begin

    @property
    def shortest(self) -> int:
        """Number of rows of a part that exceeds the rows to be read around it."""
        return 2 * (FORGETTING_BORDERS * self.cut + self.memory)

    def read(self, first: int, last: int) -> Recording:
        """Read these rows of the log. Raises InvalidInput and BadRecordingFile."""
        whole: Recording | None = None
        start = 0
        for file, count in zip(self.log.files, self.log.rows, strict=True):
            begin, end = max(first - start, 0), min(last - start, count)
            if begin < end:
                table = self.log.table(file, begin, end)
                window, _ = window_of(table, self.mapping, RowPosition(start + begin, begin), self.origin)
                whole = window if whole is None else appended(whole, window)
            start += count
        assert whole is not None
        refuse_uneven(whole, self.log.path, first)
        return whole if self.joints is None else reordered(whole, self.joints)


@dataclass(frozen=True, eq=False)
class Partition:
    """Rows first … last - 1 of a log; block: number of the time block of the data."""

    source: ReadableLog
    first: int
    last: int
    block: int

    @property
    def name(self) -> str:
        """Name of the part for messages."""
        return f"{self.source.log.path}, rows {self.first} to {self.last}"

    def samples(self, memory: int) -> tuple[Samples, slice]:
        """Its samples and at most `memory` ones on either side, and which of them are its own.

        The first and the last part lack the rows that differentiation cuts off. Raises as read.
        """
        source = self.source
        around = memory + FORGETTING_BORDERS * source.cut
        start = max(self.first - around, source.begin)
        done = differentiated(source.read(start, min(self.last + around, source.end)), source.cutoff)
        numbers = start + done.rows
        wanted = (numbers >= self.first - memory) & (numbers < self.last + memory)
        numbers = numbers[wanted]
        own = np.flatnonzero((numbers >= self.first) & (numbers < self.last))
        piece = samples_with(torque_filter(done), done, wanted, continues=self.first > source.begin)
        return piece, slice(int(own[0]), int(own[-1]) + 1)


def partitions(logs: list[ReadableLog], rows: int, blocks: int) -> list[Partition]:
    """Parts of at most this number of rows, at least one for every time block if the data allow.

    The same files give the same parts. Raises InvalidInput for a log or parts too short for the filter.
    """
    total = sum(source.n_rows for source in logs)
    block_rows = -(-total // blocks)
    found, before = [], 0
    for source in logs:
        count = source.n_rows
        if rows <= source.shortest:
            raise InvalidInput(
                f"parts of {counted(rows, 'row')} are too short for the borders of the filter; give more than "
                f"{source.shortest}, or a higher cutoff"
            )
        size = max(min(rows, block_rows), source.shortest + 1)
        parts = -(-count // size)
        ends = [count * part // parts for part in range(parts + 1)]
        found += [
            Partition(source, source.begin + first, source.begin + last, (before + first) // block_rows)
            for first, last in pairwise(ends)
        ]
        before += count
    return found
