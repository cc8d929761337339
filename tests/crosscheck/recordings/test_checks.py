"""Dirty data: each fault is found in its rows, reported with them, and dropped only when asked or when harmless."""

import numpy as np
import pytest

from crosscheck.recordings import (
    DROPPABLE,
    BadRecordingFile,
    DirtyRecording,
    inspect_recording,
    load_recording,
    mapping_of,
)
from crosscheck.recordings.checks import increasing, motion_findings, value_findings
from crosscheck.recordings.errors import reason, spans
from graphdyn import InvalidInput

N = 60
T = np.arange(N) * 0.01
GOOD = np.column_stack([T, np.sin(5 * T), 5 * np.cos(5 * T), np.cos(9 * T)])
HEADER = "t_s,q_1_rad,v_1_rad_s,tau_1_Nm"


def lines_of(table):
    return [",".join(map(repr, row)) for row in np.asarray(table).tolist()]


def written(folder, lines, end="\n", header=HEADER):
    path = folder / "r.csv"
    path.write_text("\n".join([header, *lines]) + end)
    return path


def changed(folder, change):
    table = GOOD.copy()
    change(table)
    return written(folder, lines_of(table))


def only(path, code, **options):
    """The one finding of the file, which has this code."""
    (finding,) = inspect_recording(path, **options)
    assert finding.code == code
    return finding


def test_a_good_file_has_no_findings(tmp_path):
    recording = load_recording(written(tmp_path, lines_of(GOOD)))
    assert recording.findings == ()
    assert recording.provenance.steps == ()
    assert np.array_equal(recording.block, np.zeros(N))


def test_wrong_column_counts(tmp_path):
    lines = lines_of(GOOD)
    lines[7], lines[8], lines[30] = "1,2", "0.08,1,2,3,4,5", "0.3,1"
    path = written(tmp_path, lines)
    finding = only(path, "wrong-column-count")
    assert finding.rows == (7, 8, 30)
    rows = "rows 7–8, 30 (lines 9–10, 32)"
    assert finding.text == (
        f"{path}, {rows}: 2, 6 cells instead of 4; repair the lines, or drop them [wrong-column-count]"
    )
    with pytest.raises(DirtyRecording, match=r"rows 7–8, 30 \(lines 9–10, 32\): 2, 6 cells") as refusal:
        load_recording(path)
    assert refusal.value.findings == (finding,)
    recording = load_recording(path, drop=["wrong-column-count"])
    assert recording.rows.tolist() == [row for row in range(N) if row not in (7, 8, 30)]
    assert np.array_equal(recording.q[:, 0], GOOD[recording.rows, 1])
    assert recording.provenance.steps == (f"dropped wrong-column-count: rows 7–8, 30 of {path}",)


@pytest.mark.parametrize(("end", "last"), [("", "0.59,1"), ("\n", "0.59,1"), ("", "0.59,1,2,"), ("", "0.59,1,2,1e-")])
def test_a_truncated_last_line_does_no_harm(tmp_path, end, last):
    path = written(tmp_path, [*lines_of(GOOD[:-1]), last], end)
    finding = only(path, "truncated-last-line")
    assert finding.severity == "warning"
    assert finding.rows == (N - 1,)
    assert "the file is cut off" in finding.message
    assert finding.remedy == "the line is left out"
    recording = load_recording(path)
    assert len(recording.t) == N - 1
    assert recording.provenance.steps == (f"dropped truncated-last-line: rows 59 of {path}",)


@pytest.mark.parametrize("end", ["", "\n"])
def test_a_last_line_with_surplus_cells_is_not_cut_off(tmp_path, end):
    path = written(tmp_path, [*lines_of(GOOD[:-1]), "0.59,1,2,3,4"], end)
    finding = only(path, "wrong-column-count")
    assert (finding.severity, finding.rows, finding.message) == ("error", (N - 1,), "5 cells instead of 4")


def test_a_last_line_without_an_end_stays_unless_asked(tmp_path):
    path = written(tmp_path, lines_of(GOOD), end="")
    finding = only(path, "unterminated-last-line")
    assert finding.text == (
        f"{path}, row 59 (line 61): the last line has no line end, so its last number may be cut off; "
        "drop it if it is [unterminated-last-line]"
    )
    assert len(load_recording(path).t) == N
    assert len(load_recording(path, drop=["unterminated-last-line"]).t) == N - 1


def test_empty_lines_do_no_harm(tmp_path):
    lines = lines_of(GOOD)
    lines.insert(10, "")
    path = written(tmp_path, [*lines, ""])
    finding = only(path, "blank-line")
    assert finding.text == f"{path}, rows 10, 61 (lines 12, 63): an empty line; it is left out [blank-line]"
    assert np.array_equal(load_recording(path).t, T)


def test_no_header(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("\n".join(lines_of(GOOD)) + "\n")
    mapping = mapping_of({"joints": ["a"], "time": {"column": 1}, "q": {"columns": [2]}}, "m")
    finding = only(path, "no-header", mapping=mapping)
    assert finding.text == (
        f"{path}: the first line holds numbers, so the columns have no names; "
        "they can be mapped by number only [no-header]"
    )
    assert np.array_equal(load_recording(path, mapping).q[:, 0], GOOD[:, 1])


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        (["nan"], r"'q_1_rad', row 20 \(line 22\): 'nan' is not a finite number; repair the rows, or drop them"),
        (["inf"], r"row 20 \(line 22\): inf is not a finite number"),
        ([""], r"row 20 \(line 22\): an empty cell is not a finite number"),
        (["x", "2.0.0"], r"rows 20–21 \(lines 22–23\): 'x' and others are not finite numbers"),
    ],
)
def test_cells_without_a_number(tmp_path, cells, message):
    lines = lines_of(GOOD)
    for k, cell in enumerate(cells, start=20):
        lines[k] = ",".join([str(T[k]), cell, *lines[k].split(",")[2:]])
    path = written(tmp_path, lines)
    with pytest.raises(DirtyRecording, match=message):
        load_recording(path)
    assert only(path, "not-a-number").rows == tuple(range(20, 20 + len(cells)))
    assert len(load_recording(path, drop=["not-a-number"]).t) == N - len(cells)


def test_columns_that_are_not_mapped_may_hold_anything(tmp_path):
    path = written(tmp_path, [line + ",x" for line in lines_of(GOOD)], header=HEADER + ",comment")
    assert inspect_recording(path) == ()


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        (1, 1e157, r"\|q\| of 'joint_1' up to 1e\+157, beyond 10000 \(1600 turns in one direction\)"),
        (2, -1e157, r"\|v\| of 'joint_1' up to 1e\+157, beyond 1000 \(ten times the fastest direct drive"),
        (3, 2e6, r"\|tau\| of 'joint_1' up to 2e\+06, beyond 1e\+06 \(ten times what the main axes"),
        (0, 1e157, r"time beyond 1e\+10 s \(300 years after 1970\)"),
    ],
)
def test_misframed_rows(tmp_path, column, value, message):
    def change(table):
        table[[33, 40], column] = value

    path = changed(tmp_path, change)
    assert only(path, "implausible-value").rows == (33, 40)
    with pytest.raises(DirtyRecording, match=rf"rows 33, 40 \(lines 35, 42\): {message}.*; check"):
        load_recording(path)
    assert load_recording(path, drop=["implausible-value"]).rows.tolist() == [r for r in range(N) if r not in (33, 40)]


def test_repeated_and_backward_stamps(tmp_path):
    def change(table):
        table[10, 0] = table[9, 0]
        table[20, 0] = 0.155
        table[30, 0] = 7.0

    path = changed(tmp_path, change)
    repeated, backward = inspect_recording(path)
    assert repeated.text == (
        f"{path}, row 10 (line 12): a repeated stamp; drop the rows: the first of each stays [repeated-stamp]"
    )
    assert backward.text == (
        f"{path}, rows 20, 30 (lines 22, 32): a stamp out of order; drop the rows, or split the file where "
        "its clock was set back [backward-stamp]"
    )
    with pytest.raises(DirtyRecording, match=r"(?s)a stamp out of order"):
        load_recording(path, drop=["repeated-stamp"])
    recording = load_recording(path, drop=["repeated-stamp", "backward-stamp"])
    assert recording.rows.tolist() == [row for row in range(N) if row not in (10, 20, 30)]


def test_the_fewest_rows_are_dropped():
    for stamps in ([0, 1, 2], [0, 1, 1, 2], [0, 9, 1, 2, 3], [5, 0, 1, 2], [0, 1, 2, 0.5, 3], [3, 2, 1], [1, 1, 1]):
        t = np.array(stamps, dtype=float)
        kept = increasing(t)
        assert np.all(np.diff(t[kept]) > 0)
        subsets = [[bool(bits >> k & 1) for k in range(len(t))] for bits in range(1 << len(t))]
        assert kept.sum() == max(sum(s) for s in subsets if np.all(np.diff(t[np.array(s)]) > 0))
    assert increasing(np.array([0, 1, 1, 2.0])).tolist() == [True, True, False, True]


def test_gaps_missing_samples_and_jitter(tmp_path):
    def change(table):
        table[20:, 0] += 0.02
        table[40:, 0] += 1.0
        table[30, 0] += 0.002
        table[:, 1] = np.sin(5 * table[:, 0])
        table[:, 2] = 5 * np.cos(5 * table[:, 0])

    path = changed(tmp_path, change)
    found = {finding.code: finding for finding in inspect_recording(path)}
    assert {code: finding.rows for code, finding in found.items()} == {
        "gap": (40,),
        "missing-samples": (20,),
        "jitter": (30, 31),
    }
    assert (
        "a gap before it, up to 1.01 s, where the period is 0.01 s; the recording is divided there" in found["gap"].text
    )
    assert "samples are missing before it; resampling interpolates there" in found["missing-samples"].text
    assert "steps differ from the period of 0.01 s by up to 20%; resampling makes them even" in found["jitter"].text
    recording = load_recording(path)
    assert recording.block.tolist() == [0] * 40 + [1] * 20
    assert [(rows.start, rows.stop) for rows in recording.block_slices] == [(0, 40), (40, 60)]


def test_a_rate_that_contradicts_the_stamps(tmp_path):
    path = written(tmp_path, lines_of(GOOD))
    mapping = mapping_of({"joints": ["a"], "rate": 125, "time": {"column": 1}, "q": {"columns": [2]}}, "m")
    finding = only(path, "other-rate", mapping=mapping)
    assert finding.message == "the rate of the stamps is 100 Hz, that of the mapping 125 Hz"
    assert finding.remedy == "the stamps are used; correct the rate"


def test_channels_that_say_nothing(tmp_path):
    def change(table):
        table[:, 1] = 0.5
        table[:, 2] = 0.0

    path = changed(tmp_path, change)
    constant, zero = inspect_recording(path)
    assert (constant.code, zero.code) == ("constant-channel", "all-zero-channel")
    assert constant.text.startswith(
        f"{path}, column 'q_1_rad': 0.5 in all rows; its joint is not excited, or its sensor"
    )
    assert zero.text.startswith(
        f"{path}, column 'v_1_rad_s': zero in all rows; leave the channel out of the mapping if"
    )
    assert len(load_recording(path).t) == N


def test_saturation(tmp_path):
    def change(table):
        table[:, 3] = np.clip(table[:, 3], -0.8, 2)

    path = changed(tmp_path, change)
    finding = only(path, "saturation")
    assert finding.rows == tuple(np.flatnonzero(np.cos(9 * T) <= -0.8))
    assert finding.message == "held at -0.8, the end of its range, for 5 rows or more"
    assert finding.remedy == "the drive or the sensor is saturated; drop the rows, or record slower motion"
    assert finding.severity == "warning"
    assert len(load_recording(path).t) == N
    assert len(load_recording(path, drop=["saturation"]).t) == N - len(finding.rows)


def test_velocities_of_another_unit(tmp_path):
    def change(table):
        table[:, 2] = np.rad2deg(table[:, 2])

    finding = only(changed(tmp_path, change), "velocity-mismatch")
    assert finding.message.startswith("v of 'joint_1' is not the rate of its q: its integral is off by 56")
    assert finding.remedy.startswith("check units, signs and order of the columns, or leave v out of the mapping")


def test_degrees_taken_for_radians(tmp_path):
    def change(table):
        table[:, 1:3] = np.rad2deg(table[:, 1:3])

    finding = only(changed(tmp_path, change), "many-turns")
    assert finding.message == "q of 'joint_1' reaches 57.28 rad"
    assert finding.remedy == "if these are degrees, or motor angles in front of the gears, say so in a mapping"


@pytest.mark.parametrize(
    ("slides", "largest", "found"),
    [
        (False, 39, []),
        (False, 41, [("many-turns", (), "q of 'a' reaches 41 rad")]),
        (True, 101.0, []),
        (
            False,
            10_001.0,
            [("implausible-value", (1,), "|q| of 'a' up to 1e+04, beyond 10000 (1600 turns in one direct")],
        ),
        (True, 1001.0, [("implausible-value", (1,), "|q| of 'a' up to 1e+03, beyond 1000 (a kilometer of rail)")]),
    ],
)
def test_slides_make_no_turns(slides, largest, found):
    q = np.array([0.5, -largest, 0.1])[:, None]
    said = list(value_findings("r.csv", ["a"], [slides], {"q": q, "tau": q / largest}, None))
    assert [(finding.code, finding.rows) for finding in said] == [(code, rows) for code, rows, _ in found]
    assert all(finding.message.startswith(words) for finding, (*_, words) in zip(said, found, strict=True))


def test_rows_for_unknown_reasons_are_not_dropped(tmp_path):
    path = written(tmp_path, lines_of(GOOD))
    with pytest.raises(
        InvalidInput, match=r"drop has 'gap'; rows can be dropped for: truncated-last-line, blank-line, "
    ):
        load_recording(path, drop=["gap"])
    assert len(load_recording(path, drop=DROPPABLE).t) == N


def test_files_without_lines(tmp_path):
    q = np.sin(T)
    q[[3, 5]] = np.nan
    np.savez(tmp_path / "r.npz", time_s=T, q=q)
    mapping = mapping_of({"joints": ["a"], "time": {"column": "time_s"}, "q": {"columns": ["q"]}}, "m")
    finding = only(tmp_path / "r.npz", "not-a-number", mapping=mapping)
    path = tmp_path / "r.npz"
    assert finding.text == (
        f"{path}, column 'q', rows 3, 5: nan and others are not finite numbers; "
        "repair the rows, or drop them [not-a-number]"
    )


def test_a_single_row(tmp_path):
    recording = load_recording(written(tmp_path, lines_of(GOOD[:1])))
    assert recording.findings == ()
    assert len(recording.t) == 1


def test_no_row_left(tmp_path):
    path = written(tmp_path, ["0,nan,1,1", "1,nan,1,1"])
    with pytest.raises(BadRecordingFile, match=r"r.csv: no row is left; repair the file instead of dropping rows"):
        load_recording(path, drop=["not-a-number"])


def test_spans_of_rows():
    assert spans([3]) == "3"
    assert spans([3, 4, 5, 9, 11, 12]) == "3–5, 9, 11–12"
    assert spans(range(0, 20, 2)) == "0, 2, 4, 6, 8, … (10 in all)"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ValueError(" two\n lines "), "two lines"),
        (KeyError(), "KeyError"),
        (OSError("  \n"), "OSError"),
        (ValueError("a" * 150 + "b" * 150), "a" * 100 + " … " + "b" * 100),
        (ValueError("a" * 100 + "b" * 100), "a" * 100 + "b" * 100),
    ],
    ids=["lines", "nothing", "blank", "long", "just whole"],
)
def test_what_a_library_says(error, said):
    assert reason(error) == said


def test_a_long_cell_is_shortened(tmp_path):
    """Of a hundred thousand characters the message has both ends."""
    path, cell = tmp_path / "log.csv", f"begin{'x' * 100_000}end"
    rows = [*(f"{k}.0,0.1,0.2" for k in range(5)), f"5.0,{cell},0.2"]
    path.write_text("\n".join(["t,q_1,tau_1", *rows, ""]), encoding="utf-8")
    with pytest.raises(DirtyRecording, match=r"'begin[x.]+end' is not a finite number") as caught:
        load_recording(path)
    assert len(str(caught.value)) < 1000


def test_velocities_are_integrated_by_trapezoids():
    """Which are exact for v = t and q = t²/2, whatever the step; a velocity twice as large is off by all of it."""
    t, block, names = 0.1 * np.arange(8), np.zeros(8, dtype=int), ["a"]
    q, v = t[:, None] ** 2 / 2, t[:, None]
    assert list(motion_findings("m.csv", names, t, block, q, v)) == []
    (finding,) = motion_findings("m.csv", names, t, block, q, 2 * v)
    assert finding.message == "v of 'a' is not the rate of its q: its integral is off by 100%"
