"""Virtual recordings, with every channel of joints and bodies, in CSV and Parquet files, one row per time.

Each column is one number, named after joint or body, with the unit in the header. For joint O1 and body B1: robot (its
name, in every row); time [s]; O1.q [rad], O1.v [rad/s], O1.a [rad/s^2], O1.tau [N m] (in m, m/s, m/s^2, N for a
prismatic joint); and in world axes B1.alpha [rad], B1.r_x [m], B1.r_ddot_x [m/s^2], B1.omega_x [rad/s],
B1.omega_dot_x [rad/s^2], B1.F_x [N], B1.M_x [N m], with all components.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crosscheck.recordings.errors import BadRecordingFile, quoted
from crosscheck.recordings.table import cells_of_column
from graphdyn import InvalidInput, Simulation, VirtualRecording
from graphdyn.errors import counted
from graphdyn.experiments import CHANNELS
from graphdyn.layout import Array
from urdf.document import write_whole

JOINT_UNITS = {"q": ("rad", "m"), "v": ("rad/s", "m/s"), "a": ("rad/s^2", "m/s^2"), "tau": ("N m", "N")}
"""Units of a joint's channels, for a revolute and a prismatic joint; the channel is its own symbol."""

BODY_CHANNEL_COLUMNS = {
    "cardano": ("rad", ("alpha", "beta", "gamma")),
    "position": ("m", ("r_x", "r_y", "r_z")),
    "acceleration": ("m/s^2", ("r_ddot_x", "r_ddot_y", "r_ddot_z")),
    "angular_velocity": ("rad/s", ("omega_x", "omega_y", "omega_z")),
    "angular_acceleration": ("rad/s^2", ("omega_dot_x", "omega_dot_y", "omega_dot_z")),
    "joint_forces": ("N", ("F_x", "F_y", "F_z")),
    "joint_moments": ("N m", ("M_x", "M_y", "M_z")),
}
"""Unit and symbols of the channels of a body."""

ROBOT, TIME = "robot", "time [s]"

_BODY_SYMBOLS = {symbol for _, symbols in BODY_CHANNEL_COLUMNS.values() for symbol in symbols}


class VirtualColumn(NamedTuple):
    """A column: its channel, and its index there, with the channel as an array (N, n) or (N, 3 n)."""

    label: str
    unit: str
    channel: str
    number: int

    @property
    def header(self) -> str:
        return f"{self.label} [{self.unit}]"


class Elements(NamedTuple):
    """Joint names, which of the joints are prismatic, body names (n,): joint j carries body j."""

    joint_names: tuple[str, ...]
    prismatic: tuple[bool, ...]
    body_names: tuple[str, ...]


def columns(elements: Elements) -> list[VirtualColumn]:
    """All columns after robot and time, in the order in which they are written."""
    of_joints = [
        VirtualColumn(f"{joint}.{symbol}", units[slides], symbol, j)
        for j, (joint, slides) in enumerate(zip(elements.joint_names, elements.prismatic, strict=True))
        for symbol, units in JOINT_UNITS.items()
    ]
    of_bodies = [
        VirtualColumn(f"{body}.{symbol}", unit, channel, 3 * i + k)
        for i, body in enumerate(elements.body_names)
        for channel, (unit, symbols) in BODY_CHANNEL_COLUMNS.items()
        for k, symbol in enumerate(symbols)
    ]
    return [*of_joints, *of_bodies]


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
            f"{path}, header: {counted(len(joints), 'joint')} ({', '.join(joints)}), "
            f"{counted(len(bodies), 'body', 'bodies')} ({', '.join(bodies)}); "
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
    missing = [f"{label} [{unit}]" if unit else label for label, unit in units.items() if label not in seen]
    if missing:
        names = f"column {missing[0]!r}" + (f" and {len(missing) - 1} more" if len(missing) > 1 else "")
        raise BadRecordingFile(f"{path}, header: without {names}; record every channel of every joint and body")


def _split(header: str) -> tuple[str, str]:
    """Label and unit of 'label [unit]'; a header without brackets has the unit ''."""
    found = re.fullmatch(r"(.*\S)\s*\[([^\[\]]*)\]", header, re.DOTALL)
    return (found[1], found[2]) if found else (header, "")


FIRST_ROW = {".csv": ("line", 2), ".parquet": ("row", 1)}
"""Name of a row in messages, and number of the first, per kind of file."""


RecordedMotion = VirtualRecording | Simulation
"""A motion that can be written."""


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
            f"{path}, line {row[1]}: {counted(int(row[3]), 'cell')} under {counted(int(row[2]), 'header')}; "
            "complete the line or leave it out"
        ) from error


def _read_parquet(path: Path) -> Any:
    import pyarrow as pa
    from pyarrow import parquet

    try:
        return parquet.read_table(pa.BufferReader(path.read_bytes()))
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise BadRecordingFile(f"{path}: not a readable Parquet file ({error}); save it again") from error
