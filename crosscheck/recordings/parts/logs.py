"""Long logs: one Parquet file each, or a folder of consecutive Parquet files, as Dask and Spark write.

The parts of one log are in one folder. A file that is named individually is a log of its own, whose filters begin and
end with it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from errno import ENOENT
from functools import cached_property
from os import PathLike
from pathlib import Path

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.parquet_files import FORMATS

PARQUET_SUFFIXES = FORMATS[0].suffixes


@dataclass(frozen=True)
class Log:
    """A long log. path: as given; files: in the order of time."""

    path: Path
    files: tuple[Path, ...]

    @cached_property
    def rows(self) -> tuple[int, ...]:
        """Number of rows of every file. Raises BadRecordingFile for one that is not Parquet, or has other columns than
        the first.
        """
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


def log_of(path: str | PathLike[str]) -> Log:
    """The log of a file, or of a folder. Raises BadRecordingFile for one without Parquet files, FileNotFoundError."""
    place = Path(path)
    if not place.exists():
        raise FileNotFoundError(ENOENT, "no such file or folder", str(place))
    if not place.is_dir():
        return Log(place, (place,))
    files = [file for file in place.iterdir() if file.suffix.lower() in PARQUET_SUFFIXES]
    if not files:
        raise BadRecordingFile(f"{place}: no Parquet file in this folder; a folder is one log in parts")
    return Log(place, tuple(sorted(files, key=_number_order)))


def _number_order(file: Path) -> list[tuple[int, str]]:
    """Sort key by the numbers in a name: part.2 before part.10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", file.name)]


def _told(file: Path) -> tuple[int, list[str]]:
    import pyarrow as pa
    from pyarrow import parquet

    if file.suffix.lower() not in PARQUET_SUFFIXES:
        raise BadRecordingFile(f"{file}: only Parquet files are read in parts; convert it to one")
    try:
        metadata = parquet.ParquetFile(file)
        return metadata.metadata.num_rows, metadata.schema_arrow.names
    except (pa.ArrowException, OSError) as error:
        raise BadRecordingFile(f"{file}: {error}; repair the file") from error
