"""Training and test sets: by time, by rows or by file, in whole intervals, because neighboring rows are correlated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.recording import Recording
from graphdyn import InvalidInput
from graphdyn.errors import counted

Interval = tuple[float, float]

GUARD_TIME = 0.25
"""Time left out between fit and prediction if the program chooses the border [s]: noise and filter correlate
neighboring rows."""


class Split(NamedTuple):
    """Rows that are fitted, and rows that are predicted."""

    train: Recording
    test: Recording


def split_by_time(recording: Recording, train: Interval, test: Interval) -> Split:
    """Rows with start ≤ t < stop [s]. Raises InvalidInput for intervals that overlap, or have no rows."""
    if np.any(np.diff(recording.t) <= 0):
        raise InvalidInput("the time of the recording starts over, as several files do; split it by file")
    return _split(recording, recording.t, train, test, "time", " s")


def split_by_rows(recording: Recording, train: Interval, test: Interval) -> Split:
    """Rows of the file, from 0, with start ≤ row < stop. Raises as split_by_time, and for several files."""
    if np.ptp(recording.file) > 0:
        raise InvalidInput("the recording has several files, so its rows start over; split it by file")
    return _split(recording, recording.rows, train, test, "rows", "")


def split_by_file(recording: Recording, test: Sequence[str]) -> Split:
    """Split of a recording of several files (crosscheck.concatenated): these are predicted, the others fitted."""
    files = recording.provenance.files
    unknown = [name for name in test if name not in files]
    if unknown or not test:
        named = f"{unknown[0]!r} is not a file of the recording" if unknown else "no file is named"
        raise InvalidInput(f"{named}; it has {', '.join(files)}")
    mask = np.isin(recording.file, [number for number, name in enumerate(files) if name in test])
    if mask.all():
        raise InvalidInput("all files of the recording are for the test; leave one to fit")
    return Split(
        recording.take(~mask, f"for the fit: all but {', '.join(test)}"),
        recording.take(mask, f"for the test: {', '.join(test)}"),
    )


def fold_numbers(recording: Recording, folds: int) -> NDArray[np.intp]:
    """The fold 0 … folds - 1 of each row (N,), for cross-validation: consecutive pieces of equally many rows."""
    if not 2 <= folds <= len(recording.t):
        raise InvalidInput(f"{folds} folds of {counted(len(recording.t), 'row')}; choose from 2 to the number of rows")
    return np.arange(len(recording.t)) * folds // len(recording.t)


def time_folds(recording: Recording, folds: int, guard: float = 0.0) -> list[Split]:
    """Blocked cross-validation: each fold is predicted once from the others.

    guard: time [s] before and after the test that is not fitted either; longer than noise and filter are correlated
    Raises InvalidInput if the guard leaves nothing to fit.
    """
    splits = []
    for fold, (train, test) in enumerate(fold_rows(recording, folds, guard), start=1):
        name = f"fold {fold} of {folds}"
        splits.append(Split(_pieces(recording, train, f"for the fit: all but {name}"), _pieces(recording, test, name)))
    return splits


def fold_rows(recording: Recording, folds: int, guard: float) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Rows (N,) that are fitted and rows that are predicted in every fold of time_folds. Raises as time_folds."""
    if not guard >= 0:
        raise InvalidInput(f"guard is {guard!r}; give a time in s, zero or more")
    numbers = fold_numbers(recording, folds)
    rows, found = np.arange(len(numbers)), []
    for fold in range(folds):
        test = numbers == fold
        first, last = np.flatnonzero(test)[[0, -1]]
        before = (recording.file == recording.file[first]) & (recording.t > recording.t[first] - guard)
        after = (recording.file == recording.file[last]) & (recording.t < recording.t[last] + guard)
        train = ~(test | (rows < first) & before | (rows > last) & after)
        if not train.any():
            raise InvalidInput(f"a guard of {guard:g} s leaves nothing to fit; choose a shorter one, or fewer folds")
        found.append((train, test))
    return found


def _split(recording: Recording, values: NDArray[Any], train: Interval, test: Interval, what: str, unit: str) -> Split:
    if max(train[0], test[0]) < min(train[1], test[1]):
        raise InvalidInput(f"{what}: train {train} and test {test} overlap; choose intervals without common rows")
    parts = []
    for use, (start, stop) in (("fit", train), ("test", test)):
        mask = (values >= start) & (values < stop)
        if not mask.any():
            raise InvalidInput(
                f"{what}: no row for the {use} from {start:g} to {stop:g}{unit}; "
                f"the recording has {float(values.min()):g} to {float(values.max()):g}{unit}"
            )
        parts.append(_pieces(recording, mask, f"for the {use}: {what} {start:g} to {stop:g}{unit}"))
    return Split(*parts)


def _pieces(recording: Recording, mask: NDArray[np.bool_], step: str) -> Recording:
    """The rows of the mask; gaps between them divide a block."""
    rows = np.flatnonzero(mask)
    divides = (np.diff(rows) > 1) | (np.diff(recording.block[rows]) > 0)
    return recording.take(rows, step, block=np.concatenate([[0], np.cumsum(divides)]))
