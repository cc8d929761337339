"""Parquet files, whole and in batches of rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

from crosscheck.recordings.arrow import check_arrow
from crosscheck.recordings.formats.format import Format, check_expanded, refusing_damage, table_of_columns
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import RecordedTable
from crosscheck.recordings.virtual import virtual_recording_document


def read_parquet(path: Path) -> RecordedTable:
    """Read a Parquet file; a column of lists becomes one column per element, name_1, name_2, …"""
    table = parquet_table(path)
    return table_of_columns(path, table.schema.names, table.columns)


def parquet_table(path: Path) -> Any:
    """The Arrow table of a Parquet file. Raises BadRecordingFile, OSError."""
    check_arrow(path)
    import pyarrow as pa
    from pyarrow import parquet

    content = path.read_bytes()
    with refusing_damage(path, "Parquet file", "save it again"):
        file = parquet.ParquetFile(pa.BufferReader(content), page_checksum_verification=True)
        batches, size = [], 0
        check_expanded(path, 8 * file.metadata.num_rows * file.metadata.num_columns)
        for batch in file.iter_batches():  # lists may have any number of elements per row
            batches.append(batch)
            size += batch.nbytes
            check_expanded(path, size)
        table = pa.Table.from_batches(batches, file.schema_arrow)
        table.validate(full=True)  # also whether texts are texts
        return table


def batches_of_parquet(path: Path, _mapping: ColumnMapping | None, rows: int) -> tuple[Sequence[str], Iterable[Any]]:
    """The names of the columns, and batches of at most this number of rows."""
    from pyarrow import parquet

    file = parquet.ParquetFile(path, page_checksum_verification=True, buffer_size=BUFFER_BYTES)
    return file.schema_arrow.names, file.iter_batches(rows)


FORMATS = (
    Format(
        (".parquet", ".pq"),
        lambda path, _mapping, _joints: read_parquet(path),
        batches=batches_of_parquet,
        write=virtual_recording_document,
    ),
)


BUFFER_BYTES = 1 << 18
"""Bytes of a column that are read at once: without it, those of a whole row group, which may be the whole file."""

BATCH_ROWS = 16_384
"""Number of rows of a Parquet file that are decoded at once."""


def parquet_rows(path: Path, first: int, last: int) -> RecordedTable:
    """The rows first … last - 1 of a Parquet file; only the row groups that hold them are read.

    Raises BadRecordingFile.
    """
    import pyarrow as pa
    from pyarrow import parquet

    with refusing_damage(path, "Parquet file", "repair the file"):
        with parquet.ParquetFile(path, page_checksum_verification=True, buffer_size=BUFFER_BYTES) as file:
            names, metadata = file.schema_arrow.names, file.metadata
            starts = [0, *accumulate(metadata.row_group(k).num_rows for k in range(metadata.num_row_groups))]
            groups = [k for k in range(len(starts) - 1) if starts[k] < last and starts[k + 1] > first]
            row, batches = starts[groups[0]], []
            for batch in file.iter_batches(BATCH_ROWS, row_groups=groups, use_threads=False):
                begin, end = max(first - row, 0), min(last - row, len(batch))
                if begin < end:
                    batches.append(batch.slice(begin, end - begin))
                row += len(batch)
                if row >= last:
                    break
        numbers = [str(k) for k in range(len(names))]  # names may be repeated
        whole = pa.Table.from_batches([pa.record_batch(batch.columns, names=numbers) for batch in batches])
        whole.validate(full=True)
    return table_of_columns(path, names, whole.columns)
