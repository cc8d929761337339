"""Virtual recordings, with every channel of joints and bodies, in CSV and Parquet files, one row per time.

Each column is one number, named after joint or body, with the unit in the header. For joint O1 and body B1: robot (its
name, in every row); time [s]; O1.q [rad], O1.v [rad/s], O1.a [rad/s^2], O1.tau [N m] (in m, m/s, m/s^2, N for a
prismatic joint); and in world axes B1.alpha [rad], B1.r_x [m], B1.r_ddot_x [m/s^2], B1.omega_x [rad/s],
B1.omega_dot_x [rad/s^2], B1.F_x [N], B1.M_x [N m], with all components.
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from crosscheck.recordings.arrow import check_arrow
from graphdyn import InvalidInput, Simulation, VirtualRecording
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
    check_arrow(path)
    import pyarrow as pa
    from pyarrow import csv as arrow_csv
    from pyarrow import parquet

    if not isinstance(recording, VirtualRecording):
        raise InvalidInput(
            f"{path}: the robot has loops, and joint forces that nothing determines have no place in this table; "
            "write .npz or .mcap"
        )
    suffix = recording_suffix(path)
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


def _flat(channel: Array) -> Array:
    """A channel (N, n) or (N, n, 3) with one column per number."""
    return channel.reshape(len(channel), -1)


def recording_suffix(path: Path) -> str:
    if path.suffix.lower() not in FIRST_ROW:
        raise InvalidInput(f"{path}: a recording is saved as .csv or .parquet, not as '{path.suffix}'; rename the file")
    return path.suffix.lower()
