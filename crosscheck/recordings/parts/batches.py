"""The table of a file that is larger than memory, in parts: Parquet, CSV, and CSV compressed with gzip."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator
from errno import ENOENT
from itertools import accumulate
from pathlib import Path
from typing import Any

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.array_files import table_of_columns
from crosscheck.recordings.formats.csv_layout import HEAD, Layout, cells_of_line, layout_of
from crosscheck.recordings.table import LONG_INTEGER, RecordedTable

AT_ONCE = 1 << 20
"""Part of a CSV file that is parsed at once [bytes]."""

BATCH = 65_536
"""Rows of a Parquet file that are decoded at once."""


def tables(path: Path, delimiter: str | None, rows: int) -> Iterator[RecordedTable]:
    """The file as tables of at most this number of rows. Raises BadRecordingFile, OSError."""
    import pyarrow as pa

    if not path.exists():
        raise FileNotFoundError(ENOENT, "no such file", str(path))
    name = path.name.lower()
    path.open("rb").close()  # what the system refuses is not the file's fault
    try:
        if name.endswith((".parquet", ".pq")):
            from pyarrow import parquet

            file = parquet.ParquetFile(path)
            names, batches = file.schema_arrow.names, file.iter_batches(rows)
        elif name.endswith((".csv", ".csv.gz")):
            names, batches = _csv_batches(path, delimiter)
        else:
            raise BadRecordingFile(f"{path}: only .parquet, .csv and .csv.gz files are streamed; convert it to one")
        for batch in batches:
            yield table_of_columns(
                path, names, pa.table(batch.columns, names=[str(k) for k in range(len(names))]).columns
            )
    except (pa.ArrowException, OSError, EOFError, UnicodeDecodeError, zlib.error) as error:
        raise BadRecordingFile(f"{path}: {error}; load_recording gives details, or repair the file") from error


def parquet_rows(path: Path, first: int, last: int) -> RecordedTable:
    """The rows first … last - 1 of a Parquet file; only the row groups that hold them are read.

    Raises BadRecordingFile.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        with parquet.ParquetFile(path) as file:
            names, metadata = file.schema_arrow.names, file.metadata
            starts = [0, *accumulate(metadata.row_group(k).num_rows for k in range(metadata.num_row_groups))]
            groups = [k for k in range(len(starts) - 1) if starts[k] < last and starts[k + 1] > first]
            row, batches = starts[groups[0]], []
            for batch in file.iter_batches(BATCH, row_groups=groups, use_threads=False):
                begin, end = max(first - row, 0), min(last - row, len(batch))
                if begin < end:
                    batches.append(batch.slice(begin, end - begin))
                row += len(batch)
                if row >= last:
                    break
    except (pa.ArrowException, OSError) as error:
        raise BadRecordingFile(f"{path}: {error}; repair the file") from error
    numbers = [str(k) for k in range(len(names))]  # names may be repeated
    whole = pa.Table.from_batches([pa.record_batch(batch.columns, names=numbers) for batch in batches])
    return table_of_columns(path, names, whole.columns)


def _csv_batches(path: Path, delimiter: str | None) -> tuple[tuple[str, ...], Any]:
    import pyarrow as pa
    from pyarrow import csv

    def opened() -> Any:
        return pa.input_stream(str(path), compression="gzip" if path.suffix.lower() == ".gz" else None)

    with opened() as file:
        head = file.read(HEAD).decode("utf-8-sig", errors="ignore")
    head = head.replace("\r\n", "\n").replace("\r", "\n")
    layout = layout_of(path, head, delimiter)
    if layout.delimiter == " ":
        raise BadRecordingFile(f"{path}: columns between spaces are not streamed; separate them by commas")
    names = [str(k) for k in range(len(layout.names))]
    reader = csv.open_csv(
        opened(),
        read_options=csv.ReadOptions(column_names=names, skip_rows=layout.above, block_size=AT_ONCE),
        parse_options=csv.ParseOptions(delimiter=layout.delimiter),
        convert_options=csv.ConvertOptions(
            column_types=_types(layout, head),
            decimal_point="," if layout.decimal_comma else ".",
            true_values=[],
            false_values=[],
        ),
    )
    return layout.names, reader


def _types(layout: Layout, head: str) -> dict[str, str]:
    """Types of the columns by the first row: doubles, or integers with all digits; calendar times are inferred."""
    first = cells_of_line(next((line for line in head[layout.length :].split("\n") if line.strip()), ""), layout)
    types = {}
    for k, cell in enumerate(first):
        if re.match(LONG_INTEGER, cell):
            types[str(k)] = "int64" if int(cell) < 2**63 else "uint64"
        elif re.fullmatch(r"[-+.,\deE]*", cell):
            types[str(k)] = "float64"
    return types
