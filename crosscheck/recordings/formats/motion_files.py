"""A simulated motion as a file of recordings: Parquet, CSV, .npz, or a bag in MCAP.

load_recording reads all of them. Parquet and CSV have every channel of a virtual recording, .npz those of the joints.
An MCAP bag has the messages that a robot publishes, sensor_msgs/JointState, which have no place for accelerations and
constraint forces. Parquet, .npz and MCAP carry metadata, such as the URDF; CSV has no place for them.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

import numpy as np

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.bag_files import JOINT_STATE
from crosscheck.recordings.formats.virtual_recording_files import virtual_recording_document
from graphdyn import InvalidInput, VirtualRecording
from graphdyn.layout import Array

SUFFIXES = (".parquet", ".csv", ".npz", ".mcap")

TOPIC = "/joint_states"

NANOSECONDS = 10**9


class RecordedMotion(Protocol):
    """What every file has: a VirtualRecording, or a Simulation."""

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


def motion_document(recording: RecordedMotion, path: Path, metadata: Mapping[str, str]) -> bytes:
    """The content of a file of this name. Raises InvalidInput for another suffix; BadRecordingFile without rosbags.

    Parquet and CSV take a VirtualRecording alone.
    """
    suffix = path.suffix.lower()
    if suffix == ".npz":
        return _npz(recording, metadata)
    if suffix == ".mcap":
        return _mcap(recording, path, metadata)
    if suffix not in SUFFIXES:
        raise InvalidInput(f"{path}: a motion is written as {', '.join(SUFFIXES)}, not as '{path.suffix}'")
    if not isinstance(recording, VirtualRecording):
        raise InvalidInput(
            f"{path}: the robot has loops, and joint forces that nothing determines have no place in this table; "
            "write .npz or .mcap"
        )
    return virtual_recording_document(recording, path, metadata)


def _npz(recording: RecordedMotion, metadata: Mapping[str, str]) -> bytes:
    """Arrays t, q, v, a, tau, and the metadata as texts."""
    sink = io.BytesIO()
    texts = {name: np.array(text) for name, text in metadata.items()}
    channels = {"t": recording.time, "q": recording.q, "v": recording.v, "a": recording.a, "tau": recording.tau}
    arrays: dict[str, Any] = {"joint_names": np.array(recording.joint_names), **channels, **texts}
    np.savez_compressed(sink, **arrays)
    return sink.getvalue()


def _mcap(recording: RecordedMotion, path: Path, metadata: Mapping[str, str]) -> bytes:
    """Joint states with the time of the simulation as stamp, whole nanoseconds."""
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise BadRecordingFile(f"{path}: to write MCAP, install graphdyn with its extra 'rosbag'") from error
    store = get_typestore(Stores.ROS2_HUMBLE)
    state, header, stamp = (
        store.types[name] for name in (JOINT_STATE, "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    names = list(recording.joint_names)
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        with Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            for name, text in metadata.items():
                writer.set_custom_data(name, text)
            connection = writer.add_connection(TOPIC, JOINT_STATE, typestore=store)
            for row, time in enumerate(np.round(recording.time * NANOSECONDS).astype(np.int64).tolist()):
                seconds, rest = divmod(time, NANOSECONDS)
                channels = (np.ascontiguousarray(part[row]) for part in (recording.q, recording.v, recording.tau))
                message = state(header(stamp(sec=seconds, nanosec=rest), ""), names, *channels)
                writer.write(connection, time, store.serialize_cdr(message, JOINT_STATE))
        (file,) = bag.glob("*.mcap")
        return file.read_bytes()
