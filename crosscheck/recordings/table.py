"""The numbers of one file, before a mapping gives them a meaning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from crosscheck.recordings.errors import BadMapping
from crosscheck.recordings.findings import RecordingFinding
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class RecordedTable:
    """N rows of k named columns; every line of the file is a row, even one that holds no measurement.

    values: NaN where a cell is not a number     (N, k)
    names: as in the file; "" where it has none
    texts: per column number, the text of cells that are not numbers
    lines: line of row 0 in the file; None where the file has no lines
    left_out: names in the file that are not columns, and why
    """

    path: Path
    names: tuple[str, ...]
    values: Array
    texts: Mapping[int, Mapping[int, str]] = field(default_factory=dict)
    lines: int | None = None
    left_out: Mapping[str, str] = field(default_factory=dict)
    findings: tuple[RecordingFinding, ...] = ()

    @property
    def has_names(self) -> bool:
        return any(self.names)

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
            raise BadMapping(f"{where}: {self.path} has '{column}' in the columns {listed}; give the number of one")
        if column in self.left_out:
            raise BadMapping(f"{where}: '{column}' of {self.path} is not a column: {self.left_out[column]}")
        there = ", ".join(self.names) if self.has_names else f"{len(self.names)} columns without names; give numbers"
        raise BadMapping(f"{where}: {self.path} has no column '{column}'; it has {there}")
