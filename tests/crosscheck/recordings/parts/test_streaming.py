"""Recordings read in windows: the same samples as those of the whole file, and the same estimate."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from identified import identified_arm
from identified.identified_arm import virtual
from pyarrow import parquet

from crosscheck.recordings import (
    BadRecordingFile,
    StreamedRecording,
    differentiated,
    load_recording,
    lowpass,
    samples_of,
)
from crosscheck.recordings.preparation.resampling import PERIOD_TOLERANCE
from graphdyn import InvalidInput
from graphdyn.identification import Problem, WeightedLeastSquares

CUTOFF, WINDOW = 20.0, 700

FORGOTTEN = 1e-4
"""Relative difference between windows: two borders leave BORDER_DECAY², which two derivatives enlarge."""


@pytest.fixture(scope="module")
def columns():
    return identified_arm.columns()


@pytest.fixture
def files(tmp_path, columns):
    parquet.write_table(pa.table(columns), tmp_path / "log.parquet")
    header = ",".join(columns)
    np.savetxt(tmp_path / "log.csv", np.column_stack(list(columns.values())), delimiter=",", header=header, comments="")
    return tmp_path


@pytest.mark.parametrize("name", ["log.parquet", "log.csv"])
def test_pieces_are_those_of_the_whole_file(files, name, monkeypatch):
    monkeypatch.setattr(
        "crosscheck.recordings.formats.csv_files.BATCH_BYTES", 20_000
    )  # a CSV file is parsed in many parts too
    whole = differentiated(load_recording(files / name), CUTOFF)
    streamed = StreamedRecording(files / name, cutoff=CUTOFF, window=WINDOW)
    for _ in range(2):
        pieces = list(streamed)
        assert len(pieces) >= 4
        joined = {key: np.concatenate([getattr(p, key) for p in pieces]) for key in ("q", "v", "a", "tau")}
        assert len(joined["q"]) == len(whole.t)
        for key, values in joined.items():
            expected = getattr(whole, key)
            assert np.abs(values - expected).max() <= FORGOTTEN * np.abs(expected).max(), key


def test_same_estimate(files):
    arm = virtual()
    names = arm.subject.model.joint_names
    whole = differentiated(load_recording(files / "log.parquet", joints=names), CUTOFF)
    data = StreamedRecording(files / "log.parquet", joints=names, cutoff=CUTOFF, window=WINDOW)
    here, there = (Problem(arm.torque_model, x) for x in (samples_of(whole), data))
    x, y = (problem.base.values(WeightedLeastSquares().estimate(problem).parameters) for problem in (here, there))
    scale = np.linalg.norm(here.equations.factors[..., :-1], axis=(0, 1))
    assert there.equations.counts.tolist() == here.equations.counts.tolist()
    assert np.abs((x - y) * scale).max() <= FORGOTTEN * np.abs(x * scale).max()


def test_the_torque_is_filtered_across_windows(files):
    """Streamed pieces carry the filter and continue each other: the filtered equations are those of the whole file."""
    whole = differentiated(load_recording(files / "log.parquet"), CUTOFF)
    pieces = list(StreamedRecording(files / "log.parquet", cutoff=CUTOFF, window=WINDOW))
    assert [piece.continues for piece in pieces] == [False] + [True] * (len(pieces) - 1)
    model = virtual().torque_model
    (here,), (there,) = (
        [np.concatenate([rows.right for rows in Problem(model, data).rows()])] for data in (samples_of(whole), pieces)
    )
    expected = lowpass(whole.tau, 250.0, CUTOFF)
    np.testing.assert_allclose(here, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-5 * np.abs(expected).max())


def test_a_border_that_is_not_kept_would_show(columns):
    """Windows without overlap differ by more than FORGOTTEN allows."""
    q = np.column_stack([columns["q_1"]])
    rate = 250.0
    whole = lowpass(q, rate, 2.0)[WINDOW - 50 : WINDOW]
    alone = lowpass(q[:WINDOW], rate, 2.0)[-50:]
    assert np.abs(whole - alone).max() > FORGOTTEN * np.abs(whole).max()


class TestRefusals:
    def changed(self, tmp_path, columns, row, **cells):
        table = {name: values.copy() for name, values in columns.items()}
        for name, value in cells.items():
            table[name][row] = value
        parquet.write_table(pa.table(table), tmp_path / "bad.parquet")
        return StreamedRecording(tmp_path / "bad.parquet", cutoff=CUTOFF, window=WINDOW)

    def test_not_a_number(self, tmp_path, columns):
        with pytest.raises(InvalidInput, match=r"bad.parquet, row 1234: not a number; load_recording drops such rows"):
            list(self.changed(tmp_path, columns, 1234, q_1=np.nan))

    @pytest.mark.parametrize(
        ("cells", "said"),
        [
            ({"q_1": 1e12}, r"\|q\| of .* up to 1e\+12, beyond 10000 \(1600 turns in one direction\)"),
            ({"time_s": 1e11}, r"time beyond 1e\+10 s \(300 years after 1970\)"),
        ],
    )
    def test_implausible(self, tmp_path, columns, cells, said):
        """What load_recording does not accept either."""
        with pytest.raises(InvalidInput, match=rf"bad.parquet, row {len(columns['q_1']) - 1}: {said}"):
            list(self.changed(tmp_path, columns, -1, **cells))

    @pytest.mark.parametrize("row", [0, 1233], ids=["backward", "repeated"])
    def test_backward(self, tmp_path, columns, row):
        with pytest.raises(InvalidInput, match=r"row 1233: the time does not increase after it"):
            list(self.changed(tmp_path, columns, 1234, time_s=columns["time_s"][row]))

    @pytest.mark.parametrize("row", [0, WINDOW - 1], ids=["backward", "repeated"])
    def test_backward_between_two_windows(self, tmp_path, columns, row):
        time = columns["time_s"][row]
        with pytest.raises(InvalidInput, match=rf"bad.parquet: the time goes back to {time:g} s; repair the file"):
            list(self.changed(tmp_path, columns, WINDOW, time_s=time))

    def test_uneven(self, tmp_path, columns):
        t = columns["time_s"][1234] + 0.002
        with pytest.raises(InvalidInput, match=r"after row 1233 the time steps by 0.006 s instead of 0.004 s"):
            list(self.changed(tmp_path, columns, 1234, time_s=t))

    @pytest.mark.parametrize(("share", "refused"), [(0.9, False), (1.1, True)])
    def test_a_part_of_the_period_decides_what_is_uneven(self, tmp_path, columns, share, refused):
        """Whatever the rate: here ten thousand rows per second."""
        fast = columns | {"time_s": columns["time_s"] / 40}
        late = fast["time_s"][1234] + share * PERIOD_TOLERANCE * 1e-4
        streamed = replace(self.changed(tmp_path, fast, 1234, time_s=late), cutoff=None)
        if refused:
            with pytest.raises(InvalidInput, match="after row 1233 the time steps by"):
                list(streamed)
        else:
            assert sum(map(len, streamed)) == len(columns["time_s"]) - 8, "two difference quotients of five points"

    def test_rate(self, files):
        with pytest.raises(InvalidInput, match="rate is 0; give samples per second"):
            list(StreamedRecording(files / "log.parquet", rate=0))

    def test_a_window_shorter_than_its_borders(self, files):
        with pytest.raises(InvalidInput, match=r"a window of 100 rows is too short for the borders"):
            list(StreamedRecording(files / "log.parquet", cutoff=CUTOFF, window=100))

    def test_files(self, tmp_path, columns):
        (tmp_path / "log.mat").write_bytes(b"x")
        (tmp_path / "log.csv").write_text("t,q_1,tau_1\n0,1,2\n1,x,3\n", encoding="utf-8")
        parquet.write_table(pa.table(columns)[:0], tmp_path / "empty.parquet")
        with pytest.raises(BadRecordingFile, match=r"only .csv, .csv.gz, .parquet, .pq files are streamed; convert"):
            list(StreamedRecording(tmp_path / "log.mat"))
        with pytest.raises(BadRecordingFile, match=r"log.csv: .*load_recording gives details, or repair the file"):
            list(StreamedRecording(tmp_path / "log.csv"))
        with pytest.raises(BadRecordingFile, match=r"empty.parquet: no rows; record at least one"):
            list(StreamedRecording(tmp_path / "empty.parquet"))
        with pytest.raises(FileNotFoundError, match="no such file"):
            list(StreamedRecording(tmp_path / "none.csv"))
