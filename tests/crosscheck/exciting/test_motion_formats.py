"""Motions as files: what is written is read as written, what is another program is refused with its line."""

import csv
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
import yaml
from planting import mixed_tree

from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.motion_file import (
    WRITTEN_SUFFIXES,
    document,
    read_motion,
    slides,
    table_document,
    written_rate,
)
from crosscheck.exciting.motion_formats.timed_motion import TimedMotion, dividing_rate
from crosscheck.recordings.errors import BadRecordingFile
from graphdyn import InvalidInput
from graphdyn.excitation import FourierBasis, Trajectory

SETTINGS = AxisSettings((1.0, -1.0, 1.0), (0.0, 25.0, -90.0))

MODEL = mixed_tree()

N_ROWS = 9
"""Rows of the files that are changed."""


def random_motion(seed, suffix=".csv"):
    """A random motion of 1 to 12 s, of sizes from 1e-7 to 30, at a rate that does not divide it."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-7, 1.5, size=(MODEL.nv, 1))
    course = Trajectory(FourierBasis(rng.uniform(1, 12), 3), size * rng.normal(size=(MODEL.nv, 5)))
    rate = written_rate(course, tmp_name(suffix), rng.uniform(20, 60))
    return course, TimedMotion.of(course, MODEL.independent_joints, slides(MODEL), rate)


def tmp_name(suffix):
    return Path(f"motion{suffix}")


@pytest.fixture
def read(tmp_path):
    """Reads a file of this content; its warnings are errors."""

    def reads(suffix, content):
        path = tmp_path / f"motion{suffix}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return read_motion(path, MODEL, SETTINGS)

    return reads


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
def test_random_motions_are_read_as_written(suffix, read):
    for seed in range(5):
        course, motion = random_motion(seed, suffix)
        found = read(suffix, document(motion, tmp_name(suffix), SETTINGS))
        assert motion.time[-1] == pytest.approx(course.duration, rel=1e-12)
        assert np.abs(motion.q[-1] - course.motion(np.array([course.duration])).q).max() < 1e-12
        assert np.abs(found.times - motion.time).max() < 2e-6
        assert np.abs(found.positions - motion.q).max() < (1e-8 if suffix == ".src" else 1e-15)


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_rates_are_those_of_the_motion(suffix):
    """Velocities and accelerations in the file are those of the positions, by differences of the motion itself."""
    course, motion = random_motion(0)
    content = document(motion, tmp_name(suffix), SETTINGS).decode()
    if suffix == ".csv":
        rows = np.array([[float(x) for x in row] for row in list(csv.reader(content.splitlines()))[1:]])
        q, v, a = (rows[:, 1 + 3 * k : 4 + 3 * k] for k in range(3))
        times = rows[:, 0]
    else:
        points = yaml.safe_load(content)["points"]
        q, v, a = (np.array([p[key] for p in points]) for key in ("positions", "velocities", "accelerations"))
        times = np.array([p["time_from_start"]["sec"] + 1e-9 * p["time_from_start"]["nanosec"] for p in points])
        assert v.dtype == a.dtype == q.dtype == float  # not a text, as YAML takes 1e-05
    h = 1e-4
    ahead, behind = (course.motion(times[1:-1] + step).q for step in (h, -h))
    here = course.motion(times[1:-1]).q
    largest = np.abs(v).max(axis=0), np.abs(a).max(axis=0)
    assert np.abs(q[1:-1] - here).max() < 1e-7
    assert (np.abs(v[1:-1] - (ahead - behind) / (2 * h)).max(axis=0) < 1e-4 * largest[0]).all()
    assert (np.abs(a[1:-1] - (ahead - 2 * here + behind) / h**2).max(axis=0) < 1e-3 * largest[1]).all()
    assert times[-1] == pytest.approx(course.duration, abs=1e-9)


def test_names_that_a_table_has_to_quote():
    _, motion = random_motion(0)
    odd = TimedMotion(('a,b"', "c", "d"), motion.prismatic, motion.time, motion.q, motion.v, motion.a)
    rows = list(csv.reader(table_document(odd).decode().splitlines()))
    assert {len(row) for row in rows} == {10}
    assert rows[0][1] == 'a,b".q [rad]'


def test_programs_have_equal_steps():
    assert dividing_rate(4.0, 50.0) == 50.0
    assert dividing_rate(3.3, 125.0) == 413 / 3.3
    _, motion = random_motion(0)
    for suffix in (".src", ".script"):
        with pytest.raises(InvalidInput, match=r"the last step of .* s is none of .* s, but programs have steps"):
            document(motion, tmp_name(suffix), SETTINGS)


def written(suffix):
    course = Trajectory(FourierBasis(4.0, 2), 0.3 * np.random.default_rng(0).normal(size=(MODEL.nv, 3)))
    motion = TimedMotion.of(course, MODEL.independent_joints, slides(MODEL), (N_ROWS - 1) / 4.0)
    return document(motion, tmp_name(suffix), SETTINGS).decode().splitlines()


KRL_CHANGES = {
    "linear": (9, lambda line: line.replace("SPTP", "SLIN"), 10),
    "relative": (9, lambda line: line.replace("SPTP", "SPTP_REL"), 10),
    "other part": (8, lambda line: line.replace("1", "8"), 9),
    "commented": (9, lambda line: f";{line}", 10),
    "two points": (9, lambda line: f"{line} {line}", 10),
    "number": (9, lambda line: re.sub(r"A1 [-0-9.]+", "A1 1.2.3", line), 10),
    "surplus axis": (9, lambda line: line.replace("}", ",A3 1.0}"), 10),
    "left axis": (9, lambda line: re.sub(",A2 [^}]*", "", line), 10),
    "infinite": (9, lambda line: re.sub(r"A1 [-0-9.]+", "A1 1e999", line), 10),
    "loop": (8, lambda line: f"FOR i=1 TO 3\n{line}", 9),
    "velocity": (1, lambda line: f"{line}\n$VEL_AXIS[1]=5", 3),
    "after": (-1, lambda line: f"{line}\nDEF other()", None),
    "no end": (-2, lambda line: "", None),
}

URSCRIPT_CHANGES = {
    "speed": (5, lambda line: "  speedj([1, 0, 0], 2)", 6),
    "loop": (5, lambda line: f"while True:\n{line}", 6),
    "own time": (5, lambda line: line.replace("t=period", "t=0.2"), 6),
    "commented": (5, lambda line: f"#{line}", 6),
    "surplus": (5, lambda line: line.replace("]", ", 1.0]", 1), 6),
    "underscore": (5, lambda line: re.sub(r"\[[^,]*", "[1_0", line), 6),
    "nan": (5, lambda line: re.sub(r"\[[^,]*", "[nan", line), 6),
    "second period": (2, lambda line: f"global period = 1.0\n{line}", 3),
    "no start": (2, lambda line: "", 4),
    "after": (-1, lambda line: f"{line}\nmovej([0, 0, 0])", None),
}


@pytest.mark.parametrize(
    ("suffix", "change", "place"),
    [
        *((".src", (row, change), place) for row, change, place in KRL_CHANGES.values()),
        *((".script", (row, change), place) for row, change, place in URSCRIPT_CHANGES.values()),
    ],
    ids=[*(f"krl {name}" for name in KRL_CHANGES), *(f"urscript {name}" for name in URSCRIPT_CHANGES)],
)
def test_other_programs_are_refused(suffix, change, place, read):
    lines = written(suffix)
    assert len(read(suffix, "\r\n".join([*lines, "", ""])).times) == N_ROWS
    row, changed = change
    lines[row] = changed(lines[row])
    said = r"line \d+: |ends where" if place is None else f"line {place}: "
    with pytest.raises(BadRecordingFile, match=rf"motion\{suffix}: ({said})"):
        read(suffix, "\n".join(lines))


def test_programs_of_other_content(read):
    lines = written(".script")
    with pytest.raises(BadRecordingFile, match=r"the first servoj is not where movej ends"):
        read(".script", "\n".join([*lines[:3], *lines[4:]]))
    with pytest.raises(BadRecordingFile, match=r"motion\.script: the times of a motion must increase"):
        read(".script", "\n".join([lines[0], "global period = 0", *lines[2:]]))
    with pytest.raises(BadRecordingFile, match=r"motion\.script: byte 0 is no UTF-8"):
        read(".script", b"\xff\xfe")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("positions: [", "positions: [1.0, ", r"line 6: 4 numbers in positions; give 3"),
        ("velocities: [", "velocities: [1.0, ", r"line 7: 4 numbers in velocities; give 3"),
        ("  velocities: [", "  velocities: []\n  foo: [", r"line 6: a point has 'foo'"),
        ("effort: []", "effort: [1.0]", r"line 9: 1 number in effort; give 0"),
        ("positions: [", "positions: [1:30, ", r"line 6: 4 numbers|'1:30'"),
        ("nanosec: 500000000", "nanosec: 5e8", r"line 15: time_from_start is not \{sec, nanosec\} as whole numbers"),
        ("nanosec: 500000000", "nanosec: 0", r"line 15: time_from_start does not increase"),
        ("{sec: 0, nanosec: 500000000}", "2001-99-99", r"line 15: time_from_start is no mapping"),
        ("positions: [", "positions: [2001-99-99, ", r"line 6: 4 numbers in positions"),
        ("positions: [", "positions: !!int [", r"line 6: the tag 'tag:yaml.org,2002:int'"),
        ("positions: [", "positions: &a [", r"line 6: the name 'a' for a part of the file"),
        ("effort: []", "effort: *a", r"line 9: the name 'a' for a part of the file"),
        ("effort: []", "effort: [[[[[[[[[[]]]]]]]]]]", r"line 9: more than 8 lists within each other"),
        ("effort: []", "effort: []\n  effort: []", r"line 10: 'effort' is stated twice"),
        ("joint_names: [", "joint_names: ['x', ", r"joint_names has 'x', no joint of the robot that no other drives"),
        ("'joint2', 'joint3'", "'joint2', 'joint3', 'joint3'", r"joint_names repeats a joint"),
        ("points:\n", "points:\n- {time_from_start: {sec: 0, nanosec: 0}}\n", r"does not increase|1 points lack"),
        ("points:\n", "points: {}\nother:\n", r"line 1: message has 'other'"),
        ("header:", "? [a]\n: b\nheader:", r"line 1: a key that is no text"),
        ("header:", "---\n---\nheader:", r"has 2 YAML documents"),
    ],
)
def test_other_messages_are_refused(old, new, message, read):
    content = "\n".join(written(".yaml"))
    assert old in content
    with pytest.raises(BadRecordingFile, match=rf"motion\.yaml: .*({message})"):
        read(".yaml", content.replace(old, new, 1))


def test_a_message_of_other_order_and_texts(read):
    """Joints in another order, numbers as YAML 1.1 takes for texts, and no more than positions and times."""
    points = [f"- {{positions: [{k}e-05, 2, {k}.], time_from_start: {{sec: {k}, nanosec: 0}}}}" for k in range(6)]
    found = read(".yaml", "\n".join(["joint_names: [joint3, joint1, joint2]", "points:", *points]))
    assert found.positions[5].tolist() == [2.0, 5.0, 5e-5]


@pytest.mark.parametrize("deep", ["[" * 5000, "{a: " * 5000, "- " * 3000, "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]"])
def test_yaml_that_would_grow(deep, read):
    with pytest.raises(BadRecordingFile):
        read(".yaml", deep)


@pytest.mark.parametrize(
    ("header", "cell", "message"),
    [
        (
            "joint9.q [rad]",
            "1.0",
            r"column 'joint9\.q \[rad\]' is left over: the robot's joints are joint1, joint2, joint3",
        ),
        ("", "1.0", r"column '' is left over"),
        ("foo", "1.0", r"column 'foo' is left over"),
    ],
)
def test_columns_left_over(header, cell, message, read):
    first, *rows = written(".csv")
    with pytest.raises(BadRecordingFile, match=message):
        read(".csv", "\n".join([f"{first},{header}", *(f"{row},{cell}" for row in rows), ""]))


def test_a_table_that_is_cut_off(read):
    """No row of a planned motion is left out without a word, as those of a recording are."""
    *lines, last = written(".csv")
    with pytest.raises(BadRecordingFile, match=r"\(line \d+\): 5 of 10 cells, the file is cut off; .*; give the whole"):
        read(".csv", "\n".join([*lines, ",".join(last.split(",")[:5])]))


def test_cells_that_are_no_numbers(read):
    lines = written(".csv")
    for cell in ("1.2.3", "2001-99-99", "nan"):
        changed = [*lines[:3], ",".join([cell, *lines[3].split(",")[1:]]), *lines[4:], ""]
        with pytest.raises(BadRecordingFile, match=rf"row 2 \(line 4\): '{cell}' is not a finite number"):
            read(".csv", "\n".join(changed))


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_rates_of_another_motion_are_warned_of(suffix, tmp_path):
    """A controller that follows the velocities and accelerations of the file moves otherwise than is examined."""
    _, motion = random_motion(1)
    path = tmp_path / f"motion{suffix}"
    for field, said in (("v", "velocities"), ("a", "accelerations")):
        rates = {name: getattr(motion, name) * (2.0 if name == field else 1.0) for name in ("v", "a")}
        other = TimedMotion(motion.joint_names, motion.prismatic, motion.time, motion.q, **rates)
        path.write_bytes(document(other, path, SETTINGS))
        with pytest.warns(UserWarning, match=f"{said} of joint1, joint2, joint3 are not those of the spline") as caught:
            read_motion(path, MODEL, SETTINGS)
        assert len([one for one in caught if "spline" in str(one.message)]) == 1
