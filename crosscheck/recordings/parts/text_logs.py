"""Long logs in text files as Parquet files, which can be read part by part: temporary, until the program ends."""

from __future__ import annotations

import atexit
from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from crosscheck.recordings.errors import BadRecordingFile, reason
from crosscheck.recordings.formats.csv_files import batches_of_csv
from crosscheck.recordings.formats.format import suffix_of
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.parts.free_memory import give_back_free_memory

TEXT_SUFFIXES = (".csv", ".csv.gz")
"""Endings of text files that are read as a stream."""

GROUP_ROWS = 65_536
"""Rows of a row group of the Parquet file: whoever reads a part reads no more than the groups that hold it."""

_FOLDERS: dict[tuple[Any, ...], TemporaryDirectory[str]] = {}
"""Folders of the files that were converted, by what says which file it was and how it was read."""


def is_text_log(path: Path) -> bool:
    """Whether a file has one of the endings of TEXT_SUFFIXES."""
    return suffix_of(path) in TEXT_SUFFIXES


def as_parquet(path: Path, mapping: ColumnMapping | None) -> Path:
    """The Parquet file with the rows of a text file. Raises BadRecordingFile for one that is no even table; OSError."""
    status = path.stat()
    told = (mapping.delimiter, mapping.decimal) if mapping else (None, None)
    key = (path.resolve(), status.st_mtime_ns, status.st_size, *told)
    if key not in _FOLDERS:
        _FOLDERS[key] = _converted(path, mapping)
    return _file_in(_FOLDERS[key])


def _file_in(folder: TemporaryDirectory[str]) -> Path:
    return Path(folder.name) / "log.parquet"


def _converted(path: Path, mapping: ColumnMapping | None) -> TemporaryDirectory[str]:
    """The folder of the converted file, which is deleted when the program ends."""
    import pyarrow as pa
    from pyarrow import parquet

    folder = TemporaryDirectory(prefix="graphdyn-")
    atexit.register(folder.cleanup)
    try:
        names, batches = batches_of_csv(path, mapping, GROUP_ROWS)
        groups = _groups(names, batches)
        first = next(groups, None)
        if first is None:
            raise BadRecordingFile(f"{path}: no rows; record at least one")
        with parquet.ParquetWriter(_file_in(folder), first.schema, compression="none") as writer:
            writer.write_table(first)
            for group in groups:
                writer.write_table(group)
    except (pa.ArrowException, EOFError, UnicodeDecodeError) as error:
        raise BadRecordingFile(f"{path}: {reason(error)}; load_recording gives details, or repair the file") from error
    finally:
        give_back_free_memory()
    return folder


def _groups(names: Iterable[str], batches: Iterable[Any]) -> Iterator[Any]:
    """Arrow tables of GROUP_ROWS rows or a little more."""
    import pyarrow as pa

    waiting: list[Any] = []
    for batch in batches:
        waiting.append(pa.record_batch(batch.columns, names=list(names)))
        if sum(map(len, waiting)) >= GROUP_ROWS:
            yield pa.Table.from_batches(waiting)
            waiting = []
    if waiting:
        yield pa.Table.from_batches(waiting)
