"""ROS bags and MCAP files: the sensor_msgs/JointState messages of one topic."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from crosscheck.recordings.errors import AmbiguousColumns, BadRecordingFile, RecordingFinding
from crosscheck.recordings.formats.format import Format, refusing_damage
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import RecordedTable, in_words
from crosscheck.recordings.virtual import RecordedMotion
from graphdyn.errors import counted, not_installed
from urdf.document import refuse_growing_yaml

JOINT_STATE = "sensor_msgs/msg/JointState"
FIELDS = ("position", "velocity", "effort")

JOINT_STATES_TOPIC = "/joint_states"

NANOSECONDS_PER_SECOND = 10**9


def read_bag(path: Path, topic: str | None = None, joints: tuple[str, ...] | None = None) -> RecordedTable:
    """Read 'time' [s] since the first message (header stamp), 'receive_time', and 'position.<joint>' and so on.

    joints: read only the messages that have all of these. Raises BadRecordingFile, AmbiguousColumns.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise BadRecordingFile(f"{path}: {not_installed('rosbags', 'rosbag')}") from error
    with ExitStack() as opened:
        opened.enter_context(refusing_damage(path, "bag", "record it again, or give the whole folder"))
        if path.is_dir():
            refuse_growing_yaml((path / "metadata.yaml").read_bytes())
        reader = opened.enter_context(AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)))
        connections = [c for c in reader.connections if c.msgtype == JOINT_STATE]
        topic = _topic(path, sorted({c.topic for c in connections}), topic)
        wanted = [c for c in connections if c.topic == topic]
        messages = [
            (received, reader.deserialize(raw, connection.msgtype))
            for connection, received, raw in reader.messages(wanted)
        ]
        if not messages:
            raise BadRecordingFile(f"{path}: no messages on {topic}; record at least one")
        return _table(path, topic, messages, joints)


def _topic(path: Path, topics: list[str], wanted: str | None) -> str:
    listed = in_words(topics)
    if not topics:
        raise BadRecordingFile(f"{path}: no topic of type {JOINT_STATE}; record the joint states")
    if wanted is not None and wanted not in topics:
        raise BadRecordingFile(f"{path}: no {JOINT_STATE} on the topic {wanted!r}; there are: {listed}")
    if wanted is None and len(topics) > 1:
        raise AmbiguousColumns(
            f"{path}: joint states on {len(topics)} topics: {listed}; name one: topic = … in a mapping, "
            "or --topic of graphdyn recording"
        )
    return wanted or topics[0]


def _table(path: Path, topic: str, messages: list[tuple[int, Any]], joints: tuple[str, ...] | None) -> RecordedTable:
    findings = []
    sets = dict.fromkeys(frozenset(message.name) for _, message in messages)
    if joints is None:
        if len(sets) > 1:
            listed = "; ".join(in_words(sorted(names)) for names in sets)
            raise AmbiguousColumns(
                f"{path}: messages on {topic} name different joints: {listed}; say which: joints = […]"
            )
        joints = tuple(messages[0][1].name)
    have = [set(joints) <= set(message.name) for _, message in messages]
    if not any(have):
        listed = in_words(sorted(frozenset.union(*sets)))
        raise AmbiguousColumns(
            f"{path}: no message on {topic} has all of {in_words(joints)}; there are: {listed}; "
            "say in a mapping (docs/recordings.md) which is which"
        )
    if not all(have):
        text = f"{counted(have.count(False), 'message')} on {topic} without all of {in_words(joints)}"
        findings.append(RecordingFinding("other-joints", "note", str(path), None, (), text, "they are left out"))
        messages = [message for message, has in zip(messages, have, strict=True) if has]
    stamps = np.array([m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in messages], dtype=np.int64)
    received = np.array([time for time, _ in messages], dtype=np.int64)
    if not stamps.any():
        text = f"the messages on {topic} have no header stamps"
        findings.append(
            RecordingFinding("no-stamps", "warning", str(path), "time", (), text, "the times of receiving are used")
        )
        stamps = received
    names, columns = ["time", "receive_time"], [(stamps - stamps[0]) * 1e-9, (received - received[0]) * 1e-9]
    for field in FIELDS:
        rows = [_in_order(message, field, joints) for _, message in messages]
        if any(row is not None for row in rows):
            names += [f"{field}.{joint}" for joint in joints]
            missing = np.full(len(joints), np.nan)
            columns += list(np.array([missing if row is None else row for row in rows]).T)
    return RecordedTable(path, tuple(names), np.column_stack(columns), findings=tuple(findings), in_si=True)


def _in_order(message: Any, field: str, joints: tuple[str, ...]) -> Any:
    """The numbers of these joints; None if the message leaves the field empty."""
    values, names = getattr(message, field), list(message.name)
    return values[[names.index(joint) for joint in joints]] if len(values) == len(names) else None


def write_mcap(recording: RecordedMotion, path: Path, metadata: Mapping[str, str]) -> bytes:
    """A bag of joint states, stamped with the time of the simulation in whole nanoseconds."""
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise BadRecordingFile(f"{path}: {not_installed('rosbags', 'rosbag')}") from error
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
            connection = writer.add_connection(JOINT_STATES_TOPIC, JOINT_STATE, typestore=store)
            for row, time in enumerate(np.round(recording.time * NANOSECONDS_PER_SECOND).astype(np.int64).tolist()):
                seconds, rest = divmod(time, NANOSECONDS_PER_SECOND)
                channels = (np.ascontiguousarray(part[row]) for part in (recording.q, recording.v, recording.tau))
                message = state(header(stamp(sec=seconds, nanosec=rest), ""), names, *channels)
                writer.write(connection, time, store.serialize_cdr(message, JOINT_STATE))
        (file,) = bag.glob("*.mcap")
        return file.read_bytes()


def _read(path: Path, mapping: ColumnMapping | None, joints: tuple[str, ...] | None) -> RecordedTable:
    return read_bag(path, mapping.topic if mapping else None, _joints_of_messages(mapping) or joints)


def _joints_of_messages(mapping: ColumnMapping | None) -> tuple[str, ...] | None:
    """The joints as the messages call them, by the columns of positions; otherwise as the mapping calls them."""
    if mapping is None:
        return None
    columns = mapping.channels["q"].columns if "q" in mapping.channels else ()
    names = tuple(str(column).removeprefix("position.") for column in columns)
    return names if columns and all(str(column).startswith("position.") for column in columns) else mapping.joints


FORMATS = (Format((".mcap", ".bag", ".db3"), _read, write=write_mcap),)
