"""The numbers of one file, before a mapping gives them a meaning.

Cells of a column become doubles that lose no digits: large integers and calendar times are differences from a start.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.errors import BadMapping, RecordingFinding, quoted
from graphdyn.errors import counted
from graphdyn.layout import Array
from urdf.document import NUMBER

LONG_INTEGER_PATTERN = r"^-?[0-9]{16,}$"
"""An integer with more digits than doubles hold."""

MAX_EXACT_INTEGER = 2**53
"""Size beyond which doubles do not hold every integer."""

UNIT_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "D": 86400.0, "h": 3600.0, "m": 60.0}
"""Units of time in Arrow's and NumPy's notation [s]."""

NO_NUMBERS, TRUTH_VALUES = "it holds no numbers", "it holds truth values, no numbers"
COMPLEX_NUMBERS_MESSAGE = "it holds complex numbers; save their real parts"


DURATION_PATTERN = r"^-?(\d+\.?\d*|\.\d+)(e[-+]?\d+)? sec$"
"""A duration as MATLAB's writetimetable writes it."""


def is_exact(number: float) -> bool:
    """Whether a double holds the number, which may be an integer with any number of digits."""
    return abs(number) <= sys.float_info.max and float(number) == number


class Cells(NamedTuple):
    """A column: start + values, NaN for a cell that is not a number.

    values: differences from the start           (N,)
    start: 0, or the first integer of a column with integers beyond MAX_EXACT_INTEGER
    seconds: per number, if the column holds times of a calendar, a clock or a stopwatch; otherwise None
    """

    values: Array
    start: int = 0
    seconds: float | None = None

    @property
    def doubles(self) -> Array:
        """The numbers, rounded to doubles    (N,)"""
        return self.values + float(self.start) if self.start else self.values


def cells_of_column(column: Any) -> Cells | str:
    """An Arrow column of numbers, texts or times; or the reason why it is not one."""
    import pyarrow as pa
    from pyarrow import compute

    kind = column.type
    if pa.types.is_dictionary(kind):
        column, kind = column.cast(kind.value_type), kind.value_type
    if pa.types.is_temporal(kind) and not pa.types.is_interval(kind):
        unit = "D" if pa.types.is_date32(kind) else getattr(kind, "unit", "ms")  # date64 counts milliseconds
        if kind.bit_width == 32:
            column = column.cast(pa.int32())
        return _integers(column.cast(pa.int64()))._replace(seconds=UNIT_SECONDS[unit])
    if pa.types.is_integer(kind):
        return _integers(column)
    if pa.types.is_floating(kind) or pa.types.is_decimal(kind):
        return Cells(np.array(column.cast(pa.float64(), safe=False), dtype=float))
    if pa.types.is_null(kind):
        return Cells(np.full(len(column), np.nan))
    if not (pa.types.is_string(kind) or pa.types.is_large_string(kind)):
        return TRUTH_VALUES if pa.types.is_boolean(kind) else NO_NUMBERS
    text = compute.replace_substring_regex(compute.utf8_trim_whitespace(column), r"^\+([0-9.])", r"\1")
    nothing = pa.scalar(None, text.type)
    if compute.all(compute.match_substring_regex(text, DURATION_PATTERN)).as_py():
        text = compute.replace_substring(text, " sec", "")
        return Cells(np.array(text.cast(pa.float64()), dtype=float), seconds=1.0)
    text = compute.if_else(compute.match_substring_regex(text, f"^{NUMBER}$"), text, nothing)
    if compute.any(compute.match_substring_regex(text, LONG_INTEGER_PATTERN)).as_py():
        for integer in (pa.int64(), pa.uint64()):
            try:
                return _integers(text.cast(integer))
            except pa.ArrowInvalid:  # some are larger, or have decimals
                pass
    return Cells(np.array(text.cast(pa.float64()), dtype=float))


def cells_of_array(array: NDArray[Any]) -> Cells | str:
    """A NumPy array of numbers or times; or the reason why it is not a column."""
    if array.dtype.kind in "mM":
        unit, count = np.datetime_data(array.dtype)
        if unit not in UNIT_SECONDS:
            return f"it holds times in the unit {unit!r}; save them in seconds"
        ticks = array.astype(np.int64)
        return _differences(ticks, np.isnat(array))._replace(seconds=count * UNIT_SECONDS[unit])
    if array.dtype.kind in "iu":
        return _differences(array, np.zeros(array.shape, dtype=bool))
    if array.dtype.kind != "f":
        return {"b": TRUTH_VALUES, "c": COMPLEX_NUMBERS_MESSAGE}.get(array.dtype.kind, NO_NUMBERS)
    return Cells(array.astype(float))


def _integers(column: Any) -> Cells:
    """An Arrow column of integers; NaN for nulls."""
    missing = np.array(column.is_null(), dtype=bool)
    return _differences(np.array(column.fill_null(0)), missing)


def _differences(integers: NDArray[Any], missing: NDArray[np.bool_]) -> Cells:
    integers = np.asarray(integers)
    there = integers[~missing]
    lowest, highest = (int(there.min()), int(there.max())) if there.size else (0, 0)
    start = int(there[0]) if max(-lowest, highest) > MAX_EXACT_INTEGER else 0
    if start and highest - lowest < 2**63:
        modulo = integers.astype(np.uint64) - np.uint64(start % 2**64)
        values = modulo.view(np.int64).astype(float)
    else:
        start, values = 0, integers.astype(float)
    values[missing] = np.nan
    return Cells(values, start)


MAX_LISTED_NAMES = 40
"""Largest number of names that a message lists."""


@dataclass(frozen=True, eq=False)
class RecordedTable:
    """N rows of k named columns; every line of the file is a row, even one that holds no measurement.

    values: NaN for a cell that is not a number  (N, k)
    starts: per column number, an integer to be added, if doubles do not hold the digits of the column
    seconds: per column number, seconds per number, if the column holds times of a calendar or a clock
    names: as in the file; "" if it has none
    texts: per column number, the text of cells that are not numbers
    lines: line of row 0 in the file; None if the file has no lines
    left_out: names in the file that are not columns, with the reasons
    in_si: whether the format guarantees SI units, as ROS messages do
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
        there = (
            in_words(self.names)
            if self.has_names
            else f"{counted(len(self.names), 'column')} without names; give numbers"
        )
        raise BadMapping(f"{where}: {self.path} has no column {column!r}; it has {there}")


def in_words(names: Iterable[str]) -> str:
    """Names for a message: the first ones, control characters escaped."""
    names = list(names)
    more = [f"… ({len(names)} in all)"] if len(names) > MAX_LISTED_NAMES else []
    return ", ".join([*(quoted(name)[1:-1] for name in names[:MAX_LISTED_NAMES]), *more])
