"""Columns as PlotJuggler, ROS and MATLAB name them: taken where they are unambiguous, and what is taken is told."""

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy.io import savemat

from crosscheck.recordings import (
    AmbiguousColumns,
    BadMapping,
    StreamedRecording,
    inspect_recording,
    load_recording,
    mapping_of,
)
from crosscheck.recordings.mapping.column_names import candidates, meaning
from crosscheck.recordings.table import RecordedTable

N = 20
EPOCH = 1_700_000_000
T = np.arange(N) / 2
SHOULDER, ELBOW = np.sin(T), np.cos(T)
FIELDS = {"position": 1.0, "velocity": 2.0, "effort": 3.0}
JOINTS = ("shoulder", "elbow")
ROBOT = ("elbow", "shoulder")
"""The order of the robot, which is not that of the files."""


def write(path, columns):
    rows = zip(*columns.values(), strict=True)
    path.write_text("\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]) + "\n", encoding="utf-8")
    return path


def fields(form):
    """Columns of all fields of both joints; form: with {field}, and {joint} or {number}."""
    return {
        form.format(field=field, joint=joint, number=number): factor * values
        for field, factor in FIELDS.items()
        for number, (joint, values) in enumerate(zip(JOINTS, (SHOULDER, ELBOW), strict=True))
    }


def assert_read(recording, joints=ROBOT):
    assert recording.joint_names == joints
    expected = np.column_stack([{"shoulder": SHOULDER, "elbow": ELBOW}[joint] for joint in joints])
    for name, factor in zip(("q", "v", "tau"), FIELDS.values(), strict=True):
        np.testing.assert_array_equal(getattr(recording, name), factor * expected)
    assert np.array_equal(recording.t, T)


def codes(path, **options):
    return {finding.code: finding for finding in inspect_recording(path, **options)}


NAMED = [
    "/joint_states/{joint}/{field}",
    "/joint_states.{joint}.{field}",
    "/arm/joint_states/{joint}/{field}",
    "joint_states/{joint}/{field}",
    "joint_states.{joint}.{field}",
    "{joint}.{field}",
    "{field}.{joint}",
]

NUMBERED = [
    "/joint_states/{field}[{number}]",
    "/joint_states/{field}.{number}",
    "/joint_states.{field}[{number}]",
    "joint_states.{field}.{number}",
    "joint_states.{field}[{number}]",
    ".{field}.{number}",
    ".{field}[{number}]",
    "{field}.{number}",
    "{field}[{number}]",
    "{field}({number})",
    "field.{field}{number}",
    "{field}_{number}",
]


@pytest.mark.parametrize("form", NAMED)
def test_joints_with_names(tmp_path, form):
    path = write(tmp_path / "r.csv", {"__time": T} | fields(form))
    assert_read(load_recording(path, joints=ROBOT))
    assert_read(load_recording(path), JOINTS)
    parquet.write_table(pa.table({"__time": T} | fields(form)), tmp_path / "r.parquet")
    assert_read(load_recording(tmp_path / "r.parquet", joints=ROBOT))


@pytest.mark.parametrize("form", [*NAMED, *NUMBERED])
@pytest.mark.parametrize("field", FIELDS)
def test_capitals_change_no_meaning(form, field):
    small, *others = (
        meaning(form.format(field=word, joint="elbow", number=2), ROBOT)
        for word in (field, field.capitalize(), field.upper())
    )
    assert small.quantity == {"position": "q", "velocity": "v", "effort": "tau"}[field]
    for other in others:
        assert (other.quantity, other.joint, other.unit) == (small.quantity, small.joint, small.unit)


@pytest.mark.parametrize("form", NUMBERED)
def test_elements_of_arrays(tmp_path, form):
    """Without names beside them the joints are those of the robot in this order, which is told."""
    path = write(tmp_path / "r.csv", {"__time": T} | fields(form))
    recording = load_recording(path, joints=JOINTS)
    assert_read(recording, JOINTS)
    finding = next(finding for finding in recording.findings if finding.code == "numbered-joints")
    assert "columns with numbers, joints with names (shoulder, elbow)" in finding.text


@pytest.mark.parametrize("form", NUMBERED)
def test_elements_with_names_beside_them(tmp_path, form):
    names = {form.format(field="name", number=number): [joint] * N for number, joint in enumerate(JOINTS)}
    path = write(tmp_path / "r.csv", {"__time": T} | names | fields(form))
    assert_read(load_recording(path, joints=ROBOT))
    assert "numbered-joints" not in codes(path, joints=ROBOT)


def test_names_that_change_are_refused(tmp_path):
    names = {"name[0]": list(JOINTS) * (N // 2), "name[1]": list(ROBOT) * (N // 2)}
    path = write(tmp_path / "r.csv", {"t": T} | names | fields("{field}[{number}]"))
    with pytest.raises(
        AmbiguousColumns, match=r"'name\[0\]' names several joints \(elbow, shoulder\); give every joint"
    ):
        load_recording(path)


def test_what_was_taken_is_told(tmp_path):
    path = write(tmp_path / "r.csv", {"__time": T} | fields("/joint_states/{joint}/{field}") | {"/other/x": T})
    assert codes(path)["matched-columns"].text == (
        f"{path}: taken by name: time: __time; q: /joint_states/shoulder/position … /joint_states/elbow/position; "
        "v: /joint_states/shoulder/velocity … /joint_states/elbow/velocity; "
        "tau: /joint_states/shoulder/effort … /joint_states/elbow/effort; give a mapping to take others "
        "[matched-columns]"
    )
    path = write(tmp_path / "r.csv", {"__time": T} | fields("/joint_states/{field}[{number}]"))
    assert codes(path, joints=JOINTS)["numbered-joints"].severity == "warning"
    path = write(tmp_path / "r.csv", {"time": T} | fields("{field}_{number}"))
    assert "matched-columns" not in codes(path)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ("/reference/{joint}/{field}", "2 candidates for q: /joint_states/shoulder/position … /joint_states/elbow/pos"),
        ("/joint_states/{field}[{number}]", "2 candidates for q: "),
        ("{field}_mot_{number}", "2 candidates for q: "),
    ],
)
def test_two_sets_of_columns_are_refused(tmp_path, other, message):
    path = write(tmp_path / "r.csv", {"__time": T} | fields("/joint_states/{joint}/{field}") | fields(other))
    with pytest.raises(AmbiguousColumns, match=message):
        load_recording(path)


@pytest.mark.parametrize(
    "name",
    [
        "/gripper/position",
        "/joint_states/position",
        "/pose/pose/position/x",
        "/odom/pose/pose/position/y",
        "/joint_states/header/seq",
        "name[0]",
        "time[0]",
        "/temperature[0]",
        "/x/quality",
    ],
)
def test_fields_that_are_no_joints(name):
    assert meaning(name, None) is None


@pytest.mark.parametrize(
    ("name", "joints", "joint"),
    [
        ("/joint_states/left_elbow/position", ["elbow", "left_elbow"], "left_elbow"),
        ("/joint_states/arm/elbow/position", ["elbow", "arm/elbow"], "arm/elbow"),
        ("arm/elbow/position", ["arm/elbow"], "arm/elbow"),
        ("left.elbow.q", ["left.elbow", "elbow"], "left.elbow"),
        ("elbow/position", ["elbow"], "elbow"),
    ],
)
def test_known_joints_are_whole_names(name, joints, joint):
    assert meaning(name, joints).joint == joint


class TestClocks:
    JOINT_STATES = fields("/joint_states/{joint}/{field}")

    def read(self, tmp_path, **clocks):
        path = write(
            tmp_path / "r.csv", {name.replace("_S_", "/"): t for name, t in clocks.items()} | self.JOINT_STATES
        )
        return load_recording(path), codes(path)

    def test_the_stamps_of_the_message_before_the_time_of_plotjuggler(self, tmp_path):
        recording, found = self.read(tmp_path, __time=T + 0.03, _S_joint_states_S_header_S_stamp=T)
        assert np.array_equal(recording.t, T)
        assert found["two-clocks"].text.endswith(
            "two clocks: __time, /joint_states/header/stamp; /joint_states/header/stamp is taken [two-clocks]"
        )

    def test_stamps_that_were_never_set(self, tmp_path):
        recording, found = self.read(tmp_path, __time=T, _S_joint_states_S_header_S_stamp=0 * T)
        assert np.array_equal(recording.t, T)
        assert "two-clocks" not in found

    def test_stamps_of_another_message(self, tmp_path):
        recording, _ = self.read(tmp_path, __time=T, _S_imu_S_header_S_stamp=2 * T)
        assert np.array_equal(recording.t, T)

    def test_two_clocks_of_the_user(self, tmp_path):
        with pytest.raises(AmbiguousColumns, match="2 candidates for time: stamp; /joint_states/header/stamp; say in"):
            self.read(tmp_path, stamp=T, _S_joint_states_S_header_S_stamp=T)

    @pytest.mark.parametrize(
        ("whole", "part"),
        [("/joint_states/header/stamp/sec", "/joint_states/header/stamp/nanosec"), ("stamp_secs", "stamp_nsecs")],
    )
    def test_stamps_in_two_columns(self, tmp_path, whole, part):
        stamps = {whole: EPOCH + np.arange(N) // 2, part: 500_000_000 * (np.arange(N) % 2)}
        path = write(tmp_path / "r.csv", stamps | self.JOINT_STATES)
        recording = load_recording(path)
        assert np.array_equal(recording.t, T)
        assert f"time: {whole} … {part}" in codes(path)["matched-columns"].text
        (piece,) = StreamedRecording(path)
        assert len(piece) == N - 8
        document = {"joints": ["a"], "time": {"column": whole, "nanoseconds": part}}
        document |= {"q": {"columns": ["/joint_states/elbow/position"]}}
        assert np.array_equal(load_recording(path, mapping_of(document, "m")).t, T)

    def test_several_stamps_in_two_columns(self, tmp_path):
        stamps = {f"{name}.{part}": T for name in "xy" for part in ("sec", "nanosec")}
        path = write(tmp_path / "r.csv", stamps | self.JOINT_STATES)
        with pytest.raises(AmbiguousColumns, match=r"2 candidates for time: x.sec, x.nanosec; y.sec, y.nanosec; say"):
            load_recording(path)

    def test_mappings_with_nanoseconds(self):
        document = {"joints": ["a"], "q": {"columns": [1]}, "time": {"column": 1, "nanoseconds": 2, "unit": "ms"}}
        with pytest.raises(BadMapping, match=r"m, \[time\]: unit is 'ms', but beside nanoseconds the column holds sec"):
            mapping_of(document, "m")
        document["time"] = {"column": 1, "nanoseconds": 2.5}
        with pytest.raises(BadMapping, match=r"m, \[time\]: nanoseconds is 2.5; give its name, or its number from 1"):
            mapping_of(document, "m")


class TestEcho:
    """`ros2 topic echo --csv`: no header; sec, nanosec, frame, names, and the fields one after the other."""

    def write(self, path, names=FIELDS, frame="base", joints=None):
        lines = []
        for k in range(N):
            cells = [EPOCH + k // 2, 500_000_000 * (k % 2), frame, *(joints(k) if joints else JOINTS)]
            lines.append([*cells, *(FIELDS[name] * values[k] for name in names for values in (SHOULDER, ELBOW))])
        path.write_text("".join(",".join(map(str, line)) + "\n" for line in lines))
        return path

    @pytest.mark.parametrize("frame", ["base", ""])
    def test_joint_states(self, tmp_path, frame):
        path = self.write(tmp_path / "r.csv", frame=frame)
        assert_read(load_recording(path, joints=ROBOT))
        found = codes(path)
        assert "no-header" not in found
        assert (
            "joint states as `ros2 topic echo --csv` prints them, of shoulder, elbow" in found["echoed-messages"].text
        )

    def test_positions_alone(self, tmp_path):
        recording = load_recording(self.write(tmp_path / "r.csv", ["position"]), joints=ROBOT)
        assert np.array_equal(recording.q, np.column_stack([ELBOW, SHOULDER]))
        assert recording.tau is None

    def test_two_fields_are_not_guessed(self, tmp_path):
        path = self.write(tmp_path / "r.csv", ["position", "effort"])
        with pytest.raises(BadMapping, match="the columns have no names; give a mapping with their numbers"):
            load_recording(path)
        document = {"joints": list(JOINTS), "time": {"column": 1, "nanoseconds": 2}, "q": {"columns": [6, 7]}}
        recording = load_recording(path, mapping_of(document, "m"))
        assert np.array_equal(recording.q, np.column_stack([SHOULDER, ELBOW]))
        assert np.array_equal(recording.t, T)

    def test_messages_of_changing_joints(self, tmp_path):
        path = self.write(tmp_path / "r.csv", joints=lambda k: JOINTS if k % 2 else ROBOT)
        with pytest.raises(BadMapping, match=r"no columns of joint positions|the columns have no names"):
            load_recording(path)


def test_fields_of_a_matlab_structure(tmp_path):
    savemat(tmp_path / "r.mat", {"log": {"t": T, "q": np.column_stack([SHOULDER, ELBOW]), "gain": 3.0}})
    recording = load_recording(tmp_path / "r.mat")
    assert np.array_equal(recording.q, np.column_stack([SHOULDER, ELBOW]))
    assert np.array_equal(recording.t, T)
    assert "time: log.t; q: log.q_1 … log.q_2" in codes(tmp_path / "r.mat")["matched-columns"].text


def test_a_timetable_of_matlab(tmp_path):
    columns = {"Time": [f"{t:g} sec" for t in T], "q_1": SHOULDER, "q_2": ELBOW}
    recording = load_recording(write(tmp_path / "r.csv", columns))
    assert np.array_equal(recording.t, T)


class ComparedName(str):
    """A name that counts what it is compared with."""

    __slots__ = ()
    count = 0

    def __eq__(self, other):
        ComparedName.count += 1
        return str.__eq__(self, other)

    __hash__ = str.__hash__


def test_names_of_joints_in_wide_tables_are_not_sought_column_by_column(tmp_path):
    """Two comparisons for each column at most, of hundreds; the first of columns of one name gives the name."""
    joints = 300
    names = [f"/arm/{field}[{k}]" for field in ("name", "position") for k in range(joints)]
    texts = {k: {0: f"joint {k}"} for k in range(joints)} | {2 * joints: {0: "another"}}
    names = [ComparedName(name) for name in (*names, "/arm/name[7]")]
    table = RecordedTable(tmp_path / "r.csv", tuple(names), np.zeros((1, len(names))), texts)
    ComparedName.count = 0
    (family,) = candidates(table, None)["q"].values()
    assert ComparedName.count <= 2 * len(names)
    assert list(family) == [f"joint {k}" for k in range(joints)]
    assert [column.number for column in family.values()] == list(range(joints + 1, 2 * joints + 1))
