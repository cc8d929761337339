"""Train and test in whole pieces: by time, by rows, by file, in blocks; never row by row."""

import numpy as np
import pytest

from crosscheck.recordings import (
    Provenance,
    Recording,
    concatenated,
    fold_numbers,
    split_by_file,
    split_by_rows,
    split_by_time,
    time_folds,
)
from graphdyn import InvalidInput


def record(name="a.csv", count=100, first=0):
    t = np.arange(count) / 10
    return Recording(("j",), t, t[:, None], rows=np.arange(count) + first, provenance=Provenance((name,)))


def test_by_time():
    split = split_by_time(record(), train=(0, 6), test=(6, 9))
    assert split.train.t[[0, -1]].tolist() == [0.0, 5.9]
    assert split.test.t[[0, -1]].tolist() == [6.0, 8.9]
    assert split.train.provenance.steps == ("for the fit: time 0 to 6 s",)
    assert split.test.provenance.steps == ("for the test: time 6 to 9 s",)


def test_by_rows_of_the_file():
    split = split_by_rows(record(first=50).take(slice(5, None)), train=(60, 70), test=(100, 150))
    assert split.train.rows.tolist() == list(range(60, 70))
    assert split.test.rows.tolist() == list(range(100, 150))


def test_by_file():
    both = concatenated([record("a.csv"), record("b.csv"), record("c.csv")])
    split = split_by_file(both, test=["b.csv"])
    assert np.unique(split.train.file).tolist() == [0, 2]
    assert np.unique(split.test.file).tolist() == [1]
    assert len(split.train.block_slices) == 2
    with pytest.raises(InvalidInput, match=r"'d.csv' is not a file of the recording; it has a.csv, b.csv, c.csv"):
        split_by_file(both, test=["d.csv"])
    with pytest.raises(InvalidInput, match=r"no file is named; it has a.csv"):
        split_by_file(both, test=[])
    with pytest.raises(InvalidInput, match=r"all files of the recording are for the test; leave one to fit"):
        split_by_file(record(), test=["a.csv"])
    with pytest.raises(
        InvalidInput, match=r"the time of the recording starts over, as several files do; split it by file"
    ):
        split_by_time(both, (0, 1), (1, 2))
    with pytest.raises(
        InvalidInput, match=r"the recording has several files, so its rows start over; split it by file"
    ):
        split_by_rows(both, (0, 1), (1, 2))


def test_intervals_that_cannot_be():
    with pytest.raises(InvalidInput, match=r"time: train \(0, 6\) and test \(5, 9\) overlap; choose intervals without"):
        split_by_time(record(), (0, 6), (5, 9))
    with pytest.raises(InvalidInput, match=r"time: no row for the test from 12 to 15 s; the recording has 0 to 9.9 s"):
        split_by_time(record(), (0, 6), (12, 15))
    with pytest.raises(InvalidInput, match=r"rows: no row for the fit from -5 to 0; the recording has 0 to 99"):
        split_by_rows(record(), (-5, 0), (12, 15))


@pytest.mark.parametrize("folds", [2, 3, 7])
def test_every_row_is_predicted_once_from_others(folds):
    splits = time_folds(record(), folds)
    tested = np.concatenate([split.test.rows for split in splits])
    assert tested.tolist() == list(range(100))
    for split in splits:
        assert sorted([*split.train.rows, *split.test.rows]) == list(range(100))
        assert len(split.test.block_slices) == 1
        inner = split.test.rows[0] > 0 and split.test.rows[-1] < 99
        assert len(split.train.block_slices) == 1 + inner
    sizes = np.bincount(fold_numbers(record(), folds))
    assert np.ptp(sizes) <= 1


def test_pieces_end_where_those_of_the_recording_do():
    """Rows are in one piece of a part if nothing is left out between them, and if they were in one before."""
    block = np.repeat([0, 1, 2, 3], [30, 1, 40, 29])
    recording = record().take(slice(None), block=block)
    splits = [
        split_by_time(recording, (2.0, 6.05), (6.05, 9.0)),
        split_by_rows(recording, (29, 50), (60, 99)),
        *time_folds(recording, 3, guard=0.15),
    ]
    for part in (part for split in splits for part in split):
        rows = part.rows
        together = (np.diff(rows) == 1) & (np.diff(block[rows]) == 0)
        assert np.array_equal(np.diff(part.block) == 0, together)
        assert set(np.diff(part.block)) <= {0, 1}
        assert part.block[0] == 0


def test_the_guard_keeps_neighbors_of_the_test_out_of_the_fit():
    for split in time_folds(record(), 4, guard=0.55):
        distance = np.abs(split.train.t[:, None] - split.test.t).min(axis=1)
        assert distance.min() == pytest.approx(0.6)
    both = concatenated([record("a.csv"), record("b.csv")])
    first, second = time_folds(both, 2, guard=0.55)
    assert (len(first.train.t), len(second.train.t)) == (100, 100)
    with pytest.raises(
        InvalidInput, match=r"a guard of 20 s leaves nothing to fit; choose a shorter one, or fewer folds"
    ):
        time_folds(record(), 2, guard=20)
    with pytest.raises(InvalidInput, match=r"guard is -1; give a time in s, zero or more"):
        time_folds(record(), 2, guard=-1)
    with pytest.raises(InvalidInput, match=r"1 folds of 100 rows; choose from 2 to the number of rows"):
        time_folds(record(), 1)
