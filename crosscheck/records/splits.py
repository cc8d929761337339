"""Train and test: by time, by rows or by file, in whole pieces; rows next to each other are too alike to be divided."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.records.record import Record
from graphdyn.errors import InvalidInput

Interval = tuple[float, float]


class Split(NamedTuple):
    """What is fitted, and what is predicted."""

    train: Record
    test: Record


def split_by_time(record: Record, train: Interval, test: Interval) -> Split:
    """Rows with start ≤ t < stop [s]. Raises InvalidInput for intervals that overlap, or have no rows."""
    if np.any(np.diff(record.t) <= 0):
        raise InvalidInput("the time of the record starts over, as several files do; split it by file")
    return _split(record, record.t, train, test, "time", " s")


def split_by_rows(record: Record, train: Interval, test: Interval) -> Split:
    """Rows of the file, from 0, with start ≤ row < stop. Raises as split_by_time, and for several files."""
    if np.ptp(record.file) > 0:
        raise InvalidInput("the record has several files, so its rows start over; split it by file")
    return _split(record, record.rows, train, test, "rows", "")


def split_by_file(record: Record, test: Sequence[str]) -> Split:
    """A record of several files (crosscheck.concatenated): these are predicted, the others fitted."""
    files = record.provenance.files
    unknown = [name for name in test if name not in files]
    if unknown or not test:
        named = f"'{unknown[0]}' is no file of the record" if unknown else "no file is named"
        raise InvalidInput(f"{named}; it has {', '.join(files)}")
    mask = np.isin(record.file, [number for number, name in enumerate(files) if name in test])
    if mask.all():
        raise InvalidInput("all files of the record are for the test; leave one to fit")
    return Split(
        record.take(~mask, f"for the fit: all but {', '.join(test)}"),
        record.take(mask, f"for the test: {', '.join(test)}"),
    )


def fold_numbers(record: Record, folds: int) -> NDArray[np.intp]:
    """A number 0 … folds - 1 for each row (N,): consecutive pieces of equally many rows, for cross-validation."""
    if not 2 <= folds <= len(record.t):
        raise InvalidInput(f"{folds} folds of {len(record.t)} rows; choose from 2 to the number of rows")
    return np.arange(len(record.t)) * folds // len(record.t)


def time_folds(record: Record, folds: int, guard: float = 0.0) -> list[Split]:
    """Blocked cross-validation: each fold is predicted once from the others.

    guard: time [s] next to the test that is not fitted either, longer than noise and filter stay correlated
    Raises InvalidInput where the guard leaves nothing to fit.
    """
    if not guard >= 0:
        raise InvalidInput(f"guard is {guard!r}; give a time in s, zero or more")
    numbers = fold_numbers(record, folds)
    splits = []
    for fold in range(folds):
        test = numbers == fold
        first, last = np.flatnonzero(test)[[0, -1]]
        same = (
            (record.file == record.file[first]) & (np.arange(len(test)) < first) & (record.t > record.t[first] - guard)
        )
        same |= (record.file == record.file[last]) & (np.arange(len(test)) > last) & (record.t < record.t[last] + guard)
        train = ~test & ~same
        if not train.any():
            raise InvalidInput(f"a guard of {guard:g} s leaves nothing to fit; choose a shorter one, or fewer folds")
        name = f"fold {fold + 1} of {folds}"
        splits.append(Split(_pieces(record, train, f"for the fit: all but {name}"), _pieces(record, test, name)))
    return splits


def _split(record: Record, values: NDArray[Any], train: Interval, test: Interval, what: str, unit: str) -> Split:
    if max(train[0], test[0]) < min(train[1], test[1]):
        raise InvalidInput(f"{what}: train {train} and test {test} overlap; a test of fitted rows says nothing")
    parts = []
    for use, (start, stop) in (("fit", train), ("test", test)):
        mask = (values >= start) & (values < stop)
        if not mask.any():
            raise InvalidInput(
                f"{what}: no row for the {use} from {start:g} to {stop:g}{unit}; "
                f"the record has {float(values.min()):g} to {float(values.max()):g}{unit}"
            )
        parts.append(_pieces(record, mask, f"for the {use}: {what} {start:g} to {stop:g}{unit}"))
    return Split(*parts)


def _pieces(record: Record, mask: NDArray[np.bool_], step: str) -> Record:
    """The rows of the mask; a hole in them divides a block."""
    rows = np.flatnonzero(mask)
    divides = (np.diff(rows) > 1) | (np.diff(record.block[rows]) > 0)
    return record.take(rows, step, block=np.concatenate([[0], np.cumsum(divides)]))
