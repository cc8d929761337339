"""The numbers of one file, before a mapping gives them a meaning."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.recordings.cells import Cells
from crosscheck.recordings.errors import BadMapping
from crosscheck.recordings.findings import RecordingFinding, quoted
from graphdyn.layout import Array

SHOWN_NAMES = 40
"""Largest number of names that a message lists."""


@dataclass(frozen=True, eq=False)
class RecordedTable:
    """N rows of k named columns; every line of the file is a row, even one that holds no measurement.

    values: NaN where a cell is not a number     (N, k)
    starts: per column number, an integer to be added, where doubles do not hold the digits of the column
    seconds: per column number, seconds per number, where the column holds times of a calendar or a clock
    names: as in the file; "" where it has none
    texts: per column number, the text of cells that are not numbers
    lines: line of row 0 in the file; None where the file has no lines
    left_out: names in the file that are not columns, and why
    in_si: the format says that all numbers are in SI units, as ROS messages do
    """

    path: Path
    names: tuple[str, ...]
    values: Array
    texts: Mapping[int, Mapping[int, str]] = field(default_factory=dict)
    lines: int | None = None
    left_out: Mapping[str, str] = field(default_factory=dict)
    starts: Mapping[int, int] = field(default_factory=dict)
    seconds: Mapping[int, float] = field(default_factory=dict)
    findings: tuple[RecordingFinding, ...] = ()
    in_si: bool = False

    @classmethod
    def of(cls, path: Path, names: Sequence[str], columns: Sequence[Cells], **more: Any) -> RecordedTable:
        """The table of these columns, all of the same length."""
        starts = {k: cells.start for k, cells in enumerate(columns) if cells.start}
        seconds = {k: cells.seconds for k, cells in enumerate(columns) if cells.seconds is not None}
        values = np.column_stack([cells.values for cells in columns])
        return cls(path, tuple(names), values, starts=starts, seconds=seconds, **more)

    @property
    def has_names(self) -> bool:
        return any(self.names)

    def doubles(self, number: int) -> Array:
        """The numbers of a column, rounded to doubles    (N,)"""
        return Cells(self.values[:, number], self.starts.get(number, 0)).doubles

    def number(self, column: str | int, where: str) -> int:
        """The number, from 0, of a column given by name, or by number from 1. Raises BadMapping."""
        if isinstance(column, int):
            if not 1 <= column <= len(self.names):
                raise BadMapping(f"{where}: {self.path} has no column {column}; it has {len(self.names)}")
            return column - 1
        numbers = [number for number, name in enumerate(self.names) if name == column]
        if len(numbers) == 1:
            return numbers[0]
        if numbers:
            listed = " and ".join(str(number + 1) for number in numbers)
            raise BadMapping(f"{where}: {self.path} has {column!r} in the columns {listed}; give the number of one")
        if column in self.left_out:
            raise BadMapping(f"{where}: {column!r} of {self.path} is not a column: {self.left_out[column]}")
        there = in_words(self.names) if self.has_names else f"{len(self.names)} columns without names; give numbers"
        raise BadMapping(f"{where}: {self.path} has no column {column!r}; it has {there}")


def in_words(names: Iterable[str]) -> str:
    """Names for a message: the first ones, control characters escaped."""
    names = list(names)
    more = [f"… ({len(names)} in all)"] if len(names) > SHOWN_NAMES else []
    return ", ".join([*(quoted(name)[1:-1] for name in names[:SHOWN_NAMES]), *more])
