"""Division into fitted and predicted rows: always whole intervals of time, never rows at random."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings import Recording, Split, concatenated, split_by_rows, split_by_time, time_folds
from crosscheck.recordings.preparation.filtering import settling_time
from crosscheck.recordings.preparation.splits import GUARD_TIME, Interval, fold_rows
from graphdyn import InvalidInput
from graphdyn.display import short_repr
from graphdyn.errors import counted

MAX_FILTER_LEAKAGE = 1e-2
"""Fraction of a predicted torque that the filter may still carry into the fit across the guard."""

TIME_DECIMALS = 9
"""Decimal places of the start time, which is computed with rounding from the rows that the filter cut off."""


class Fold(NamedTuple):
    """Rows that are fitted, and rows that are predicted from them.

    name: of the rows that are predicted; own_recording: whether they are all of a recording that is not fitted
    fold: the rows of Division.fit, if both are parts of it; these are filtered together, so that the filter has
        settled at their borders
    """

    name: str
    train: Recording
    test: Recording
    own_recording: bool = False
    fold: tuple[NDArray[np.bool_], NDArray[np.bool_]] | None = None


class Division(NamedTuple):
    """Rows for the parameters and rows for the held-out error.

    fit: from which the parameters are identified
    trials: for the held-out error, by which results are chosen
    words: the held-out rows as text
    aside: rows predicted from the fit that have no influence on the choice
    """

    fit: Recording
    trials: list[Fold]
    words: str
    aside: tuple[Fold, ...] = ()


class HeldOut(Protocol):
    """A way to hold out rows of differentiated recordings."""

    def divide(self, recordings: Sequence[Recording]) -> Division:
        """Divide recordings. Raises InvalidInput if nothing is left to fit or to predict."""
        ...


@dataclass(frozen=True)
class ByTime:
    """Fit one interval of time, predict another.

    fit, predict: time since the first row of the recording   [s]
    """

    fit: Interval
    predict: Interval

    def divide(self, recordings: Sequence[Recording]) -> Division:
        recording = _only(recordings, "time")
        start = round(float(recording.t[0]) - recording.rows[0] * _step(recording), TIME_DECIMALS)
        intervals = [(first + start, last + start) for first, last in (self.fit, self.predict)]
        split = split_by_time(recording, *intervals)
        return _one(split, _told("", self.predict, " s"))


@dataclass(frozen=True)
class ByRows:
    """Fit some rows, predict others.

    fit, predict: intervals of rows of the file, from 0, the last one not included
    """

    fit: Interval
    predict: Interval

    def divide(self, recordings: Sequence[Recording]) -> Division:
        split = split_by_rows(_only(recordings, "rows"), self.fit, self.predict)
        return _one(split, _told("rows ", self.predict))


@dataclass(frozen=True)
@short_repr
class OtherRecordings:
    """Predict recordings other than those of the fit.

    recordings: to predict, differentiated like those of the fit
    """

    recordings: tuple[Recording, ...]

    def divide(self, recordings: Sequence[Recording]) -> Division:
        fit = concatenated(recordings)
        fitted = _rows_of_files(fit)
        for file, numbers in _rows_of_files(concatenated(self.recordings)).items():
            shared = numbers & fitted.get(file, set())
            if shared:
                rows = counted(len(shared), "row is", "rows are")
                raise InvalidInput(f"{file}: {rows} fitted and predicted; predict another recording")
        trials = [
            Fold(Path(other.provenance.files[0]).name, fit, other, own_recording=True) for other in self.recordings
        ]
        files = [name for other in self.recordings for name in other.provenance.files]
        return Division(fit, trials, f"all of {', '.join(files)}")


@dataclass(frozen=True)
class LastPart:
    """Predict the end of every recording, fit the rest.

    part: fraction of the rows of every recording that is predicted
    """

    part: float = 0.25

    def divide(self, recordings: Sequence[Recording]) -> Division:
        if not 0 < self.part < 1:
            raise InvalidInput(f"the part to hold out is {self.part:g}; choose one between 0 and 1")
        splits = []
        for recording in recordings:
            border = float(recording.t[int(len(recording.t) * (1 - self.part))])
            ahead = (border, float(np.nextafter(recording.t[-1], np.inf)))
            splits.append(split_by_time(recording, (float(recording.t[0]), border - GUARD_TIME), ahead))
        both = Split(*(concatenated([split[k] for split in splits]) for k in range(2)))
        return _one(both, f"the last {100 * self.part:g} % of every recording")


@dataclass(frozen=True)
class Folds:
    """Blocked cross-validation: parameters from all rows; each consecutive fold is predicted from the others.

    aside: rows that are neither fitted nor choose a result, but predicted: the unbiased test of the choice
    """

    folds: int = 5
    aside: HeldOut | None = None

    def divide(self, recordings: Sequence[Recording]) -> Division:
        words, kept = f"{self.folds} consecutive folds, each from the others", tuple[Fold, ...]()
        if self.aside is None:
            recording = concatenated(recordings)
        else:
            others = self.aside.divide(recordings)
            recording, kept = others.fit, tuple(others.trials)
            words += f"; kept aside: {others.words}"
        guard = max(GUARD_TIME, settling_time(float(recording.torque_cutoff.min()), MAX_FILTER_LEAKAGE))
        folds = zip(time_folds(recording, self.folds, guard), fold_rows(recording, self.folds, guard), strict=True)
        trials = [Fold(f"fold {number}", *split, fold=rows) for number, (split, rows) in enumerate(folds, start=1)]
        return Division(recording, trials, words, kept)


def _one(split: Split, words: str) -> Division:
    return Division(split.train, [Fold(words, *split)], words)


def _rows_of_files(recording: Recording) -> dict[Path, set[int]]:
    """The rows of every file; if several files have the same rows, those of the first one."""
    files = [Path(name).resolve() for name in recording.provenance.files]
    numbers = np.unique(recording.file).tolist() if files else []
    return {files[number]: set(recording.rows[recording.file == number].tolist()) for number in numbers}


def _only(recordings: Sequence[Recording], what: str) -> Recording:
    if len(recordings) != 1:
        raise InvalidInput(
            f"{len(recordings)} recordings cannot be divided by {what}; give one, or separate recordings to validate"
        )
    return recordings[0]


def _told(what: str, interval: Interval, unit: str = "") -> str:
    first, last = interval
    return f"{what}from {first:g}{unit} on" if last == float("inf") else f"{what}{first:g} to {last:g}{unit}"


def _step(recording: Recording) -> float:
    """Seconds per row of the file."""
    rows = np.diff(recording.rows)
    steps = np.diff(recording.t)[rows > 0] / rows[rows > 0]
    return float(np.median(steps)) if steps.size else 0.0
