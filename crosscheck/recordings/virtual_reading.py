"""Exact recordings are read: every defect of a file is refused with its line, its column and the remedy."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.recordings.arrow import check_arrow
from crosscheck.recordings.errors import BadRecordingFile, quoted
from crosscheck.recordings.formats.format import content_of
from crosscheck.recordings.formats.parquet_files import parquet_table
from crosscheck.recordings.table import cells_of_column
from crosscheck.recordings.virtual import (
    BODY_CHANNEL_COLUMNS,
    FIRST_ROW,
    JOINT_UNITS,
    ROBOT,
    TIME,
    Elements,
    VirtualColumn,
    columns,
    recording_suffix,
)
from graphdyn import InvalidInput, VirtualRecording
from graphdyn.errors import counted
from graphdyn.experiments import CHANNELS
from graphdyn.layout import Array
from urdf.errors import one_line

_BODY_SYMBOLS = {symbol for _, symbols in BODY_CHANNEL_COLUMNS.values() for symbol in symbols}


def elements_of(path: Path, headers: Iterable[str]) -> Elements:
    """The joints and bodies that the headers name, in the order in which they first appear. Raises BadRecordingFile."""
    joints: dict[str, bool] = {}
    bodies: dict[str, None] = {}
    for label, unit in map(_split, headers):
        name, _, symbol = label.rpartition(".")
        if symbol in JOINT_UNITS:
            joints[name] = joints.get(name, False) or (symbol == "q" and unit == "m")
        elif symbol in _BODY_SYMBOLS:
            bodies[name] = None
    if not joints or len(joints) != len(bodies):
        raise BadRecordingFile(
            f"{path}, header: {counted(len(joints), 'joint')} ({one_line(', '.join(joints))}), "
            f"{counted(len(bodies), 'body', 'bodies')} ({one_line(', '.join(bodies))}); "
            "each joint needs its columns '<joint>.q [rad]' … and its body the columns '<body>.r_x [m]' …"
        )
    return Elements(tuple(joints), tuple(joints.values()), tuple(bodies))


def check_headers(path: Path, headers: list[str], expected: Iterable[VirtualColumn]) -> None:
    """Raise BadRecordingFile unless every expected column occurs once, in its unit, and no other column does."""
    units = dict([_split(ROBOT), _split(TIME)]) | {column.label: column.unit for column in expected}
    seen = set()
    for number, header in enumerate(headers, start=1):
        label, unit = _split(header)
        where = f"{path}, header, column {number} {header!r}"
        if label not in units:
            raise BadRecordingFile(f"{where}: not a column of a recording; remove it")
        if label in seen:
            raise BadRecordingFile(f"{where}: {label!r} occurs twice; keep one")
        if unit != units[label]:
            needed = f"[{units[label]}]" if units[label] else "none"
            raise BadRecordingFile(f"{where}: the unit must be {needed}; convert the numbers and rename the column")
        seen.add(label)
    missing = [_header(label, unit) for label, unit in units.items() if label not in seen]
    if missing:
        names = f"column {missing[0]!r}" + (f" and {len(missing) - 1} more" if len(missing) > 1 else "")
        raise BadRecordingFile(f"{path}, header: without {names}; record every channel of every joint and body")


def _split(header: str) -> tuple[str, str]:
    """Label and unit of 'label [unit]'; a header without brackets has the unit ''."""
    found = re.fullmatch(r"(.*\S)\s*\[([^\[\]]*)\]", header, re.DOTALL)
    return (found[1], found[2]) if found else (header, "")


def _header(label: str, unit: str) -> str:
    return f"{label} [{unit}]" if unit else label


def load_virtual_recording(path: str | PathLike[str]) -> VirtualRecording:
    """Read a recording from a CSV or Parquet file with the columns that save_virtual_recording writes.

    Raises BadRecordingFile for missing, unknown or repeated columns, other units, lines of unequal length, cells that
    are not finite numbers, times that do not increase; InvalidInput for another suffix; OSError for an unreadable file.
    """
    path = Path(path)
    suffix = recording_suffix(path)
    table = _read_csv(path) if suffix == ".csv" else parquet_table(path)
    headers = [_header(*_split(name.strip())) for name in table.column_names]
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
        channels[column.channel].reshape(n_times, -1)[:, column.number] = numbers(column.header)
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


def _read_csv(path: Path) -> Any:
    """An Arrow table with all cells as text, so that a bad one can be shown as written."""
    check_arrow(path)
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    content = content_of(path)
    try:
        header = next(csv.reader(io.StringIO(content.decode())), [])
    except csv.Error as error:  # a cell longer than csv.field_size_limit
        raise BadRecordingFile(f"{path}, line 1: {error}; write files with save_virtual_recording") from None
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
            f"{path}, line {row[1]}: {counted(int(row[3]), 'cell')} under {counted(int(row[2]), 'header')}; "
            "complete the line or leave it out"
        ) from error
