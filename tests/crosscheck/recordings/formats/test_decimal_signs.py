"""Decimal signs of text files: read as written, or refused with column, line and cell until the mapping tells."""

import gzip

import numpy as np
import pytest

from crosscheck.recordings import BadMapping, BadRecordingFile, StreamedRecording, inspect_recording, load_recording
from crosscheck.recordings.formats import csv_files
from crosscheck.recordings.mapping.mapping import mapping_of

GERMAN = "t;q1;tau1\n0,00;0,49;1.677\n0,01;0,50;-975\n0,02;0,51;-1.100\n"


def mapped(decimal=None):
    given = {"decimal": decimal} if decimal else {}
    columns = {name: {"columns": [name + "1"]} for name in ("q", "tau")}
    return mapping_of({"joints": ["a"], "time": {"column": "t"}, **columns, **given}, "m.toml")


def written(folder, text, name="r.csv"):
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GERMAN, r"line 2, column 'tau1': '1.677' has a point, and '0,00' \(line 2, column 't'\) a comma"),
        (
            "t;q1;tau1\n0.025;0.1;2\n0.026;1;2,848\n",
            r"'0.025' has a point, and '2,848' \(line 3, column 'tau1'\) a",
        ),
        ("t\tq1\ttau1\n0\t1,5\t2\n1\t2,5\t1.5\n", r"line 3, column 'tau1': '1.5' has a point, and '1,5' \(line 2, c"),
        ('t,q1,tau1\n"0,5","0,1","1.677"\n', r"'1.677' has a point, and '0,5' \(line 2, column 't'\) a comma"),
        ("t;q1;tau1\n0;1;1.677\n1;2;-975\n", r"line 2, column 'tau1': '1.677' is a decimal, or the point separates th"),
        (
            "t;q1;tau1\n0.5;1.677;-975\n1.5;2.848;1.677\n",
            r"line 3, column 'tau1': '1.677' is a decimal, or the point sep",
        ),
        (
            "t;q1;tau1\n0.5;0.1;1.677\n1.5;0.2;\n2.5;0.3;-975\n",  # an empty cell tells nothing
            r"line 2, column 'tau1': '1.677' is a decimal, or the point sep",
        ),
        ("t;q1;tau1\n0;1;1,677\n1;2;2,975\n", r"line 2, column 'tau1': '1,677' is a decimal, or the comma separates"),
        (
            "t,q1,tau1\n0.5,1,1\n1.5,2,2.125\n",
            r"line 3, column 'tau1': '2.125' .*; '1' in the same column has no",
        ),
        ("t;q1;tau1\n0;0,5;1.677,25\n", r"line 2, column 'tau1': '1.677,25' has both a point and a comma"),
        ("0;1;1.677\n1;2;-975\n", r"line 1, column 3: '1.677' is a decimal, or the point separates thousands"),
        ("t;q1;tau1\n" + "1;2;3\n" * 61 + "1;2;-1.677\n", r"line 63, column 'tau1': '-1.677' is a decimal"),
    ],
)
def test_a_file_that_does_not_tell_its_decimal_sign_is_refused(tmp_path, text, message):
    with pytest.raises(BadRecordingFile, match=message) as error:
        load_recording(written(tmp_path, text))
    assert 'say which in a mapping: decimal = "." or decimal = ","' in str(error.value)


def test_the_mapping_tells_the_decimal_sign(tmp_path):
    assert load_recording(written(tmp_path, GERMAN), mapped(",")).tau[:, 0].tolist() == [1677.0, -975.0, -1100.0]
    doubtful = written(tmp_path, "t;q1;tau1\n0;1;1.677\n1;2;-975\n")
    assert load_recording(doubtful, mapped(".")).tau[:, 0].tolist() == [1.677, -975.0]
    assert load_recording(doubtful, mapped(",")).tau[:, 0].tolist() == [1677.0, -975.0]
    both = written(tmp_path, "t;q1;tau1\n0;0,5;234.677,25\n1;0,25;-975\n")
    assert load_recording(both, mapped(",")).tau[:, 0].tolist() == [234677.25, -975.0]
    quoted = written(tmp_path, 't,q1,tau1\n"0","0,5","1.677"\n"1","0,25","-9,5"\n')
    assert load_recording(quoted, mapped(",")).tau[:, 0].tolist() == [1677.0, -9.5]


@pytest.mark.parametrize("cell", ["0.677", "1.67", "01.677", "1.6777", "12345.678", "1.677e3"])
def test_with_the_other_sign_a_cell_that_is_no_thousands_is_no_number(tmp_path, cell):
    path = written(tmp_path, f"t;q1;tau1\n0;0,5;{cell}\n1;0,25;-975\n")
    with pytest.raises(BadRecordingFile, match=rf"column 'tau1', row 0 \(line 2\): '{cell}' is not a finite number"):
        load_recording(path, mapped(","))


def test_a_decimal_sign_that_is_none(tmp_path):
    with pytest.raises(BadMapping, match=r"m.toml: decimal is ';'; give the decimal sign of the file"):
        mapped(";")


@pytest.mark.parametrize(
    "text",
    [
        "t,q1,tau1\n0.000,12.345,1.677\n0.004,12.346,-975.125\n",  # three decimals everywhere
        "t,q1,tau1\n0,1.677,1\n1,2.848,2\n",  # with commas between cells the point is the decimal sign
        "t;q1;tau1\n0;1.677;1\n1;2.848;0.5\n",
        "t;q1;tau1\n0;1.677;1\n1;2.84;1677\n",
        "t;q1;tau1\n0;0.5;1.677\n1;0.25;1677\n",  # thousands that nothing separates
        "t;q1;tau1\n0;0.5;1.677\n1;0.25;0\n",  # a zero has no thousands in any file
        "t;q1;tau1;note\n0;0.5;0.677;up 1,5 mm\n1;0.25;0;1.2.3, 4\n",
    ],
)
def test_a_file_that_tells_is_read_as_written(tmp_path, text):
    path = written(tmp_path, text)
    delimiter = ";" if ";" in text else ","
    rows = [line.split(delimiter)[:3] for line in text.splitlines()[1:]]
    recording = load_recording(path, mapped())
    assert np.array_equal(np.column_stack([recording.t, recording.q, recording.tau]), np.array(rows, dtype=float))


def test_a_column_without_a_decimal_sign_in_the_head_is_read_as_a_stream_alike(tmp_path, monkeypatch):
    monkeypatch.setattr(csv_files, "HEAD_BYTES", 4096)
    monkeypatch.setattr(csv_files, "BATCH_BYTES", 8192)
    rows = [f"{0.01 * k:.2f};0.5;{-100 - k % 50}" for k in range(2000)]
    path = written(tmp_path, "\n".join(["t;q1;tau1", *rows, "20.00;0.5;1.677", *rows, "20.01;0.5;1.678", ""]))
    message = r"r.csv, row 2000, column 'tau1': '1.677' is a decimal, or the point .*; '-100' in the same column"
    with pytest.raises(BadRecordingFile, match=message):
        list(StreamedRecording(path)._parts())
    path = written(tmp_path, GERMAN)
    packed = tmp_path / "r.csv.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for file in (path, packed):
        with pytest.raises(BadRecordingFile, match=r"'1.677' has a point, and '0,00'"):
            list(StreamedRecording(file)._parts())
        (part,) = StreamedRecording(file, mapping=mapped(","))._parts()
        assert part.tau[:, 0].tolist() == [1677.0, -975.0, -1100.0]


@pytest.mark.parametrize("cell", ["1_0", "0x10", "1e400", "١٢", "nan", "inf", "1.2.3", "- 1", "+-1", "1e", "0,5,1"])
def test_what_is_no_number_is_refused(tmp_path, cell):
    path = written(tmp_path, f"t;q1;tau1\n0;0.5;1.5\n1;0.25;{cell}\n")
    with pytest.raises(BadRecordingFile, match=r"column 'tau1', row 1 \(line 3\): .* is not a finite number"):
        load_recording(path)
    assert any(finding.code == "not-a-number" for finding in inspect_recording(path))
