"""What is fitted and what is predicted: always whole pieces of time, never rows at random."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from crosscheck.records import Record, Split, concatenated, split_by_rows, split_by_time, time_folds
from crosscheck.records.splits import Interval
from graphdyn.errors import InvalidInput

GUARD = 0.25
"""[s] between fit and prediction where the program chooses the border: neighbours share noise and filter."""

NANOSECONDS = 9
"""Digits of the time of the first row, which the filter has cut: rows times their step, with rounding."""


class Division(NamedTuple):
    """fit: what the parameters come from; trials: pairs of fit and prediction that give the held-out error.

    words: what is held out
    """

    fit: Record
    trials: list[Split]
    words: str


class HeldOut(Protocol):
    """A way to hold out rows of differentiated records."""

    def divide(self, records: Sequence[Record]) -> Division:
        """Raises InvalidInput where nothing is left to fit or to predict."""
        ...


@dataclass(frozen=True)
class ByTime:
    """fit, predict: intervals of time since the first row of the recording [s]."""

    fit: Interval
    predict: Interval

    def divide(self, records: Sequence[Record]) -> Division:
        record = _only(records, "time")
        start = round(float(record.t[0]) - record.rows[0] * _step(record), NANOSECONDS)
        intervals = [(first + start, last + start) for first, last in (self.fit, self.predict)]
        split = split_by_time(record, *intervals)
        return Division(split.train, [split], _told("", self.predict, " s"))


@dataclass(frozen=True)
class ByRows:
    """fit, predict: intervals of rows of the file, from 0, the last one not included."""

    fit: Interval
    predict: Interval

    def divide(self, records: Sequence[Record]) -> Division:
        split = split_by_rows(_only(records, "rows"), self.fit, self.predict)
        return Division(split.train, [split], _told("rows ", self.predict))


@dataclass(frozen=True)
class OtherRecords:
    """records: differentiated like those of the fit, and predicted."""

    records: tuple[Record, ...]

    def divide(self, records: Sequence[Record]) -> Division:
        fit, test = concatenated(records), concatenated(self.records)
        return Division(fit, [Split(fit, test)], f"all of {', '.join(test.provenance.files)}")


@dataclass(frozen=True)
class LastPart:
    """part: of the rows of every recording, at its end."""

    part: float = 0.25

    def divide(self, records: Sequence[Record]) -> Division:
        if not 0 < self.part < 1:
            raise InvalidInput(f"the part to hold out is {self.part:g}; choose one between 0 and 1")
        splits = []
        for record in records:
            border = float(record.t[int(len(record.t) * (1 - self.part))])
            ahead = (border, float(np.nextafter(record.t[-1], np.inf)))
            splits.append(split_by_time(record, (float(record.t[0]), border - GUARD), ahead))
        both = Split(*(concatenated([split[k] for split in splits]) for k in range(2)))
        return Division(both.train, [both], f"the last {100 * self.part:g} % of every recording")


@dataclass(frozen=True)
class Folds:
    """Blocked cross-validation: everything is fitted; each of the consecutive folds is predicted from the others."""

    folds: int = 5

    def divide(self, records: Sequence[Record]) -> Division:
        record = concatenated(records)
        return Division(
            record, time_folds(record, self.folds, GUARD), f"{self.folds} consecutive folds, each from the others"
        )


def _only(records: Sequence[Record], what: str) -> Record:
    if len(records) != 1:
        raise InvalidInput(f"{len(records)} recordings cannot be divided by {what}; give one, or others to validate")
    return records[0]


def _told(what: str, interval: Interval, unit: str = "") -> str:
    first, last = interval
    return f"{what}from {first:g}{unit} on" if last == float("inf") else f"{what}{first:g} to {last:g}{unit}"


def _step(record: Record) -> float:
    """Seconds per row of the file."""
    rows = np.diff(record.rows)
    steps = np.diff(record.t)[rows > 0] / rows[rows > 0]
    return float(np.median(steps)) if steps.size else 0.0
