"""Integers and stamps keep their digits: time is measured from the first row before it becomes a double."""

import datetime
import gzip

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy.io import savemat

from crosscheck.recordings import (
    BadMapping,
    BadRecordingFile,
    StreamedRecording,
    inspect_recording,
    load_recording,
    mapping_of,
)
from crosscheck.recordings.checks import stamp_findings
from crosscheck.recordings.table import Cells, cells_of_column

EPOCH = 1_700_000_000_123_456_789
"""[ns] Doubles of this size are 256 ns apart."""

UNSIGNED = 2**63 + 11

N = 200
STEPS = 1_000_000 * np.arange(N) + np.arange(N) % 3
"""[ns] A millisecond, and a few nanoseconds that doubles of the stamps would lose."""

Q = np.sin(np.arange(N) / 20)


def csv(path, stamps, header="time_ns", extra=()):
    lines = [f"{header},q_1,tau_1", *(f"{stamp},{q},{k}" for k, (stamp, q) in enumerate(zip(stamps, Q, strict=True)))]
    content = ("\n".join([*lines, *extra]) + "\n").encode()
    path.write_bytes(gzip.compress(content) if path.suffix == ".gz" else content)


def write(path, start, name="time_ns"):
    stamps = [start + int(step) for step in STEPS]
    kind = np.uint64 if start > 2**63 else np.int64
    array = np.array(stamps, dtype=kind)
    if path.suffix == ".parquet":
        parquet.write_table(pa.table({name: array, "q_1": Q, "tau_1": 1.0 * np.arange(N)}), path)
    elif path.suffix == ".npz":
        np.savez(path, **{name: array, "q_1": Q, "tau_1": np.arange(N)})
    elif path.suffix == ".mat":
        savemat(path, {name: array, "q_1": Q, "tau_1": np.arange(N)})
    else:
        csv(path, stamps, name)


FILES = ["r.csv", "r.csv.gz", "r.parquet", "r.npz", "r.mat"]


@pytest.mark.parametrize("start", [EPOCH, UNSIGNED, -EPOCH])
@pytest.mark.parametrize("name", FILES)
def test_stamps_in_nanoseconds(tmp_path, name, start):
    write(tmp_path / name, start)
    recording = load_recording(tmp_path / name)
    assert np.array_equal(recording.t, STEPS * 1e-9)
    assert recording.provenance.steps == (f"time counted from the first stamp, {start * 1e-9:.6f} s",)
    assert np.array_equal(recording.q[:, 0], Q)


@pytest.mark.parametrize(("unit", "factor"), [("us", 1e-6), ("ms", 1e-3), ("s", 1.0)])
def test_stamps_since_1970_in_other_units(tmp_path, unit, factor):
    """Integers that doubles hold: their differences are exact, their products with the unit would not be."""
    start = round(1_700_000_000 / factor) + 1
    csv(tmp_path / "r.csv", start + np.arange(N), f"time_{unit}")
    assert np.array_equal(load_recording(tmp_path / "r.csv").t, np.arange(N) * factor)


@pytest.mark.parametrize("start", [2**53 + 1, 2**54 + 1])
def test_integers_just_beyond_doubles(tmp_path, start):
    csv(tmp_path / "r.csv", [start + k for k in range(N)])
    assert np.array_equal(load_recording(tmp_path / "r.csv").t, np.arange(N) * 1e-9)


def test_a_single_row(tmp_path):
    (tmp_path / "r.csv").write_text(f"time_ns,q_1\n{EPOCH},1\n")
    assert load_recording(tmp_path / "r.csv").t.tolist() == [0.0]


def test_small_times_stay_as_they_are(tmp_path):
    csv(tmp_path / "r.csv", 5_000_000_000 + STEPS)
    recording = load_recording(tmp_path / "r.csv")
    assert recording.t[0] == 5.0
    assert recording.provenance.steps == ()


def test_the_unit_of_the_mapping(tmp_path):
    csv(tmp_path / "r.csv", EPOCH + STEPS, "stamp")
    document = {"joints": ["a"], "time": {"column": "stamp", "unit": "ns"}, "q": {"columns": ["q_1"]}}
    assert np.array_equal(load_recording(tmp_path / "r.csv", mapping_of(document, "m")).t, STEPS * 1e-9)


def test_stamps_without_unit_are_refused_with_the_likely_one(tmp_path):
    csv(tmp_path / "r.csv", EPOCH + STEPS, "stamp")
    with pytest.raises(
        BadRecordingFile, match=r"time beyond 1e\+10 s .*; as ns they are dates of this century: say so"
    ):
        load_recording(tmp_path / "r.csv")
    csv(tmp_path / "r.csv", 10**25 + np.arange(N, dtype=object), "stamp")
    with pytest.raises(BadRecordingFile, match=r"time beyond 1e\+10 s .*; check the unit of time"):
        load_recording(tmp_path / "r.csv")


@pytest.mark.parametrize(
    ("first", "last", "unit"),
    [
        ("2000-01-01T00:00:01", "2099-12-31T23:59:59", "ms"),
        ("2000-01-01T00:00:01", "2099-12-31T23:59:59", "us"),
        ("2000-01-01T00:00:01", "2099-12-31T23:59:59", "ns"),
        ("1999-12-31T23:59:59", "2099-12-31T23:59:59", None),
        ("2000-01-01T00:00:01", "2100-01-01T00:00:01", None),
        ("1970-09-01", "1970-09-02", None),
    ],
)
def test_dates_of_this_century_and_no_others_tell_the_unit(first, last, unit):
    factor = {"ms": 1e3, "us": 1e6, "ns": 1e9, None: 1e3}[unit]
    stamps = np.array([first, last], dtype="M8[s]").astype(float) * factor
    (finding,) = stamp_findings("r.csv", stamps - stamps[0], np.ones(2, dtype=bool), None, origin=stamps[0])
    assert (finding.code, finding.rows) == ("implausible-value", (0, 1))
    named = f"as {unit} they are dates of this century: say so in the column's name (time_{unit}) or mapping"
    assert finding.remedy == (
        named if unit else "check the unit of time; drop the rows if lines of the file are broken"
    )


def test_one_broken_cell_costs_one_row(tmp_path):
    csv(tmp_path / "r.csv", EPOCH + STEPS, extra=["x,0,0", "1e300,0,0", f"{EPOCH + 10**9},0,0"])
    findings = {finding.code: finding.rows for finding in inspect_recording(tmp_path / "r.csv")}
    assert findings["not-a-number"] == (N,)
    assert findings["implausible-value"] == (N + 1,)
    recording = load_recording(tmp_path / "r.csv", drop=["not-a-number", "implausible-value"])
    np.testing.assert_allclose(
        recording.t[:N], STEPS * 1e-9, rtol=0, atol=3e-7
    )  # with 1e300 it is no column of integers
    csv(tmp_path / "r.csv", EPOCH + STEPS, extra=["x,0,0", f"{EPOCH + 10**9},0,0"])
    t = load_recording(tmp_path / "r.csv", drop=["not-a-number"]).t
    assert np.array_equal(t, [*(STEPS * 1e-9), 1.0])


def test_empty_cells_of_integers(tmp_path):
    stamps = pa.array([EPOCH, None, EPOCH + 2_000_001, EPOCH + 3_000_000])
    parquet.write_table(pa.table({"time_ns": stamps, "q_1": [0.0, 1, 2, 3]}), tmp_path / "r.parquet")
    with pytest.raises(BadRecordingFile, match=r"'time_ns', row 1: nan is not a finite number"):
        load_recording(tmp_path / "r.parquet")
    t = load_recording(tmp_path / "r.parquet", drop=["not-a-number"]).t
    assert t.tolist() == [0.0, 0.002000001, 0.003]


@pytest.mark.parametrize("start", [EPOCH, UNSIGNED])
@pytest.mark.parametrize("name", ["r.csv", "r.csv.gz", "r.parquet"])
def test_streamed_stamps(tmp_path, monkeypatch, name, start):
    """In parts, each of which begins with another stamp; a rounded stamp would be refused as an uneven step."""
    monkeypatch.setattr("crosscheck.recordings.formats.csv_files.BATCH_BYTES", 2000)
    write(tmp_path / name, start)
    streamed = StreamedRecording(tmp_path / name, window=50)
    joined = np.concatenate([part.t for part in streamed._parts()])
    assert len(list(streamed._parts())) > 3
    assert np.array_equal(joined, STEPS * 1e-9)
    pieces = list(streamed)
    assert sum(len(piece) for piece in pieces) == N - 8  # two borders of the difference quotient at both ends
    assert np.array_equal(np.concatenate([piece.q for piece in pieces])[:, 0], Q[4:-4])


def test_streamed_calendar_times(tmp_path):
    days = [datetime.datetime(2024, 2, 29, 23, 59, 59) + datetime.timedelta(seconds=k / 100) for k in range(N)]
    csv(tmp_path / "r.csv", [day.isoformat(sep=" ", timespec="milliseconds") for day in days], "time")
    joined = np.concatenate([part.t for part in StreamedRecording(tmp_path / "r.csv", window=50)._parts()])
    np.testing.assert_allclose(joined, np.arange(N) / 100, rtol=1e-15)


CALENDAR = np.datetime64("2024-02-29T23:59:59.000000001", "ns") + STEPS


@pytest.mark.parametrize("name", ["time", "time_ns", "time [ms]"])
def test_calendar_times_are_in_seconds_whatever_the_name_says(tmp_path, name):
    np.savez(tmp_path / "r.npz", **{name: CALENDAR, "q_1": Q})
    parquet.write_table(pa.table({name: CALENDAR, "q_1": Q}), tmp_path / "r.parquet")
    for file in ("r.npz", "r.parquet"):
        recording = load_recording(tmp_path / file)
        assert np.array_equal(recording.t, STEPS * 1e-9)
        assert not any("time in a column without unit" in finding.text for finding in recording.findings)


@pytest.mark.parametrize(
    ("kind", "numbers", "expected"),
    [
        (pa.timestamp("s"), [10**9, 10**9 + 1], [0, 1]),
        (pa.timestamp("us", tz="Europe/Berlin"), [10**15, 10**15 + 500], [0, 0.0005]),
        (pa.duration("ms"), [1, 11], [0.001, 0.011]),
        (pa.time64("ns"), [10**9, 2 * 10**9], [1, 2]),
        (pa.time32("s"), [1, 2], [1, 2]),
        (pa.date32(), [1, 2], [86400, 172800]),
        (pa.date64(), [86_400_000, 172_800_000], [86400, 172800]),
    ],
)
def test_every_type_of_time(tmp_path, kind, numbers, expected):
    times = pa.array(numbers, pa.int32() if kind.bit_width == 32 else pa.int64()).cast(kind)
    parquet.write_table(pa.table({"time": times, "q_1": [0.0, 1.0]}), tmp_path / "r.parquet")
    assert load_recording(tmp_path / "r.parquet").t.tolist() == expected
    cells = cells_of_column(times)  # Parquet has no dates in milliseconds
    assert np.diff(cells.values) * cells.seconds == pytest.approx(np.diff(expected), rel=1e-6)


def test_times_of_the_day_and_durations_as_text(tmp_path):
    csv(tmp_path / "r.csv", ["12:00:00", *(f"12:{k // 60:02}:{k % 60:02}" for k in range(1, N))], "time")
    assert np.array_equal(load_recording(tmp_path / "r.csv").t, 43200.0 + np.arange(N))
    csv(tmp_path / "r.csv", [f"{k / 100:g} sec" for k in range(N)], "Time")  # as MATLAB's writetimetable
    assert np.array_equal(load_recording(tmp_path / "r.csv").t, np.arange(N) / 100)


def test_times_are_no_positions(tmp_path):
    (tmp_path / "r.csv").write_text("t,q_1\n0,2024-01-01 00:00:01\n1,2024-01-01 00:00:02\n")
    with pytest.raises(BadMapping, match=r"by name, \[q\]: 'q_1' of .*r.csv holds times; name another column"):
        load_recording(tmp_path / "r.csv")


@pytest.mark.parametrize(
    ("unit", "seconds"),
    [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("s", 1), ("m", 60), ("h", 3600), ("D", 86400), ("10ms", 0.01)],
)
def test_units_of_numpy_times(tmp_path, unit, seconds):
    np.savez(tmp_path / "r.npz", time=np.array([0, 1, 2], dtype=f"m8[{unit}]"), q=np.ones((3, 2)))
    np.testing.assert_allclose(load_recording(tmp_path / "r.npz").t, [0, seconds, 2 * seconds], rtol=1e-15)


def test_numpy_times_in_months_are_refused(tmp_path):
    np.savez(tmp_path / "r.npz", time=np.arange(3).astype("M8[M]"), q=np.ones((3, 2)))
    with pytest.raises(
        BadMapping, match=r"'time' is the quantity time by its name, but not read: it holds times in the unit 'M'"
    ):
        load_recording(tmp_path / "r.npz")


def test_times_that_are_missing(tmp_path):
    stamps = np.array(["2024-01-01", "NaT", "2024-01-03"], dtype="M8[s]")
    np.savez(tmp_path / "r.npz", time=stamps, q_1=np.arange(3.0))
    assert load_recording(tmp_path / "r.npz", drop=["not-a-number"]).t.tolist() == [0.0, 172800.0]


@pytest.mark.parametrize(
    ("column", "expected"),
    [
        (pa.array([-(2**63), 2**63 - 1]), [-(2.0**63), 2.0**63]),
        (pa.array([2**64 - 1, 0], pa.uint64()), [2.0**64, 0.0]),
        (pa.array(["18446744073709551615", " +18446744073709551614 ", "y"]), [2.0**64, 2.0**64, np.nan]),
        (pa.array([2**53, None]), [2.0**53, np.nan]),
        (pa.array(["-0", "0"]), [-0.0, 0.0]),
        (pa.array(["1700000000000000001", "0.5"]), [1.7e18, 0.5]),
        (pa.array([None, None]), [np.nan, np.nan]),
        (pa.array([], pa.int64()), []),
    ],
)
def test_as_doubles_integers_are_rounded_once(column, expected):
    for cells in (cells_of_column(column), cells_of_column(pa.chunked_array([column]))):
        assert isinstance(cells, Cells)
        assert np.array_equal(cells.doubles, expected, equal_nan=True)
        assert np.array_equal(np.signbit(cells.doubles), np.signbit(expected))


def test_integers_beyond_doubles_are_no_positions(tmp_path):
    (tmp_path / "r.csv").write_text("t,q_1\n0,9007199254740993\n1,9007199254740994\n")
    with pytest.raises(BadRecordingFile, match=r"\|q\| of 'joint_1' up to 9.01e\+15, beyond 10000"):
        load_recording(tmp_path / "r.csv")
