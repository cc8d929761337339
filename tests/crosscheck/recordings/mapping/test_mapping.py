"""Which columns are what: by name where names say it, by a TOML file, and refused with the candidates otherwise."""

import numpy as np
import pytest

import graphdyn
from crosscheck.recordings import (
    AmbiguousColumns,
    BadMapping,
    BadRecordingFile,
    concatenated,
    differentiated,
    inspect_recording,
    load_mapping,
    load_recording,
    mapping_of,
    recording_of,
    save_virtual_recording,
)
from crosscheck.recordings.loading import reordered
from crosscheck.recordings.mapping.column_names import meaning
from crosscheck.recordings.mapping.units import DRIVE_UNITS, SLIDING_UNITS, TIME_UNITS, TURNING_UNITS, unit_of
from graphdyn import InvalidInput

ROWS = np.random.default_rng(0).uniform(-1, 1, (30, 12)).cumsum(axis=0) / 10


def written(folder, names, name="r.csv", rows=ROWS, clock=True):
    """A file with the time in the first column, and random numbers under the names."""
    stamps = (np.arange(len(rows)) / 100).tolist()
    lines = [",".join((["t_s"] if clock else []) + names)]
    lines += [",".join(map(repr, ([t] if clock else []) + row.tolist())) for t, row in zip(stamps, rows, strict=True)]
    path = folder / name
    path.write_text("\n".join(line[: len(line)] for line in lines) + "\n")
    return path


def columns(folder, names, **options):
    return written(folder, names, rows=ROWS[:, : len(names)], **options)


TWO_AXES = {"joints": ["A", "B"], "rate": 100, "q": {"columns": ["q1", "q2"]}}


class TestTemperature:
    @pytest.mark.parametrize(("names", "expected"), [("T_{number}", [2, 3]), ("T_2", [3, 3]), (["T_2", "T_1"], [3, 2])])
    def test_of_each_joint_or_of_all(self, names, expected, tmp_path):
        path = columns(tmp_path, ["q1", "q2", "T_1", "T_2"], clock=False)
        recording = load_recording(path, mapping_of(TWO_AXES | {"temperature": {"columns": names}}, "m.toml"))
        assert np.array_equal(recording.temperature, ROWS[:, expected])
        assert np.array_equal(differentiated(recording, None).temperature, ROWS[4:-4, expected])
        assert np.array_equal(reordered(recording, ["B", "A"]).temperature, ROWS[:, expected[::-1]])
        assert len(concatenated([recording, recording]).temperature) == 60

    def test_refusals(self):
        wrong = (({"sign": 1}, r"\[temperature\]: unknown key 'sign'"), ({"unit": "F"}, "use one of: degC"))
        for entry, message in wrong:
            with pytest.raises(BadMapping, match=message):
                mapping_of(TWO_AXES | {"temperature": {"columns": "T", **entry}}, "m.toml")


@pytest.mark.parametrize(
    ("name", "quantity", "joint", "unit"),
    [
        ("q1", "q", "1", ""),
        ("position_1", "q", "1", ""),
        ("q_2_deg", "q", "2", "deg"),
        ("q_mot_link_rad_1", "q", "1", "rad"),
        ("Position 3 (deg)", "q", "3", "deg"),
        ("actual_q_0", "q", "0", ""),
        ("q_wrist_1_joint", "q", "wrist_1_joint", ""),
        ("q_joint_1", "q", "joint_1", ""),
        ("position.panda_joint1", "q", "panda_joint1", ""),
        ("qd_3_rad_s", "v", "3", "rad/s"),
        ("velocity.elbow", "v", "elbow", ""),
        ("qdd1", "a", "1", ""),
        ("joint2.tau [N m]", "tau", "joint2", "N m"),
        ("tau_motor_Nm_4", "tau", "4", "N m"),
        ("effort_elbow", "tau", "elbow", ""),
        ("time [ms]", "time", "", "ms"),
        ("stamp_s", "time", "", "s"),
        ("timestamp", "time", "", ""),
    ],
)
def test_names_that_say_what_a_column_is(name, quantity, joint, unit):
    said = meaning(name, None)
    assert (said.quantity, said.joint, said.unit) == (quantity, joint, unit)


@pytest.mark.parametrize("name", ["quality", "Joint_1", "robot", "body1.r_x [m]", "temperature_1", "tau", "i_1", ""])
def test_names_that_say_nothing(name):
    assert meaning(name, None) is None


def test_columns_in_any_order_come_in_that_of_the_joints(tmp_path):
    path = columns(tmp_path, ["q_elbow [deg]", "tau_shoulder [N mm]", "q_shoulder [deg]", "tau_elbow [N mm]", "x"])
    recording = load_recording(path, joints=["shoulder", "elbow"])
    assert recording.joint_names == ("shoulder", "elbow")
    np.testing.assert_allclose(recording.q, np.deg2rad(ROWS[:, [2, 0]]), rtol=1e-15)
    np.testing.assert_allclose(recording.tau, ROWS[:, [1, 3]] * 1e-3, rtol=1e-15)
    assert recording.units["tau"] == ("N m", "N m")
    assert recording.provenance.mapping == "by name"
    assert inspect_recording(path) == ()


def test_numbers_go_in_their_order_and_take_the_names_of_the_robot(tmp_path):
    names = [f"q_{k}_rad" for k in (10, 2, 1)]
    recording = load_recording(columns(tmp_path, names), joints=["base", "elbow", "wrist"])
    assert recording.joint_names == ("base", "elbow", "wrist")
    assert np.array_equal(recording.q, ROWS[:, [2, 1, 0]])
    (finding,) = recording.findings
    assert finding.text.endswith(
        "columns with numbers, joints with names (base, elbow, wrist); "
        "the joints are used in this order [numbered-joints]"
    )


def test_what_is_assumed_is_said(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time,q1,i1\n" + "".join(f"{k},{0.1 * k},{k}\n" for k in range(5)))
    assert [finding.text for finding in inspect_recording(path)] == [
        f"{path}: q in columns without units (q1); rad is assumed; give units in the header [assumed-unit]",
        f"{path}: currents instead of torques (i1); give their gains in a mapping [current-without-gain]",
        f"{path}: time in a column without unit (time); s is assumed; give the unit in the header [assumed-unit]",
    ]


@pytest.mark.parametrize(
    ("names", "joints", "message"),
    [
        (
            ["q_a_1", "q_a_2", "q_b_1", "q_b_2"],
            None,
            r"2 candidates for q: q_a_1 … q_a_2; q_b_1 … q_b_2; say in a mapp",
        ),
        (["stamp_s", "q_1"], None, r"2 candidates for time: t_s; stamp_s; say in a mapping \(docs/.*\) which to take"),
        (
            ["q_1", "q_1 [rad]"],
            None,
            r"'q_1' \(column 2\) and 'q_1 \[rad\]' \(column 3\) are both q of '1'; say in a m",
        ),
    ],
)
def test_ambiguous_names_are_refused_with_the_candidates(tmp_path, names, joints, message):
    with pytest.raises(AmbiguousColumns, match=rf"r.csv: {message}"):
        load_recording(columns(tmp_path, names), joints=joints)


@pytest.mark.parametrize(
    ("names", "joints", "message"),
    [
        (["x", "y"], None, r"no columns of joint positions \(q_1, .*\) among t_s, x, y; give a mapping"),
        (["q_1", "q_2", "tau_1"], None, r"tau has columns for 1, joints are 1, 2; give a mapping"),
        (["q_1", "q_2", "v_1", "v_2", "v_3"], None, r"v has columns for 1, 2, 3, joints are 1, 2; give a mapping"),
        (["q_1"], ["a", "b"], r"positions of 1 joint, the robot has 2; give a mapping"),
        (["q_a"], ["a", "b"], r"no position of 'b' \(there are a\); give a mapping"),
        (["q_1 [N]"], None, r"column 'q_1 \[N\]' is in 'N', which is not a unit of q; give a mapping"),
        (["q_1", "tau_1 [A]"], None, r"column 'tau_1 \[A\]' is in 'A', which is not a unit of tau; give a mapping"),
    ],
)
def test_names_that_do_not_fit_are_refused(tmp_path, names, joints, message):
    with pytest.raises(BadMapping, match=message):
        load_recording(columns(tmp_path, names), joints=joints)


def test_without_time_or_names(tmp_path):
    with pytest.raises(BadMapping, match=r"no column of time \(t, time_s, stamp, …\); give the rate, or a mapping"):
        load_recording(columns(tmp_path, ["q_1"], clock=False))
    assert load_recording(columns(tmp_path, ["q_1"], clock=False), rate=50).t[:3].tolist() == [0, 0.02, 0.04]
    with pytest.raises(InvalidInput, match=r"rate is -1; give samples per second"):
        load_recording(tmp_path / "r.csv", rate=-1)
    (tmp_path / "r.csv").write_text("0,1\n1,2\n")
    with pytest.raises(BadMapping, match=r"the columns have no names; give a mapping with their numbers"):
        load_recording(tmp_path / "r.csv")


def test_a_virtual_experiment_comes_back_as_a_record(tmp_path):
    recording = graphdyn.kr500_experiment()
    save_virtual_recording(recording, tmp_path / "r.csv")
    recording, direct = load_recording(tmp_path / "r.csv"), recording_of(recording)
    assert recording.joint_names == recording.joint_names == direct.joint_names
    for name in ("t", "q", "v", "a", "tau"):
        assert np.array_equal(getattr(recording, name), getattr(direct, name))
    model = graphdyn.kr500()
    assert direct.joint_wrenches.shape == direct.body_accelerations.shape == (len(recording.t), model.n_bodies, 6)


def test_wrenches_of_a_virtual_experiment_are_those_of_inverse_dynamics():
    model = graphdyn.kr500()
    rng = np.random.default_rng(1)
    q, v = model.random_state(rng, 20)
    a = rng.uniform(-1, 1, q.shape)
    laws = [lambda times, k=k: (q[:, k], v[:, k], a[:, k]) for k in range(model.n_bodies)]
    recording = recording_of(graphdyn.simulate_recording(model, np.arange(20.0), laws))
    dynamics = graphdyn.inverse_dynamics(model, q, v, a)
    scale = np.abs(dynamics.joint_wrenches).max()
    np.testing.assert_allclose(recording.joint_wrenches, dynamics.joint_wrenches, rtol=0, atol=1e-12 * scale)
    forward = graphdyn.forward_dynamics(model, q, v, dynamics.tau)
    scale = np.abs(forward.body_accelerations).max()
    np.testing.assert_allclose(recording.body_accelerations, forward.body_accelerations, rtol=0, atol=1e-10 * scale)


FULL = """
joints = ["a", "b"]
[time]
column = "clock"
unit = "ms"
[q]
columns = "pos_{number}"
unit = "deg"
side = "motor"
sign = [1, -1]
offset = [0, 90]
offset_unit = "deg"
[v]
columns = [5, 4]
unit = ["rpm", "rad/s"]
[tau]
columns = "i_{joint}"
unit = "mA"
gain = [10, 20]
side = "motor"
[transmission]
matrix = [[100, 0], [20, -80]]
"""


def test_everything_that_a_mapping_can_say(tmp_path):
    names = ["clock", "pos_1", "pos_2", "v_b", "v_a", "i_a", "i_b"]
    rows = ROWS[:, :7].copy()
    rows[:, 0] = 10 * np.arange(30)
    path = written(tmp_path, names, rows=rows, clock=False)
    (tmp_path / "map.toml").write_text(FULL)
    recording = load_recording(path, tmp_path / "map.toml")
    assert recording.provenance.mapping == str(tmp_path / "map.toml")
    ratio = np.array([[100.0, 0], [20, -80]])
    motor = np.deg2rad(rows[:, 1:3] * [1, -1])
    np.testing.assert_allclose(recording.t, np.arange(30) / 100, rtol=1e-14)
    np.testing.assert_allclose((recording.q - [0, np.pi / 2]) @ ratio.T, motor, rtol=0, atol=1e-12)
    np.testing.assert_allclose(recording.v, np.column_stack([rows[:, 4] * 2 * np.pi / 60, rows[:, 3]]), rtol=1e-14)
    currents = rows[:, 5:7] * 1e-3 * [10, 20]
    np.testing.assert_allclose(recording.tau, currents @ ratio, rtol=1e-14)
    speed = np.random.default_rng(2).normal(size=(30, 2))
    powers = (recording.tau * speed).sum(axis=1), (currents * (speed @ ratio.T)).sum(axis=1)
    np.testing.assert_allclose(*powers, rtol=1e-10)


def test_joints_of_a_mapping_are_brought_into_the_order_of_the_robot(tmp_path):
    path = columns(tmp_path, ["x", "y", "z", "w"])
    mapping = {"joints": ["a", "b"], "time": {"column": 1}, "q": {"columns": ["x", "y"], "unit": ["rad", "m"]}}
    mapping |= {"tau": {"columns": ["z", "w"], "unit": ["N m", "N"]}}
    recording = load_recording(path, mapping_of(mapping, "m"), joints=["b", "a"])
    assert recording.prismatic == (True, False)
    assert np.array_equal(recording.q, ROWS[:, [1, 0]])
    assert np.array_equal(recording.tau, ROWS[:, [3, 2]])
    assert recording.provenance.steps == ("joints in the order b, a",)
    with pytest.raises(BadMapping, match=r"m: no joint 'c' among a, b; name the joints as the robot does"):
        load_recording(path, mapping_of(mapping, "m"), joints=["a", "c"])
    mapping["prismatic"] = [False, False]
    with pytest.raises(
        BadMapping, match=r"m, \[q\]: 'b' turns, its unit is one of a joint that slides; correct the unit"
    ):
        load_recording(path, mapping_of(mapping, "m"))


def test_several_files_with_the_same_rows(tmp_path):
    a = written(tmp_path, ["x"], "pos.csv", ROWS[:, :1], clock=False)
    b = written(tmp_path, ["x"], "torque.csv", ROWS[:, 1:2], clock=False)
    mapping = {"joints": ["j"], "rate": 100, "q": {"columns": ["x"], "file": "pos*"}}
    mapping |= {"tau": {"columns": ["x"], "file": "tor*"}}
    recording = load_recording([b, a], mapping_of(mapping, "m"))
    assert np.array_equal(np.column_stack([recording.q, recording.tau]), ROWS[:, :2])
    assert recording.provenance.files == (str(b), str(a))
    with pytest.raises(
        BadMapping, match=r"m, \[tau\]: 0 of the files \(.*pos.csv\) match file = \"tor\*\"; exactly one m"
    ):
        load_recording(a, mapping_of(mapping, "m"))
    with pytest.raises(BadMapping, match=r"2 files without a mapping; give one that says which file has which columns"):
        load_recording([a, b])
    short = written(tmp_path, ["x"], "torque.csv", ROWS[:29, 1:2], clock=False)
    with pytest.raises(
        BadRecordingFile, match=r"not have the same rows \(.*pos.csv 30, .*torque.csv 29\); cut them to"
    ):
        load_recording([a, short], mapping_of(mapping, "m"))
    del mapping["tau"]
    with pytest.raises(
        BadMapping, match=r"m: nothing is taken from .*torque.csv; leave the file out, or map its columns"
    ):
        load_recording([a, short], mapping_of(mapping, "m"))


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ("u", r"has no column 'u'; it has t_s, x, x, y"),
        ("x", r"has 'x' in the columns 2 and 3; give the number of one"),
        (9, r"has no column 9; it has 4"),
    ],
)
def test_columns_that_a_file_does_not_have(tmp_path, column, message):
    mapping = {"joints": ["j"], "time": {"column": "t_s"}, "q": {"columns": [column]}}
    with pytest.raises(BadMapping, match=rf"m, \[q\]: .*r.csv {message}"):
        load_recording(columns(tmp_path, ["x", "x", "y"]), mapping_of(mapping, "m"))
    (tmp_path / "r.csv").write_text("0,1\n1,2\n")
    mapping["q"]["columns"] = ["x"]
    with pytest.raises(BadMapping, match=r"r.csv has no column 'x'; it has 2 columns without names; give numbers"):
        load_recording(tmp_path / "r.csv", mapping_of(mapping | {"time": {"column": 1}}, "m"))


GOOD = {"joints": ["a", "b"], "rate": 10, "q": {"columns": [1, 2]}}
MOTOR = GOOD | {"q": {"columns": [1, 2], "side": "motor"}}


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (GOOD | {"joint": 1}, r"m: unknown key 'joint'; known are joints, rate,"),
        ({"rate": 10, "q": {}}, r'm: joints is missing or not a list of names; write joints = \["joint_1", …\]'),
        (GOOD | {"joints": ["a", "a"]}, r"m: a joint is named twice; name each joint differently"),
        ({"joints": ["a"], "rate": 1}, r"m: without \[q\]; say which columns hold the joint positions"),
        (GOOD | {"rate": 0}, r"m: rate is 0; give samples per second"),
        (GOOD | {"rate": True}, r"m: rate is True; give samples per second"),
        (
            {"joints": ["a"], "q": {"columns": [1]}},
            r"m: without \[time\]; name its column, or give the rate in samples",
        ),
        (GOOD | {"prismatic": [True]}, r"m: prismatic is \[True\]; give true or false for each joint"),
        (GOOD | {"q": [1, 2]}, r"m: q is \[1, 2\]; make it a table: \[q\]"),
        (GOOD | {"topic": 3}, r"m: topic is 3; give a text in quotes"),
        (GOOD | {"time": {"unit": "s"}}, r"m, \[time\]: column is None; give its name, or its number from 1"),
        (
            GOOD | {"time": {"column": 1, "unit": "h"}},
            r"m, \[time\]: 'h' is not a unit of time; use one of: s, ms, us, ns",
        ),
        (
            GOOD | {"q": {"columns": [1]}},
            r"m, \[q\]: columns is \[1\]; give 2 names or numbers from 1, or a text with {num",
        ),
        (GOOD | {"q": {"columns": "pos"}}, r"m, \[q\]: columns is 'pos'; give 2 names"),
        (GOOD | {"q": {"columns": [1, 2], "unit": 1}}, r"m, \[q\]: unit is 1; give one text, or one per joint"),
        (
            GOOD | {"q": {"columns": [1, 2], "unit": "N"}},
            r"m, \[q\]: 'N' is not a unit of q; use one of: rad, mrad, deg",
        ),
        (
            GOOD | {"tau": {"columns": [1, 2], "unit": "h"}},
            r"m, \[tau\]: 'h' is not a unit of tau; use one of: N m, N mm, N cm, kN m, mN m, N, kN, A, mA, %$",
        ),
        (
            GOOD | {"v": {"columns": [1, 2], "unit": "h"}},
            r"m, \[v\]: 'h' is not a unit of v; use one of: rad/s, deg/s, rev/s, rpm, m/s, cm/s, mm/s$",
        ),
        (
            GOOD | {"q": {"columns": [1, 2], "gearing": 2}},
            r"m, \[q\]: unknown key 'gearing'; known are columns, unit, file, si",
        ),
        (
            GOOD | {"tau": {"columns": [1, 2], "unit": "A"}},
            r"m, \[tau\]: 'A' is not a unit of torque; give the gain in N m per A",
        ),
        (GOOD | {"q": {"columns": [1, 2], "side": "link"}}, r'm, \[q\]: side is \'link\'; use "joint" or "motor"'),
        (GOOD | {"q": {"columns": [1, 2], "sign": [1, 2]}}, r"m, \[q\]: sign is \[1, 2\]; use 1 and -1"),
        (GOOD | {"q": {"columns": [1, 2], "offset": [1]}}, r"m, \[q\]: offset is \[1\]; give 2 numbers"),
        (GOOD | {"q": {"columns": [1, 2], "offset": [0, False]}}, r"m, \[q\]: offset is \[0, False\]; give 2 numbers"),
        (GOOD | {"q": {"columns": [True, 2]}}, r"m, \[q\]: columns is \[True, 2\]; give 2 names or numbers from 1"),
        (GOOD | {"time": {"column": True}}, r"m, \[time\]: column is True; give its name, or its number from 1"),
        (MOTOR, r'm: side = "motor" without \[transmission\]; give its ratio or matrix'),
        (MOTOR | {"transmission": {}}, r"m, \[transmission\]: give either ratio or matrix"),
        (MOTOR | {"transmission": {"matrix": [[1, 0]]}}, r"m, \[transmission\]: matrix needs 2 rows of 2 numbers"),
        (
            MOTOR | {"transmission": {"ratio": [1, 0]}},
            r"\[transmission\]: the matrix is singular, so motors do not determ",
        ),
    ],
)
def test_mappings_that_say_too_little_or_too_much(document, message):
    with pytest.raises(BadMapping, match=message):
        mapping_of(document, "m")


def test_what_is_no_toml(tmp_path):
    (tmp_path / "m.toml").write_text("joints = [")
    with pytest.raises(BadMapping, match=r"m.toml: is no TOML: .*; write it as docs/recordings shows"):
        load_mapping(tmp_path / "m.toml")


def test_a_torque_matrix_of_its_own_and_a_rate_of_the_call(tmp_path):
    path = columns(tmp_path, ["x", "y"], clock=False)
    matrices = {"matrix": [[2]], "torque_matrix": [[3]]}
    mapping = {"joints": ["a"], "rate": 10, "q": {"columns": ["x"]}, "transmission": matrices}
    mapping |= {"tau": {"columns": ["y"], "side": "motor"}}
    recording = load_recording(path, mapping_of(mapping, "m"), rate=20)
    assert recording.t[1] == 1 / 20
    np.testing.assert_allclose(recording.tau, 3 * ROWS[:, 1:2], rtol=1e-15)


@pytest.mark.parametrize(
    ("quantity", "name", "factor"),
    [
        ("tau", "Nm", 1),
        ("tau", "N·m", 1),
        ("a", "rad/s²", 1),
        ("q", "°", np.pi / 180),
        ("time", "µs", 1e-6),
        ("v", "rpm", 2 * np.pi / 60),
    ],
)
def test_spellings_of_units(quantity, name, factor):
    assert unit_of(quantity, name).factor == pytest.approx(factor, rel=1e-15)


IN_SI = {
    "time": {"s": 1.0, "ms": 0.001, "us": 0.000001, "ns": 0.000000001, "min": 60.0},
    "q": {
        "rad": 1.0,
        "mrad": 0.001,
        "deg": 0.017453292519943295,
        "rev": 6.283185307179586,
        "m": 1.0,
        "cm": 0.01,
        "mm": 0.001,
    },
    "v": {
        "rad/s": 1.0,
        "deg/s": 0.017453292519943295,
        "rev/s": 6.283185307179586,
        "rpm": 0.10471975511965977,
        "m/s": 1.0,
        "cm/s": 0.01,
        "mm/s": 0.001,
    },
    "a": {
        "rad/s^2": 1.0,
        "deg/s^2": 0.017453292519943295,
        "rev/s^2": 6.283185307179586,
        "m/s^2": 1.0,
        "cm/s^2": 0.01,
        "mm/s^2": 0.001,
    },
    "tau": {
        "N m": 1.0,
        "N mm": 0.001,
        "N cm": 0.01,
        "kN m": 1000.0,
        "mN m": 0.001,
        "N": 1.0,
        "kN": 1000.0,
        "A": 1.0,
        "mA": 0.001,
        "%": 1.0,
    },
}
"""Every unit, written out once more."""
SLIDING = {"m", "cm", "mm", "m/s", "cm/s", "mm/s", "m/s^2", "cm/s^2", "mm/s^2", "N", "kN"}


def test_every_unit_against_its_literal_factor():
    assert TIME_UNITS.keys() == IN_SI["time"].keys()
    for quantity in ("q", "v", "a", "tau"):
        known = {**TURNING_UNITS[quantity], **SLIDING_UNITS[quantity], **(DRIVE_UNITS if quantity == "tau" else {})}
        assert known.keys() == IN_SI[quantity].keys()
    for quantity, units in IN_SI.items():
        for name, factor in units.items():
            unit = unit_of(quantity, name)
            assert unit.factor == pytest.approx(factor, rel=1e-15), name
            both = quantity == "time" or name in ("A", "mA", "%")
            assert unit.slides is (None if both else name in SLIDING), name
            assert unit.needs_gain is (name in ("A", "mA", "%")), name


@pytest.mark.parametrize(("name", "torque"), [("N cm", 0.25), ("N mm", 0.025), ("kN m", 25_000.0)])
def test_a_torque_in_its_unit(tmp_path, name, torque):
    (tmp_path / "r.csv").write_text(f"t_s,q_1 [rad],tau_1 [{name}]\n0,0,25\n1,0.1,25\n")
    assert load_recording(tmp_path / "r.csv").tau[0, 0] == pytest.approx(torque, rel=1e-15)
