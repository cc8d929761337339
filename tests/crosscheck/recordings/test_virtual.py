"""Recording files: bit for bit there and back; every defect is refused with file, line, column and remedy."""

import csv
import dataclasses
import re

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet
from random_trees import random_tree

import graphdyn
from crosscheck.recordings import BadRecordingFile, load_virtual_recording, save_virtual_recording
from graphdyn import InvalidInput, VirtualRecording
from graphdyn.experiments.virtual_recording import BODY_CHANNELS, CHANNELS, JOINT_CHANNELS
from graphdyn.motion_laws import ConstantAcceleration, Rail

SUFFIXES = [".csv", ".parquet"]


@pytest.fixture(scope="module")
def recording():
    """Joints of each kind; three times."""
    tree = random_tree(7, [0, 1, 1], ["revolute", "prismatic", "continuous"])
    laws = [ConstantAcceleration(1.0), ConstantAcceleration(-0.3, 0.1), ConstantAcceleration(2.0)]
    return graphdyn.simulate_recording(tree, [0.0, 0.1, 1 / 3], laws, base=Rail((1, 1, 0), laws[0]))


def assert_same(x, y):
    assert (x.robot, x.joint_names, x.body_names, x.prismatic) == (y.robot, y.joint_names, y.body_names, y.prismatic)
    for name in ("time", *CHANNELS):
        assert getattr(x, name).tobytes() == getattr(y, name).tobytes()


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".CSV"])
def test_a_recording_comes_back_bit_for_bit(recording, tmp_path, suffix):
    save_virtual_recording(recording, tmp_path / f"r{suffix}")
    assert_same(load_virtual_recording(tmp_path / f"r{suffix}"), recording)
    assert [path.name for path in tmp_path.iterdir()] == [f"r{suffix}"]


@pytest.mark.parametrize("end", [b"\r", b"\r\n"])
def test_line_ends_of_other_systems(recording, tmp_path, end):
    path = tmp_path / "r.csv"
    save_virtual_recording(recording, path)
    path.write_bytes(path.read_bytes().replace(b"\n", end))
    assert_same(load_virtual_recording(path), recording)


def test_units_without_a_blank_before_them(recording, tmp_path):
    path = tmp_path / "r.csv"
    save_virtual_recording(recording, path)
    path.write_bytes(path.read_bytes().replace(b" [rad", b"[rad").replace(b" [m]", b"  [m] "))
    assert_same(load_virtual_recording(path), recording)


def test_a_name_of_two_lines_is_told_in_one(recording, tmp_path):
    path = tmp_path / "r.csv"
    save_virtual_recording(recording, path)
    head = path.read_bytes().replace(recording.body_names[0].encode(), b"a\nb", 1)
    path.write_bytes(head)
    with pytest.raises(BadRecordingFile, match=r"4 bodies \(a\\nb, "):
        load_virtual_recording(path)


def test_a_header_too_long_for_a_cell(tmp_path):
    (tmp_path / "r.csv").write_bytes(b"x" * 200_000 + b"\n1\n")
    with pytest.raises(BadRecordingFile, match=r"r\.csv, line 1: field larger than field limit"):
        load_virtual_recording(tmp_path / "r.csv")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_paper_s_experiment_comes_back(tmp_path, suffix):
    paper = graphdyn.kr500_experiment()
    save_virtual_recording(paper, tmp_path / f"kr500{suffix}")
    assert_same(load_virtual_recording(str(tmp_path / f"kr500{suffix}")), paper)


@pytest.mark.parametrize("suffix", SUFFIXES)
@given(data=st.data())
def test_any_doubles_and_names_come_back(tmp_path_factory, suffix, data):
    names = st.text(st.characters(exclude_categories=["C", "Z"]), max_size=5)
    joint, body, robot = (data.draw(names) for _ in range(3))
    numbers = data.draw(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=25, max_size=25))
    numbers = np.array(numbers)
    channels = {name: numbers[k].reshape(1, 1) for k, name in enumerate(JOINT_CHANNELS)}
    channels |= {name: numbers[4 + 3 * k : 7 + 3 * k].reshape(1, 1, 3) for k, name in enumerate(BODY_CHANNELS)}
    x = VirtualRecording(robot, (joint,), (body,), (data.draw(st.booleans()),), numbers[:1], **channels)
    path = tmp_path_factory.getbasetemp() / f"any{suffix}"
    save_virtual_recording(x, path)
    assert_same(load_virtual_recording(path), x)


def test_units_stand_in_the_header(recording, tmp_path):
    save_virtual_recording(recording, tmp_path / "r.csv")
    with open(tmp_path / "r.csv", encoding="utf-8") as file:
        header = next(csv.reader(file))
    assert header[:2] == ["robot", "time [s]"]
    assert header[2:6] == ["joint1.q [rad]", "joint1.v [rad/s]", "joint1.a [rad/s^2]", "joint1.tau [N m]"]
    assert header[6:10] == ["joint2.q [m]", "joint2.v [m/s]", "joint2.a [m/s^2]", "joint2.tau [N]"]
    assert header[14:20] == [
        *("body1.alpha [rad]", "body1.beta [rad]", "body1.gamma [rad]"),
        *("body1.r_x [m]", "body1.r_y [m]", "body1.r_z [m]"),
    ]
    assert header[-3:] == ["body3.M_x [N m]", "body3.M_y [N m]", "body3.M_z [N m]"]
    assert len(header) == 2 + 3 * 4 + 3 * 21


def test_other_programs_order_columns_and_space_cells_as_they_like(recording, tmp_path):
    save_virtual_recording(recording, tmp_path / "r.csv")
    with open(tmp_path / "r.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    spaced = "\r\n".join(", ".join([*row[5:], *row[:5]]) for row in rows)
    (tmp_path / "r.csv").write_bytes(b"\xef\xbb\xbf" + spaced.encode())
    assert_same(load_virtual_recording(tmp_path / "r.csv"), recording)


def edited(recording, folder, change):
    """The path of the CSV file after a change of its cells: lines, header first, of lists of texts."""
    path = folder / "r.csv"
    save_virtual_recording(recording, path)
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader(file))
    change(rows)
    path.write_text("".join(",".join(row) + "\n" for row in rows), encoding="utf-8")
    return path


def set_cell(line, column, text):
    def change(rows):
        rows[line - 1][column - 1] = text

    return change


def drop_column(rows):
    for row in rows:
        del row[4]


def add_column(rows):
    for row in rows:
        row.append("weight [kg]" if row is rows[0] else "1")


def repeat_column(rows):
    for row in rows:
        row.append(row[3])


def drop_body(rows):
    keep = [k for k, name in enumerate(rows[0]) if not name.startswith("body2")]
    rows[:] = [[row[k] for k in keep] for row in rows]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (drop_column, r"r.csv, header: without column 'joint1.a \[rad/s\^2\]'; record every channel of every joint"),
        (lambda rows: rows[0].__setitem__(1, "t"), r"header, column 2 't': not a column of a recording; remove it"),
        (add_column, r"r.csv, header, column 78 'weight \[kg\]': not a column of a recording; remove it"),
        (repeat_column, r"r.csv, header, column 78 'joint1.v \[rad/s\]': 'joint1.v' occurs twice; keep one"),
        (
            drop_body,
            r"header: 3 joints \(joint1, joint2, joint3\), 2 bodies \(body1, body3\); each joint needs its columns",
        ),
        (
            set_cell(1, 3, "joint1.q [deg]"),
            r"header, column 3 'joint1.q \[deg\]': the unit must be \[rad\]; convert the num",
        ),
        (set_cell(1, 7, "joint2.q [rad]"), r"column 8 'joint2.v \[m/s\]': the unit must be \[rad/s\]; convert"),
        (set_cell(1, 2, "time [ms]"), r"header, column 2 'time \[ms\]': the unit must be \[s\]; convert"),
        (set_cell(1, 1, "robot [m]"), r"header, column 1 'robot \[m\]': the unit must be none"),
        (
            set_cell(3, 4, "nan"),
            r"r.csv, line 3, column 4 'joint1.v \[rad/s\]': 'nan' is not a finite number; repair it",
        ),
        (set_cell(2, 2, "-inf"), r"r.csv, line 2, column 2 'time \[s\]': '-inf' is not a finite number"),
        (
            set_cell(4, 5, ""),
            r"r.csv, line 4, column 5 'joint1.a \[rad/s\^2\]': '' is not a finite number; .* leave out the line",
        ),
        (set_cell(4, 5, "1_0"), r"line 4, column 5 .*: '1_0' is not a finite number"),
        (
            set_cell(3, 1, "other"),
            r"line 3, column 1 'robot': 'other'; write the name of the robot, the same in every line",
        ),
        (set_cell(4, 2, "0.1"), r"r.csv: time 0.1 s in row 2 does not increase; sort the rows by time"),
        (lambda rows: rows[2].pop(), r"r.csv, line 3: 76 cells under 77 headers; complete the line or leave it out"),
        (lambda rows: rows[2].append("1"), r"r.csv, line 3: 78 cells under 77 headers; complete the line"),
        (
            lambda rows: rows.insert(1, []),
            r"r.csv, line 2, column 2 'time \[s\]': '' is not a finite number; repair it, or leave out the line",
        ),
        (
            lambda rows: rows.__delitem__(slice(1, None)),
            r"r.csv: no line below the header; record at least one time",
        ),
        (lambda rows: rows.clear(), r"r.csv: Empty CSV file; write files with save_virtual_recording"),
    ],
)
def test_defects_of_csv_files(recording, tmp_path, change, message):
    with pytest.raises(BadRecordingFile, match=message):
        load_virtual_recording(edited(recording, tmp_path, change))


def test_a_csv_file_in_another_encoding_is_refused(recording, tmp_path):
    path = edited(recording, tmp_path, set_cell(3, 1, "tree7"))
    path.write_bytes(path.read_bytes() + "müll".encode("latin-1"))
    with pytest.raises(BadRecordingFile, match=r"r.csv, line 5: not UTF-8 text; save the file as CSV in UTF-8"):
        load_virtual_recording(path)


def with_column(table, number, values):
    return table.set_column(number, table.column_names[number], values)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.drop_columns(["time [s]"]), r"r.parquet, header: without column 'time \[s\]'"),
        (
            lambda t: with_column(t, 3, pa.array([1.0, None, 2.0])),
            r"r.parquet, row 2, column 4 'joint1.v .*: None is not a",
        ),
        (
            lambda t: with_column(t, 3, pa.array([[1.0]] * 3)),
            r"row 1, column 4 'joint1.v \[rad/s\]': \[1.0\] is not a finite",
        ),
        (
            lambda t: with_column(t, 0, pa.array(["r", None, "r"])),
            r"row 2, column 1 'robot': None; .* same in every row",
        ),
        (lambda t: t.slice(0, 0), r"r.parquet: no row below the header"),
    ],
)
def test_defects_of_parquet_files(recording, tmp_path, change, message):
    path = tmp_path / "r.parquet"
    save_virtual_recording(recording, path)
    parquet.write_table(change(parquet.read_table(path)), path)
    with pytest.raises(BadRecordingFile, match=message):
        load_virtual_recording(path)


def test_what_is_no_parquet_file_is_refused(tmp_path):
    (tmp_path / "r.parquet").write_text("robot", encoding="utf-8")
    with pytest.raises(BadRecordingFile, match=r"r.parquet: not a readable Parquet file \(.*\); save it again"):
        load_virtual_recording(tmp_path / "r.parquet")


def test_other_suffixes_are_refused(recording, tmp_path):
    message = r"r.txt: a recording is saved as .csv or .parquet, not as '.txt'; rename the file"
    with pytest.raises(InvalidInput, match=message):
        save_virtual_recording(recording, tmp_path / "r.txt")
    with pytest.raises(InvalidInput, match=message):
        load_virtual_recording(tmp_path / "r.txt")
    with pytest.raises(FileNotFoundError):
        load_virtual_recording(tmp_path / "missing.csv")


@pytest.mark.parametrize("name", [" B1", "B\n1"])
def test_names_that_no_header_keeps_are_refused(recording, tmp_path, name):
    renamed = dataclasses.replace(recording, body_names=("body1", name, "body3"))
    with pytest.raises(InvalidInput, match=re.escape(f"r.csv: the name {name!r} cannot be read back from a header")):
        save_virtual_recording(renamed, tmp_path / "r.csv")
    assert not list(tmp_path.iterdir())
