"""The formats that are read, with sound files to damage: what stands in them, and who reads them twice."""

from __future__ import annotations

import copy
import gzip
import random
import sqlite3
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from inspected.sample import CLEAN
from lxml import etree
from mutants import constraint_readings, log_readings, readings
from mutants.material import RICH
from mutants.of_arrays import ON_ARRAYS
from mutants.of_bytes import ANYWHERE, ON_BYTES, ON_LINES
from mutants.of_tokens import ON_TOKENS
from mutants.of_trees import ON_TREES
from mutants.outcomes import Trial
from mutants.readings import Reading
from mutants.trial import trial as robot_trial

import urdf
from crosscheck.recordings import load_virtual_recording
from crosscheck.study.store import opened

Damaged = tuple[tuple[str, ...], bytes]
"""What was done to a file, in order, and its bytes."""

SPREAD = ((1, 0), (1, 0), (1, 0), (2, 0), (3, 0), (0, 1), (0, 2), (1, 1))
"""Numbers of faults in what a file says and in its bytes, as often as they are drawn."""


@dataclass(frozen=True)
class Format:
    """suffix: of its files; sound: files without faults; damaged: one with one to three; trial: what becomes of it"""

    suffix: str
    sound: Sequence[Callable[[], bytes]]
    damaged: Callable[[random.Random], Damaged]
    trial: Callable[[Path], Trial]


def done(
    rng: random.Random, faults: Mapping[str, Callable[..., Any]], count: int, content: Any
) -> tuple[list[str], Any]:
    """So many faults, one after the other; those that answer nothing change the content in place."""
    kinds = rng.choices(list(faults), k=count)
    for kind in kinds:
        found = faults[kind](rng, content)
        content = content if found is None else found
    return kinds, content


def of_text(suffix: str, text: Callable[[], bytes], reading: Reading) -> Format:
    def damaged(rng: random.Random) -> Damaged:
        in_tokens, in_bytes = rng.choice(SPREAD)
        kinds, content = done(rng, ON_TOKENS, in_tokens, text())
        more, content = done(rng, {**ANYWHERE, **ON_LINES}, in_bytes, content)
        return (*kinds, *more), content

    return Format(suffix, [text], damaged, reading.trial)


def of_xml(suffix: str, texts: Sequence[Callable[[], bytes]], trial: Callable[[Path], Trial]) -> Format:
    """Three in four have faults in their elements and attributes, the others (too) in their bytes."""
    tree = cache(lambda text: etree.fromstring(text()))

    def damaged(rng: random.Random) -> Damaged:
        text = rng.choice(texts)
        in_tree, in_bytes = rng.choice(SPREAD)
        kinds, content = [], text()
        if in_tree:
            kinds, root = done(rng, ON_TREES, in_tree, copy.deepcopy(tree(text)))
            content = etree.tostring(root.getroottree(), encoding="UTF-8")
        more, content = done(rng, ON_BYTES, in_bytes, content)
        return (*kinds, *more), content

    return Format(suffix, texts, damaged, trial)


def of_arrays(
    suffix: str, arrays: Callable[[], dict[str, Any]], written: Callable[[Path, dict[str, Any]], None], reading: Reading
) -> Format:
    """Arrays that the format cannot hold are damaged in their bytes alone."""

    def content_of(changed: dict[str, Any]) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, f"x{suffix}")
            written(path, changed)
            return path.read_bytes()

    sound = cache(lambda: content_of(arrays()))

    def damaged(rng: random.Random) -> Damaged:
        in_arrays, in_bytes = rng.choice(SPREAD)
        kinds, changed = done(rng, ON_ARRAYS, in_arrays, dict(arrays()))
        try:
            content = content_of(changed) if in_arrays else sound()
        except Exception:  # whatever the writer says
            kinds, content, in_bytes = [], sound(), max(in_bytes, 1)
        more, content = done(rng, ANYWHERE, in_bytes, content)
        return (*kinds, *more), content

    return Format(suffix, [sound], damaged, reading.trial)


def of_bytes(suffix: str, content: Callable[[], bytes], reading: Reading) -> Format:
    def damaged(rng: random.Random) -> Damaged:
        kinds, changed = done(rng, ANYWHERE, rng.choice([1, 1, 2, 3]), content())
        return tuple(kinds), changed

    return Format(suffix, [content], damaged, reading.trial)


# Sound files

ROBOTS = ("kr500", "clean", "rich", "rich", "rich", "ur5")


@cache
def robot(name: str) -> bytes:
    """A robot's file without faults."""
    if name in ("clean", "rich"):
        return {"clean": CLEAN, "rich": RICH}[name].encode()
    return next(entry.path for entry in urdf.robots() if entry.name == name).read_bytes()


@cache
def recorded() -> dict[str, Any]:
    t = np.arange(40) / 100
    q = np.column_stack([0.3 * np.sin(5 * t), 0.2 + 0.1 * np.cos(7 * t)])
    v = np.column_stack([1.5 * np.cos(5 * t), -0.7 * np.sin(7 * t)])
    tau = np.column_stack([3.0 - 2.0 * np.sin(5 * t), 1.0 + 0.25 * np.cos(7 * t)])
    return {"t": t, "q": q, "v": v, "tau": tau}


@cache
def recording_csv() -> bytes:
    names = ["time [s]", *(f"{name}_{k}" for name in ("q", "v", "tau") for k in (1, 2))]
    arrays = recorded()
    rows = np.column_stack([arrays["t"], arrays["q"], arrays["v"], arrays["tau"]]).round(9).tolist()
    return "\n".join([",".join(names), *(",".join(map(repr, row)) for row in rows), ""]).encode()


def write_npz(path: Path, arrays: dict[str, Any]) -> None:
    np.savez(path, **arrays)


def write_mat(path: Path, arrays: dict[str, Any]) -> None:
    from scipy.io import savemat

    savemat(path, arrays)


def write_mat73(path: Path, arrays: dict[str, Any]) -> None:
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in arrays.items():
            file[name] = values.T
    content = b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM"
    path.write_bytes(content + path.read_bytes()[len(content) :])


def write_parquet(path: Path, arrays: dict[str, Any]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    columns = {}
    for name, values in arrays.items():
        wide = values.ndim == 2 and values.shape[1] == 2
        columns |= {f"{name}_{k + 1}": values[:, k] for k in (0, 1)} if wide else {name: values.tolist()}
    parquet.write_table(pa.table(columns), path)


@cache
def bag(ending: str) -> bytes:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    state, header, stamp = (
        store.types[name]
        for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    arrays = recorded()
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent, "bag")
        plugin = StoragePlugin.MCAP if ending == ".mcap" else StoragePlugin.SQLITE3
        with Writer(folder, version=9, storage_plugin=plugin) as writer:
            connection = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
            for k, (q, v, tau) in enumerate(zip(arrays["q"], arrays["v"], arrays["tau"], strict=True)):
                time = 1_700_000_000 * 10**9 + k * 10**7
                when = stamp(sec=time // 10**9, nanosec=time % 10**9)
                message = state(header(when, "base"), list(readings.JOINTS), q, v, tau)
                writer.write(connection, time + 10**6, store.serialize_cdr(message, state.__msgtype__))
        (file,) = folder.glob(f"*{ending}")
        return file.read_bytes()


@cache
def motion(suffix: str) -> bytes:
    from crosscheck.exciting.motion_formats.krl import AxisSettings
    from crosscheck.exciting.motion_formats.motion_file import document, slides
    from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
    from graphdyn.excitation import FourierBasis, Trajectory

    model = readings.arm()
    coefficients = 0.3 * np.random.default_rng(0).normal(size=(model.nv, 5))
    course = Trajectory(FourierBasis(1.0, 3), coefficients)
    timed = TimedMotion.of(course, model.independent_joints, slides(model), 20)
    return document(timed, Path(f"motion{suffix}"), AxisSettings())


IDS = (100000000001, 234567890123, 999999999998)


@cache
def answered() -> dict[str, Any]:
    return {"id": np.array(IDS), "answer": np.random.default_rng(0).normal(size=(3, 4))}


def answers_csv() -> bytes:
    rows = zip(IDS, answered()["answer"].tolist(), strict=True)
    return "\n".join(["id,answer", *(f"{i}," + ",".join(map(repr, row)) for i, row in rows), ""]).encode()


def answers_json() -> bytes:
    rows = zip(IDS, answered()["answer"].tolist(), strict=True)
    lines = ",\n".join(f'  {{"id": {i}, "answer": [{row[:2]}, {row[2:]}]}}' for i, row in rows)
    return f"[\n{lines}\n]\n".encode()


MAPPING = b"""\
joints = ["joint_1", "joint_2"]
rate = 250.0
decimal = ","
delimiter = ";"

[q]
columns = ["Achse 1 [Grad]", "Achse 2 [Grad]"]
unit = "deg"
side = "motor"
sign = [1, -1]
offset = [0.5, -90.0]
offset_unit = "deg"

[v]
columns = "speed_{number}"
unit = ["rad/s", "deg/s"]

[tau]
columns = [5, 6]
unit = "A"
gain = [12.5, 7.25]

[transmission]
ratio = [100.0, 101.0]
"""

STUDY = b"""\
[study]
seed = 3
runs = 2
methods = ["wls", "ols", "iv"]

[robot]
name = "ur5"
viscous = [14, 14, 8, 3, 2.5]
coulomb = 0.5
locked = ["wrist_3_joint"]
rotor_inertia = 0.2
position_gain = 400.0
velocity_gain = [30, 30, 15, 4, 4]

[errors]
payload_center = [0.01, 0, 0.2]

[scenario]
motion = "steps"
duration = 10
sampling_rate = 200
control_rate = 200.0
cutoff = 20
torque_noise = 0.01

[[grid]]
position_noise = [1e-6, 1e-5]

[[grid]]
torque_noise = [0.05, 0.1]  # N m
motion_seed = 7
"""

MODELS = b"""\
[plain]
terms = ["viscous", "coulomb"]

[gears]
terms = ["viscous", {term = "coulomb", width = 0.05}, "offset"]
methods = ["wls", {method = "pullback", strength = 1e6}]
known_bodies = false
expected = {IA_3 = [764, 80]}
noise = [40, 60, 60, 10, 10, 8]
"""

STATE = b'{"q": [0.1, -0.25, 1e-3], "v": [0, 2.5, -1]}\n'

SRDF = b"""\
<?xml version="1.0"?>
<!-- of the arm -->
<robot name="arm">
  <group name="arm"><chain base_link="base" tip_link="tool"/></group>
  <disable_default_collisions link="tool"/>
  <enable_collisions link1="tool" link2="base"/>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="fore" reason="Adjacent"/>
  <disable_collisions link1="fore" link2="hand" reason="Never"/>
</robot>
"""

LOOPS = b"""\
# of a five-bar
closed_loop: [['left_a', 'left_b'], [right_a, right_b]]
type: ['6d', 3d]
name_mot: ['mot1', 'mot2']
"""


LOOPED = b"""\
<?xml version="1.0"?>
<robot name="four_bar">
  <link name="base"/>
  <link name="crank"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="rod"><inertial><mass value="2"/>
    <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2"/></inertial></link>
  <link name="rocker"><inertial><mass value="3"/>
    <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.3"/></inertial></link>
  <joint name="a" type="continuous" independent="true">
    <parent link="base"/><child link="crank"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous" independent="false">
    <origin xyz="0.5 0 0"/><parent link="crank"/><child link="rod"/><axis xyz="0 0 1"/></joint>
  <joint name="c" type="continuous" independent="false">
    <origin xyz="1 0 0"/><parent link="base"/><child link="rocker"/><axis xyz="0 0 1"/></joint>
  <loop name="l" type="revolute">
    <predecessor link="rod"><origin xyz="1.0 0 0"/></predecessor>
    <successor link="rocker"><origin xyz="0.5 0 0"/></successor>
    <axis xyz="0 0 1"/>
  </loop>
</robot>
"""

JOINED = b"""\
<?xml version="1.0"?>
<robot name="arms" xmlns:drake="http://drake.mit.edu">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="fore"><inertial><mass value="2"/>
    <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2"/></inertial></link>
  <link name="crank"><inertial><mass value="3"/>
    <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.3"/></inertial></link>
  <link name="rod"><inertial><mass value="1"/>
    <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.3"/></inertial></link>
  <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous">
    <origin xyz="0.5 0 0"/><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/></joint>
  <joint name="c" type="continuous">
    <origin xyz="1 0 0"/><parent link="base"/><child link="crank"/><axis xyz="0 0 1"/></joint>
  <joint name="d" type="continuous" independent="false">
    <origin xyz="0 0 0.5"/><parent link="crank"/><child link="rod"/><axis xyz="0 1 0"/></joint>
  <coupling name="gear"><predecessor link="fore"/><successor link="rod"/><ratio value="2"/></coupling>
  <loop_joint name="hinge" type="continuous">
    <link1 link="fore" xyz="0.5 0 0" rpy="0.1 0 0.2"/><link2 link="crank"/><axis xyz="0 0.6 0.8"/></loop_joint>
  <constraint name="slide" type="prismatic_joint"><parent link="upper"/><parent_origin xyz="0.5 0 0" rpy="0 0 1"/>
    <child link="crank"/><child_origin xyz="0 0.25 0"/><parent_axis xyz="0 0 1"/></constraint>
  <drake:ball_constraint name="ball">
    <drake:ball_constraint_body_A name="upper"/><drake:ball_constraint_body_B name="base"/>
    <drake:ball_constraint_p_AP value="0 0 0"/><drake:ball_constraint_p_BQ value="0 0 0"/>
  </drake:ball_constraint>
</robot>
"""

XACRO = b"""\
<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="mass" value="2.5"/>
  <xacro:arg name="long" default="true"/>
  <xacro:macro name="link" params="name factor:=1">
    <link name="${name}"><inertial><origin xyz="0 0 ${0.1 * factor}"/><mass value="${mass * factor}"/>
      <inertia ixx="${0.1 * factor}" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  </xacro:macro>
  <link name="base"/>
  <xacro:link name="upper"/>
  <xacro:if value="$(arg long)"><xacro:link name="fore" factor="0.5"/></xacro:if>
  <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous">
    <origin xyz="0 0 ${2 * 0.3}"/><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/></joint>
</robot>
"""


@cache
def study_store() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "study.sqlite")
        with opened(path) as store:
            store.begin(readings.INPUTS)
            for key, outcome in readings.stored().items():
                store.add(key, outcome)
        with closing(sqlite3.connect(path)) as connection:
            connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            connection.execute("PRAGMA journal_mode = DELETE")
        return path.read_bytes()


FEW = 5
"""Quantities of a sweep's record, of which each is damaged alike."""


@cache
def sweep() -> bytes:
    import crosscheck
    from crosscheck.commands.crosscheck.record import robot_record, sweep_record
    from crosscheck.report.records.record import as_bytes, plain

    record = plain(robot_record(crosscheck.compare(str(readings.urdf_file()), 1, 0)))
    record["quantities"] = dict(list(record["quantities"].items())[:FEW])
    return as_bytes(plain(sweep_record([record], [], [], ["crosscheck"])))


def cube() -> Any:
    from trimesh import creation

    return creation.box((0.2, 0.1, 0.4))


@cache
def mesh(kind: str) -> bytes:
    found = cube().export(file_type=kind)
    return found.encode() if isinstance(found, str) else found


@cache
def collada() -> bytes:
    from robots.mesh_files import collada as document

    return document(cube(), color="<color>1 0 0 1</color>").encode()


def recorded_in(second: Callable[[Path], readings.Numbers]) -> Reading:
    return Reading(readings.recording, readings.recording_fault(second))


def moved_by(second: Callable[[Path], tuple[Any, Any]]) -> Reading:
    return Reading(readings.motion, readings.motion_fault(second))


def answered_in(second: Callable[[Path], Any]) -> Reading:
    return Reading(readings.answers, readings.answers_fault(second))


def shown_by(second: Callable[[Path], Any]) -> Reading:
    return Reading(readings.mesh, readings.mesh_fault(second))


def write_lists(path: Path, arrays: dict[str, Any]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    parquet.write_table(pa.table({name: values.tolist() for name, values in arrays.items()}), path)


def of_compressed(suffix: str, text: Callable[[], bytes], reading: Reading) -> Format:
    """Damaged before it is compressed, afterwards, or both."""
    sound = cache(lambda: gzip.compress(text(), mtime=0))

    def damaged(rng: random.Random) -> Damaged:
        in_text, in_bytes = rng.choice(SPREAD)
        kinds, content = done(rng, {**ON_TOKENS, **ON_LINES}, in_text, text())
        more, content = done(rng, ANYWHERE, in_bytes, gzip.compress(content, mtime=0))
        return (*kinds, *more), content

    return Format(suffix, [sound], damaged, reading.trial)


METADATA = b"""\
rosbag2_bagfile_information:
  version: 9
  storage_identifier: sqlite3
  duration: {nanoseconds: 390000000}
  starting_time: {nanoseconds_since_epoch: 1700000000001000000}
  message_count: 40
  topics_with_message_count:
    - topic_metadata:
        name: /joint_states
        type: sensor_msgs/msg/JointState
        serialization_format: cdr
        offered_qos_profiles: []
        type_description_hash: ''
      message_count: 40
  compression_format: ''
  compression_mode: ''
  relative_file_paths: [messages.db3]
  files:
    - path: messages.db3
      starting_time: {nanoseconds_since_epoch: 1700000000001000000}
      duration: {nanoseconds: 390000000}
      message_count: 40
  custom_data: {}
  ros_distro: rosbags
"""


@cache
def old_bag() -> bytes:
    """A bag of ROS 1."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    state, header, stamp = (
        store.types[name]
        for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    arrays = recorded()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "x.bag")
        with Writer(file) as writer:
            connection = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
            for k, (q, v, tau) in enumerate(zip(arrays["q"], arrays["v"], arrays["tau"], strict=True)):
                time = 1_700_000_000 * 10**9 + k * 10**7
                when = stamp(sec=time // 10**9, nanosec=time % 10**9)
                message = state(header(k, when, "base"), list(readings.JOINTS), q, v, tau)
                writer.write(connection, time + 10**6, store.serialize_ros1(message, state.__msgtype__))
        return file.read_bytes()


@cache
def exact(suffix: str) -> bytes:
    from crosscheck.recordings.virtual import virtual_recording_document

    return virtual_recording_document(log_readings.exact(), Path(f"x{suffix}"), {})


SPOKEN = b"0.25 -1.5e-3\n1, 2.5\nerror: no answer at this state\n"

SPOKEN_JSON = b"""\
{"id": 1, "answer": [0.25, -1.5e-3]}
{"id": 2, "answer": [[1], [2.5]]}
{"id": 3, "error": "no answer at this state"}
"""

WRITTEN_FOLDER = b'{"format": "graphdyn vectors 1", "files": ["model.json", "inverse_dynamics.csv"]}\n'

METADATA_FILE = (partial(bag, ".db3"), "messages.db3")
LOADED_WHOLE = log_readings.pieces_fault

FORMATS: dict[str, Format] = {
    "urdf": of_xml(".urdf", [partial(robot, name) for name in ROBOTS], robot_trial),
    "recording csv": of_text(".csv", recording_csv, recorded_in(readings.csv_columns)),
    "recording npz": of_arrays(".npz", recorded, write_npz, recorded_in(readings.npz_columns)),
    "recording parquet": of_arrays(".parquet", recorded, write_parquet, recorded_in(readings.parquet_columns)),
    "recording mat": of_arrays(".mat", recorded, write_mat, recorded_in(readings.mat_columns)),
    "recording mat 7.3": of_arrays(".mat", recorded, write_mat73, recorded_in(readings.mat73_columns)),
    "recording mcap": of_bytes(".mcap", lambda: bag(".mcap"), recorded_in(readings.bag_columns)),
    "recording db3": of_bytes(".db3", lambda: bag(".db3"), recorded_in(readings.bag_columns)),
    "recording bag": of_bytes(".bag", old_bag, recorded_in(readings.bag_columns)),
    "recording csv.gz": of_compressed(".csv.gz", recording_csv, recorded_in(log_readings.compressed_columns)),
    "bag folder": of_text("metadata.yaml", lambda: METADATA, Reading(
        log_readings.folder_recording(*METADATA_FILE),
        readings.recording_fault(log_readings.folder_columns(*METADATA_FILE)),
    )),
    "exact csv": of_text(".csv", lambda: exact(".csv"), Reading(
        load_virtual_recording, log_readings.exact_fault(log_readings.exact_csv)
    )),
    "exact parquet": of_bytes(".parquet", lambda: exact(".parquet"), Reading(
        load_virtual_recording, log_readings.exact_fault(log_readings.exact_parquet)
    )),
    "stream csv": of_text(".csv", recording_csv, Reading(log_readings.streamed, LOADED_WHOLE)),
    "stream parquet": of_arrays(".parquet", recorded, write_parquet, Reading(log_readings.streamed, LOADED_WHOLE)),
    "parts parquet": of_arrays(".parquet", recorded, write_parquet, Reading(log_readings.partitioned, LOADED_WHOLE)),
    "mapping": of_text(".toml", lambda: MAPPING, Reading(readings.mapping, readings.mapping_fault)),
    "motion csv": of_text(".csv", lambda: motion(".csv"), moved_by(readings.csv_motion)),
    "motion yaml": of_text(".yaml", lambda: motion(".yaml"), moved_by(readings.yaml_motion)),
    "motion urscript": of_text(".script", lambda: motion(".script"), moved_by(readings.urscript_motion)),
    "motion krl": of_text(".src", lambda: motion(".src"), moved_by(readings.krl_motion)),
    "answers csv": of_text(".csv", answers_csv, answered_in(readings.csv_answers)),
    "answers json": of_text(".json", answers_json, answered_in(readings.json_answers)),
    "answers npz": of_arrays(".npz", answered, write_npz, answered_in(readings.npz_answers)),
    "answers parquet": of_arrays(
        ".parquet", answered, write_lists,
        answered_in(readings.parquet_answers),
    ),
    "answers spoken": of_text(".txt", lambda: SPOKEN, Reading(
        readings.spoken("plain"), readings.spoken_fault(readings.spoken_numbers)
    )),
    "answers spoken json": of_text(".txt", lambda: SPOKEN_JSON, Reading(
        readings.spoken("json"), readings.spoken_fault(readings.spoken_json)
    )),
    "vectors": of_text(".json", lambda: WRITTEN_FOLDER, Reading(
        readings.written_folder, readings.written_folder_fault
    )),
    "study": of_text(".toml", lambda: STUDY, Reading(readings.study, readings.study_fault)),
    "models": of_text(".toml", lambda: MODELS, Reading(readings.models, readings.models_fault)),
    "study store": of_bytes(
        ".sqlite", study_store, Reading(readings.study_store, readings.study_store_fault)
    ),
    "sweep": of_text(".json", sweep, Reading(readings.sweep, readings.sweep_fault)),
    "urdf with loops": of_xml(
        ".urdf",
        [lambda: LOOPED, lambda: JOINED],
        Reading(constraint_readings.joined, constraint_readings.joined_fault).trial,
    ),
    "urdf updated": of_xml(
        ".urdf", [partial(robot, name) for name in ROBOTS], Reading(readings.updated, readings.updated_fault).trial
    ),
    "xacro": of_xml(".xacro", [lambda: XACRO], Reading(readings.xacro, readings.xacro_fault).trial),
    "state": of_text(".json", lambda: STATE, Reading(readings.state, readings.state_fault)),
    "srdf": of_xml(".srdf", [lambda: SRDF], Reading(readings.srdf, readings.srdf_fault).trial),
    "loops": of_text(".yaml", lambda: LOOPS, Reading(readings.loop_yaml, readings.loop_yaml_fault)),
    "mesh stl": of_bytes(".stl", lambda: mesh("stl"), shown_by(readings.binary_stl)),
    "mesh stl text": of_text(".stl", lambda: mesh("stl_ascii"), shown_by(readings.ascii_stl)),
    "mesh obj": of_text(".obj", lambda: mesh("obj"), shown_by(readings.obj)),
    "mesh dae": of_text(".dae", collada, shown_by(readings.collada)),
}  # fmt: skip
"""By the name in tables."""
