"""Recordings in the formats that users bring: the same numbers from each, and what cannot be read is refused."""

import sys
from types import SimpleNamespace

import h5py
import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat

from crosscheck.recordings import (
    AmbiguousColumns,
    BadMapping,
    BadRecordingFile,
    inspect_recording,
    load_recording,
    mapping_of,
)
from crosscheck.recordings.formats.bag_files import write_mcap

N = 40
T = np.arange(N) * 0.01
Q = np.column_stack([np.sin(3 * T), 0.5 * np.cos(2 * T)])
V = np.column_stack([3 * np.cos(3 * T), -np.sin(2 * T)])
TAU = np.column_stack([5 + T, -2 * T])
NAMES = ["time [s]", "q_1 [rad]", "q_2 [rad]", "v_1 [rad/s]", "v_2 [rad/s]", "tau_1 [N m]", "tau_2 [N m]"]
TABLE = np.column_stack([T, Q, V, TAU])


def assert_whole(recording, tolerance=0.0):
    assert recording.joint_names == ("joint_1", "joint_2")
    for name, values in {"t": T, "q": Q, "v": V, "tau": TAU}.items():
        np.testing.assert_allclose(getattr(recording, name), values, rtol=tolerance, atol=tolerance)
    assert recording.a is None
    assert recording.rows.tolist() == list(range(N))


def text(delimiter, header=NAMES, table=TABLE):
    lines = [delimiter.join(header)] if header else []
    return "\n".join([*lines, *(delimiter.join(map(repr, row)) for row in table.tolist())]) + "\n"


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_delimited_text(tmp_path, delimiter, end):
    path = tmp_path / "r.csv"
    path.write_bytes(b"\xef\xbb\xbf" + text(delimiter).replace("\n", end).encode())
    assert_whole(load_recording(path))
    assert inspect_recording(path) == ()


def test_text_with_many_spaces(tmp_path):
    path = tmp_path / "r.txt"
    path.write_text(text("   ", header=["t", "q1", "q2", "v1", "v2", "tau1", "tau2"]))
    assert_whole(load_recording(path))


def test_names_in_the_comment_above_as_numpy_writes_them(tmp_path):
    path = tmp_path / "r.dat"
    np.savetxt(path, TABLE, header="made by hand\nt q1 q2 v1 v2 tau1 tau2", fmt="%.17g")
    assert_whole(load_recording(path))


def test_decimal_commas(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text(";").replace(".", ","))
    assert_whole(load_recording(path))
    (finding,) = inspect_recording(path)
    assert finding.text == f"{path}: the numbers have decimal commas; they are read with them [decimal-comma]"


def test_calendar_times_become_seconds(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(
        "time [s],q_1 [rad]\n2024-02-29 23:59:59.5,0.1\n2024-03-01 00:00:00.5,0.2\n2024-03-01 00:00:01.5,0.4\n"
    )
    assert load_recording(path).t.tolist() == [0.0, 1.0, 2.0]


def test_a_single_column_and_numbers_with_a_plus(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("q_1 [rad]\n+1.5\nx\n2\n3\n4\n")
    with pytest.raises(BadRecordingFile, match=r"row 1 \(line 3\): 'x' is not a finite number; repair"):
        load_recording(path, rate=10)
    assert load_recording(path, rate=10, drop=["not-a-number"]).q[:, 0].tolist() == [1.5, 2.0, 3.0, 4.0]


def test_text_after_the_first_megabyte(tmp_path):
    """Types of columns are guessed from the beginning of a file; a later cell of text must not end the reading."""
    path = tmp_path / "r.csv"
    path.write_text("t,q1\n" + "".join(f"{k},0.{k:020}\n" for k in range(60_000)) + "60000,broken\n")
    with pytest.raises(BadRecordingFile, match=r"'q1', row 60000 \(line 60002\): 'broken' is not a finite number"):
        load_recording(path)


def test_quoted_cells(tmp_path):
    (tmp_path / "r.csv").write_text('"t","q 1"\n"0","0.5"\n"1","0.25"\n')
    assert load_recording(tmp_path / "r.csv").q.tolist() == [[0.5], [0.25]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", r"r.csv: the file holds no table; record at least one row"),
        (b"# only a comment\n", r"r.csv: the file holds no table"),
        (b"t,q1\n", r"r.csv: no line below the header; record at least one row"),
        (b"t,q1\n0,\xff\n", r"r.csv, line 2: not UTF-8 text; save the file as CSV in UTF-8"),
        (b"t,q1\n0,\0\n", r"r.csv, line 2: a zero byte, so not text; save the file"),
        (b"t|q1\n0|1\n1|1\n", r"r.csv: no delimiter \(semicolon, tab, comma, space\) splits half of the first 3 lines"),
        (b't,q1\n0,"1\n1,2\n', r"r.csv: 1 row in 2 lines, so a quotation mark is not closed; remove it"),
        (b"t,q1\n0,1\n1," + b"2" * 3_000_000, r"r.csv, from line 2 on: straddling object .*; repair the file"),
        (b"t,q1\n0,1,2\n1,1,2\n2,1\n", r"2 of 3 lines do not have 2 cells like the first one \(line 2 has 3\); name"),
    ],
)
def test_what_is_no_table_of_text_is_refused(tmp_path, content, message):
    (tmp_path / "r.csv").write_bytes(content)
    with pytest.raises(BadRecordingFile, match=message):
        load_recording(tmp_path / "r.csv")


def test_a_delimiter_from_the_mapping(tmp_path):
    (tmp_path / "r.csv").write_text(text("|"))
    mapping = {"joints": ["a", "b"], "delimiter": "|", "time": {"column": 1}, "q": {"columns": [2, 3]}}
    assert np.array_equal(load_recording(tmp_path / "r.csv", mapping_of(mapping, "m")).q, Q)


def test_parquet(tmp_path):
    path = tmp_path / "r.parquet"
    parquet.write_table(pa.table({name: TABLE[:, k] for k, name in enumerate(NAMES)}), path)
    assert_whole(load_recording(path))
    wide = {"t": pa.array(T), "q": pa.array(Q.tolist()), "v": pa.array(V.tolist()), "tau": pa.array(TAU.tolist())}
    parquet.write_table(pa.table(wide), path)
    assert_whole(load_recording(path))
    stamps = pa.array((T * 1e6).astype(int), pa.timestamp("us"))
    parquet.write_table(pa.table(wide | {"t": stamps}), path)
    assert_whole(load_recording(path), tolerance=1e-15)
    path.write_bytes(b"PAR1")
    with pytest.raises(BadRecordingFile, match=r"r.parquet: not a readable Parquet file \(.*\); save it again"):
        load_recording(path)


def test_lists_of_different_lengths_are_no_columns(tmp_path):
    path = tmp_path / "r.parquet"
    parquet.write_table(pa.table({"t": [0.0, 1.0], "q": [[1.0], [1.0, 2.0]]}), path)
    mapping = mapping_of({"joints": ["a"], "time": {"column": "t"}, "q": {"columns": ["q"]}}, "m")
    with pytest.raises(BadMapping, match=r"m, \[q\]: 'q' of .* is not a column: lists of different lengths"):
        load_recording(path, mapping)


def test_npz(tmp_path):
    path = tmp_path / "r.npz"
    np.savez(path, t=T, q=Q, v=V.T, tau=TAU, note="a text", limits=np.ones(3), cube=np.ones((2, 2, 2)))
    assert_whole(load_recording(path))
    text = f"{path}: v: one column per time; transposed, so that each row is a time [turned-array]"
    assert text in [finding.text for finding in inspect_recording(path)]
    for name, reason in {
        "note": "it holds no numbers",
        "limits": r"its shape is \(3,\), most others have 40 rows",
        "cube": r"its shape is \(2, 2, 2\)",
    }.items():
        mapping = mapping_of({"joints": ["a"], "time": {"column": "t"}, "q": {"columns": [name]}}, "m")
        with pytest.raises(BadMapping, match=rf"'{name}' of .* is not a column: {reason}"):
            load_recording(path, mapping)


def test_archives_without_arrays_are_refused(tmp_path):
    path = tmp_path / "r.npz"
    np.savez(path, q=np.array([{}], dtype=object))
    with pytest.raises(BadRecordingFile, match=r"'q' is not an array of numbers; save it as one"):
        load_recording(path)
    np.savez(path, q="text")
    with pytest.raises(
        BadRecordingFile,
        match=r"r.npz: no arrays with one row per time \('q': it holds no numbers\); save t \(N,\) and",
    ):
        load_recording(path)
    path.write_bytes(b"PK nothing")
    with pytest.raises(BadRecordingFile, match=r"r.npz: not a readable .npz file \(.*\); save it with numpy.savez"):
        load_recording(path)


def test_stamps_of_bags_are_the_nearest_nanoseconds(tmp_path):
    """Of times in seconds, of which some are a little less than a whole number of nanoseconds as doubles."""
    times, values = np.arange(2000) / 1000, np.arange(4000.0).reshape(2000, 2) / 200
    assert np.any(times * 1e9 < 1_000_000 * np.arange(2000))
    written = SimpleNamespace(joint_names=("left", "right"), time=times, q=values, v=2 * values, tau=3 * values)
    path = tmp_path / "r.mcap"
    path.write_bytes(write_mcap(written, path, {}))
    recording = load_recording(path)
    assert np.round(recording.t * 1e9).astype(int).tolist() == [1_000_000 * k for k in range(2000)]
    for name, factor in (("q", 1), ("v", 2), ("tau", 3)):
        assert np.array_equal(recording.channel(name), factor * values)


def test_matlab(tmp_path):
    path = tmp_path / "r.mat"
    savemat(path, {"t": T, "q": Q, "v": V, "tau": TAU, "comment": "text"})
    assert_whole(load_recording(path))
    savemat(path, {"log": {"t": T, "joints": {"q": Q}}})
    mapping = {"joints": ["a", "b"], "time": {"column": "log.t"}, "q": {"columns": "log.joints.q_{number}"}}
    assert np.array_equal(load_recording(path, mapping_of(mapping, "m")).q, Q)
    path.write_bytes(b"no MATLAB")
    with pytest.raises(BadRecordingFile, match=r"r.mat: not a readable .mat file \(.*\); save it with save\('-v7'\)"):
        load_recording(path)


def write_mat73(path):
    """As MATLAB writes it: an HDF5 file behind a header of 512 bytes, axes turned round."""
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("log")
        for name, values in {"t": T[:, None], "q": Q, "v": V, "tau": TAU}.items():
            group[name] = values.T
        file.create_group("#refs#")
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM")


def test_matlab_7_3(tmp_path):
    path = tmp_path / "r.mat"
    write_mat73(path)
    mapping = {"joints": ["joint_1", "joint_2"], "time": {"column": "log.t"}}
    mapping |= {name: {"columns": f"log.{name}_{{number}}"} for name in ("q", "v", "tau")}
    assert_whole(load_recording(path, mapping_of(mapping, "m")))
    with h5py.File(path, "r+") as file:
        file["on"], file["z"] = T > 0, T + 1j * T
    said = next(finding for finding in inspect_recording(path, mapping_of(mapping, "m")) if finding.code == "left-out")
    assert said.message == "not read: on (it holds truth values, no numbers), z (it holds no numbers)"
    path.write_bytes(path.read_bytes()[:600])
    with pytest.raises(BadRecordingFile, match=r"r.mat: not a readable .mat file \(.*\); save it"):
        load_recording(path)


def write_bag(folder, topics, storage=StoragePlugin.MCAP, stamped=True):
    """topics: name → messages (names, position, velocity, effort), one every 10 ms from the same start."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    state, header, stamp = (
        store.types[f"{name}"]
        for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    with Writer(folder, version=9, storage_plugin=storage) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, state.__msgtype__, typestore=store)
            for k, (names, *fields) in enumerate(messages):
                time = 1_700_000_000 * 10**9 + k * 10**7
                when = stamp(sec=time // 10**9, nanosec=time % 10**9) if stamped else stamp(sec=0, nanosec=0)
                message = state(header(when, "base"), list(names), *(np.array(field, dtype=float) for field in fields))
                raw = store.serialize_cdr(message, state.__msgtype__)
                writer.write(connection, time + 1_000_000, raw)
    return folder


ARM = [(("joint_2", "joint_1"), Q[k, ::-1], V[k, ::-1], TAU[k, ::-1]) for k in range(N)]
GRIPPER = [(("finger",), [0.1], [], [])] * 3
BY_STAMP = 1e-9
"""[s] Stamps of bags are whole nanoseconds."""


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_bags_with_one_topic(tmp_path, storage):
    folder = write_bag(tmp_path / "bag", {"/joint_states": ARM}, storage)
    recording = load_recording(folder, joints=["joint_1", "joint_2"])
    assert_whole(recording, BY_STAMP)
    assert recording.findings == ()  # the messages are in SI units
    (file,) = [path for path in folder.iterdir() if path.suffix in (".mcap", ".db3")]
    assert_whole(load_recording(file, joints=["joint_1", "joint_2"]), BY_STAMP)
    assert load_recording(file).joint_names == ("joint_2", "joint_1")


def test_a_message_whose_definition_is_damaged(tmp_path):
    (path,) = write_bag(tmp_path / "bag", {"/joint_states": ARM}).glob("*.mcap")
    path.write_bytes(path.read_bytes().replace(b"] position", b"] xosition"))
    with pytest.raises(BadRecordingFile, match=r"mcap: not a readable bag \(.* no attribute 'position'\); record it"):
        load_recording(path)


def test_messages_of_other_joints_on_the_same_topic(tmp_path):
    both = [message for pair in zip(ARM, GRIPPER, strict=False) for message in pair]
    folder = write_bag(tmp_path / "bag", {"/joint_states": both})
    with pytest.raises(
        AmbiguousColumns, match=r"on /joint_states name different joints: joint_1, joint_2; finger; say"
    ):
        load_recording(folder)
    recording = load_recording(folder, joints=["joint_1", "joint_2"])
    assert len(recording.t) == 3
    text = f"{folder}: 3 messages on /joint_states without all of joint_1, joint_2; they are left out [other-joints]"
    assert text in [finding.text for finding in recording.findings]
    with pytest.raises(
        BadRecordingFile, match=r"no message on /joint_states has all of elbow; there are: finger, joint_1"
    ):
        load_recording(folder, joints=["elbow"])


def test_several_topics_need_a_choice(tmp_path):
    folder = write_bag(tmp_path / "bag", {"/arm": ARM, "/hand": GRIPPER})
    with pytest.raises(AmbiguousColumns, match=r"joint states on 2 topics: /arm, /hand; name one: topic"):
        load_recording(folder)
    mapping = {"joints": ["joint_1", "joint_2"], "topic": "/arm", "time": {"column": "receive_time"}}
    mapping |= {"q": {"columns": "position.{joint}"}}
    assert np.array_equal(load_recording(folder, mapping_of(mapping, "m")).q, Q)
    mapping["topic"] = "/leg"
    with pytest.raises(
        BadRecordingFile, match=r"no sensor_msgs/msg/JointState on the topic '/leg'; there are: /arm, /h"
    ):
        load_recording(folder, mapping_of(mapping, "m"))


def test_bags_without_stamps_without_efforts_without_joint_states(tmp_path, monkeypatch):
    folder = write_bag(tmp_path / "a", {"/joint_states": [(names, q, [], []) for names, q, *_ in ARM]}, stamped=False)
    recording = load_recording(folder, joints=["joint_1", "joint_2"])
    assert recording.v is None
    assert recording.tau is None
    np.testing.assert_allclose(recording.t, T, atol=BY_STAMP)
    message = "column 'time': the messages on /joint_states have no header stamps; the times of receiving are used"
    assert f"{folder}, {message} [no-stamps]" in [finding.text for finding in recording.findings]
    with pytest.raises(BadRecordingFile, match=r"no topic of type sensor_msgs/msg/JointState; record the joint states"):
        load_recording(write_bag(tmp_path / "b", {}))
    with pytest.raises(BadRecordingFile, match=r"no messages on /arm; record at least one"):
        load_recording(write_bag(tmp_path / "c", {"/arm": []}))
    (tmp_path / "d.mcap").write_bytes(b"no bag")
    with pytest.raises(
        BadRecordingFile, match=r"d.mcap: not a readable bag \(.*\); record it again, or give the whole"
    ):
        load_recording(tmp_path / "d.mcap")
    grows = "".join(f"a: &a [{part}, {part}]\n" for part in ("x", *20 * ["*a"]))
    (tmp_path / "b" / "metadata.yaml").write_text(grows)
    with pytest.raises(BadRecordingFile, match=r"b: not a readable bag \(more than 100000 parts, once its aliases are"):
        load_recording(tmp_path / "b")
    with pytest.raises(BadRecordingFile, match=r"is a folder, and no ROS 2 bag: it has no metadata.yaml; give a file$"):
        load_recording(tmp_path)
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(BadRecordingFile, match=r"rosbags is not installed; run: .* pip install 'graphdyn\[rosbag\]'"):
        load_recording(folder)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "r.xlsx").touch()
    with pytest.raises(
        BadRecordingFile, match=r"r.xlsx: recordings cannot be read from '.xlsx' files; convert it to one of"
    ):
        load_recording(tmp_path / "r.xlsx")
    for suffix in (".csv", ".npz", ".mat", ".parquet", ".mcap"):
        with pytest.raises(OSError, match=rf"no such file: .*missing{suffix}"):
            load_recording(tmp_path / f"missing{suffix}")
