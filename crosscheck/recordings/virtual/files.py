"""Virtual recordings in files: CSV or Parquet, one row per time, the columns of virtual_recording_columns."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from crosscheck.recordings.errors import BadRecordingFile, quoted
from crosscheck.recordings.table import cells_of_column
from crosscheck.recordings.virtual.columns import (
    JOINT_UNITS,
    ROBOT,
    TIME,
    Elements,
    check_headers,
    columns,
    elements_of,
)
from graphdyn import InvalidInput, VirtualRecording
from graphdyn.experiments import CHANNELS
from graphdyn.layout import Array
from urdf.document import write_whole

FIRST_ROW = {".csv": ("line", 2), ".parquet": ("row", 1)}
"""Name of a row in messages, and number of the first, per kind of file."""


class RecordedMotion(Protocol):
    """A motion that can be written: a VirtualRecording or a Simulation."""

    @property
    def joint_names(self) -> tuple[str, ...]: ...
    @property
    def time(self) -> Array: ...
    @property
    def q(self) -> Array: ...
    @property
    def v(self) -> Array: ...
    @property
    def a(self) -> Array: ...
    @property
    def tau(self) -> Array: ...


def save_virtual_recording(recording: VirtualRecording, path: str | PathLike[str]) -> None:
    """Write the recording as CSV or Parquet, by the suffix; load_virtual_recording reads it back bit for bit.

    The file appears complete or not at all. Raises InvalidInput for another suffix, and for names that begin or end
    with a space or contain unprintable characters; OSError if the file cannot be written.
    """
    path = Path(path)
    write_whole(path, virtual_recording_document(recording, path, {}))


def virtual_recording_document(recording: RecordedMotion, path: Path, metadata: Mapping[str, str]) -> bytes:
    """Content of the file that save_virtual_recording writes; the metadata of the table goes into Parquet.

    Raises InvalidInput, also for a motion that is no VirtualRecording.
    """
    import pyarrow as pa
    from pyarrow import csv as arrow_csv
    from pyarrow import parquet

    if not isinstance(recording, VirtualRecording):
        raise InvalidInput(
            f"{path}: the robot has loops, and joint forces that nothing determines have no place in this table; "
            "write .npz or .mcap"
        )
    suffix = _suffix(path)
    for name in (recording.robot, *recording.joint_names, *recording.body_names):
        if name != name.strip() or not name.isprintable():
            raise InvalidInput(f"{path}: the name {name!r} cannot be read back from a header; rename it")
    cells = {ROBOT: pa.array([recording.robot] * len(recording.time)), TIME: pa.array(recording.time)}
    for column in columns(Elements(recording.joint_names, recording.prismatic, recording.body_names)):
        cells[column.header] = pa.array(_flat(getattr(recording, column.channel))[:, column.number].copy())
    table, sink = pa.table(cells, metadata=dict(metadata) or None), pa.BufferOutputStream()
    (arrow_csv.write_csv if suffix == ".csv" else parquet.write_table)(table, sink)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def load_virtual_recording(path: str | PathLike[str]) -> VirtualRecording:
    """Read a recording from a CSV or Parquet file with the columns that save_virtual_recording writes.

    Raises BadRecordingFile for missing, unknown or repeated columns, other units, lines of unequal length, cells that
    are not finite numbers, times that do not increase; InvalidInput for another suffix; OSError for an unreadable file.
    """
    path = Path(path)
    suffix = _suffix(path)
    table = _read_csv(path) if suffix == ".csv" else _read_parquet(path)
    headers = [name.strip() for name in table.column_names]
    elements = elements_of(path, headers)
    expected = columns(elements)
    check_headers(path, headers, expected)
    n_times, (kind, first) = table.num_rows, FIRST_ROW[suffix]
    if n_times == 0:
        raise BadRecordingFile(f"{path}: no {kind} below the header; record at least one time")

    def place(row: int, header: str) -> str:
        return f"{path}, {kind} {first + row}, column {headers.index(header) + 1} {header!r}"

    def numbers(header: str) -> Array:
        cells = cells_of_column(table.column(headers.index(header)))
        values = np.full(n_times, np.nan) if isinstance(cells, str) else cells.doubles
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            cell = table.column(headers.index(header))[int(bad[0])].as_py()
            where, remedy = place(int(bad[0]), header), f"repair it, or leave out the {kind}"
            raise BadRecordingFile(f"{where}: {quoted(cell)} is not a finite number; {remedy}")
        return values

    time, n = numbers(TIME), len(elements.joint_names)
    channels: dict[str, Array] = {
        name: np.empty((n_times, n) if name in JOINT_UNITS else (n_times, n, 3)) for name in CHANNELS
    }
    for column in expected:
        _flat(channels[column.channel])[:, column.number] = numbers(column.header)
    robots = [name and str(name).strip() for name in table.column(headers.index(ROBOT)).to_pylist()]
    other = next((row for row, name in enumerate(robots) if name is None or name != robots[0]), None)
    if other is not None:
        raise BadRecordingFile(
            f"{place(other, ROBOT)}: {robots[other]!r}; write the name of the robot, the same in every {kind}"
        )
    try:
        return VirtualRecording(
            robot=robots[0],
            joint_names=elements.joint_names,
            body_names=elements.body_names,
            prismatic=elements.prismatic,
            time=time,
            **channels,
        )
    except InvalidInput as error:
        raise BadRecordingFile(f"{path}: {error}") from error


def _flat(channel: Array) -> Array:
    """A channel (N, n) or (N, n, 3) with one column per number."""
    return channel.reshape(len(channel), -1)


def _suffix(path: Path) -> str:
    if path.suffix.lower() not in FIRST_ROW:
        raise InvalidInput(f"{path}: a recording is saved as .csv or .parquet, not as '{path.suffix}'; rename the file")
    return path.suffix.lower()


def _read_csv(path: Path) -> Any:
    """An Arrow table with all cells as text, so that a bad one can be shown as written."""
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    content = path.read_bytes()
    try:
        header = next(csv.reader(io.StringIO(content.decode("utf-8-sig"))), [])
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise BadRecordingFile(f"{path}, line {line}: not UTF-8 text; save the file as CSV in UTF-8") from error
    try:
        return arrow_csv.read_csv(
            pa.BufferReader(content),
            read_options=arrow_csv.ReadOptions(use_threads=False),  # otherwise bad lines have no numbers
            parse_options=arrow_csv.ParseOptions(ignore_empty_lines=False),
            convert_options=arrow_csv.ConvertOptions(column_types=dict.fromkeys(header, pa.string())),
        )
    except pa.ArrowInvalid as error:
        row = re.search(r"Row #(\d+): Expected (\d+) columns, got (\d+)", str(error))
        if row is None:
            raise BadRecordingFile(f"{path}: {error}; write files with save_virtual_recording") from error
        raise BadRecordingFile(
            f"{path}, line {row[1]}: {row[3]} cells under {row[2]} headers; complete the line or leave it out"
        ) from error


def _read_parquet(path: Path) -> Any:
    import pyarrow as pa
    from pyarrow import parquet

    try:
        return parquet.read_table(pa.BufferReader(path.read_bytes()))
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise BadRecordingFile(f"{path}: not a readable Parquet file ({error}); save it again") from error
