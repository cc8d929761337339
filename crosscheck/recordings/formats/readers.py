"""The reader of each kind of file."""

from __future__ import annotations

from collections.abc import Callable
from errno import ENOENT
from pathlib import Path

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.array_files import read_npz, read_parquet
from crosscheck.recordings.formats.bag_files import read_bag
from crosscheck.recordings.formats.csv_files import read_csv
from crosscheck.recordings.formats.echoed_messages import named
from crosscheck.recordings.formats.matlab_files import read_mat
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import RecordedTable

TEXT = (".csv", ".tsv", ".txt", ".dat", ".log")
BAGS = (".bag", ".db3", ".mcap")
ARRAYS: dict[str, Callable[[Path], RecordedTable]] = {
    ".parquet": read_parquet,
    ".pq": read_parquet,
    ".npz": read_npz,
    ".mat": read_mat,
}
SUFFIXES = (*TEXT, f"{TEXT[0]}.gz", *ARRAYS, *BAGS)


def read_table(path: Path, mapping: ColumnMapping | None, joints: tuple[str, ...] | None) -> RecordedTable:
    """Read one file by its suffix; a folder is a ROS 2 bag. Raises BadRecordingFile, OSError."""
    suffix = "".join(path.suffixes[-2:]).lower() if path.suffix.lower() == ".gz" else path.suffix.lower()
    if not path.exists():
        raise FileNotFoundError(ENOENT, "no such file", str(path))
    if path.is_dir() and not (path / "metadata.yaml").exists():
        raise BadRecordingFile(f"{path}: is a folder, and no ROS 2 bag: it has no metadata.yaml; give a file")
    if suffix in BAGS or path.is_dir():
        return read_bag(path, mapping.topic if mapping else None, (mapping and mapping.joints) or joints)
    if suffix.removesuffix(".gz") in TEXT:
        table = read_csv(path, mapping.delimiter if mapping else None)
        return table if table.has_names or mapping else named(table)
    if suffix in ARRAYS:
        return ARRAYS[suffix](path)
    known = ", ".join(SUFFIXES)
    raise BadRecordingFile(f"{path}: recordings cannot be read from '{suffix}' files; convert it to one of: {known}")
