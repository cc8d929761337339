"""Cells of a column as doubles that lose no digits: large integers and calendar times as differences from a start."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array

NUMBER = r"^-?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"
LONG_INTEGER = r"^-?\d{16,}$"
"""An integer with more digits than doubles hold."""

LARGEST_EXACT = 2**53
"""Size beyond which doubles do not hold every integer."""

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "D": 86400.0, "h": 3600.0, "m": 60.0}
"""Units of time as Arrow and NumPy write them."""

NO_NUMBERS, TRUTH = "it holds no numbers", "it holds truth values, no numbers"
COMPLEX = "it holds complex numbers; save their real parts"


DURATION = r"^-?(\d+\.?\d*|\.\d+)(e[-+]?\d+)? sec$"
"""A duration as MATLAB's writetimetable writes it."""


class Cells(NamedTuple):
    """A column: start + values, NaN where a cell is not a number.

    values: differences from the start           (N,)
    start: 0, or the first integer of a column with integers beyond LARGEST_EXACT
    seconds: per number, where the column holds times of a calendar, a clock or a stopwatch; else None
    """

    values: Array
    start: int = 0
    seconds: float | None = None

    @property
    def doubles(self) -> Array:
        """The numbers, rounded to doubles    (N,)"""
        return self.values + float(self.start) if self.start else self.values


def cells_of_column(column: Any) -> Cells | str:
    """An Arrow column of numbers, texts or times; or why it is not one."""
    import pyarrow as pa
    from pyarrow import compute

    kind = column.type
    if pa.types.is_dictionary(kind):
        column, kind = column.cast(kind.value_type), kind.value_type
    if pa.types.is_temporal(kind) and not pa.types.is_interval(kind):
        unit = "D" if pa.types.is_date32(kind) else getattr(kind, "unit", "ms")  # date64 counts milliseconds
        if kind.bit_width == 32:
            column = column.cast(pa.int32())
        return _integers(column.cast(pa.int64()))._replace(seconds=SECONDS[unit])
    if pa.types.is_integer(kind):
        return _integers(column)
    if pa.types.is_floating(kind) or pa.types.is_decimal(kind):
        return Cells(np.array(column.cast(pa.float64(), safe=False), dtype=float))
    if pa.types.is_null(kind):
        return Cells(np.full(len(column), np.nan))
    if not (pa.types.is_string(kind) or pa.types.is_large_string(kind)):
        return TRUTH if pa.types.is_boolean(kind) else NO_NUMBERS
    text = compute.replace_substring_regex(compute.utf8_trim_whitespace(column), r"^\+", "")
    nothing = pa.scalar(None, text.type)
    if compute.all(compute.match_substring_regex(text, DURATION)).as_py():
        text = compute.replace_substring(text, " sec", "")
        return Cells(np.array(text.cast(pa.float64()), dtype=float), seconds=1.0)
    text = compute.if_else(compute.match_substring_regex(text, NUMBER), text, nothing)
    if compute.any(compute.match_substring_regex(text, LONG_INTEGER)).as_py():
        for integer in (pa.int64(), pa.uint64()):
            try:
                return _integers(text.cast(integer))
            except pa.ArrowInvalid:  # some are larger, or have decimals
                pass
    return Cells(np.array(text.cast(pa.float64()), dtype=float))


def cells_of_array(array: NDArray[Any]) -> Cells | str:
    """A NumPy array of numbers or times; or why it is not a column."""
    if array.dtype.kind in "mM":
        unit, count = np.datetime_data(array.dtype)
        if unit not in SECONDS:
            return f"it holds times in the unit {unit!r}; save them in seconds"
        ticks = array.astype(np.int64)
        return _differences(ticks, np.isnat(array))._replace(seconds=count * SECONDS[unit])
    if array.dtype.kind in "iu":
        return _differences(array, np.zeros(array.shape, dtype=bool))
    if array.dtype.kind != "f":
        return {"b": TRUTH, "c": COMPLEX}.get(array.dtype.kind, NO_NUMBERS)
    return Cells(array.astype(float))


def _integers(column: Any) -> Cells:
    """An Arrow column of integers; NaN for nulls."""
    missing = np.array(column.is_null(), dtype=bool)
    return _differences(np.array(column.fill_null(0)), missing)


def _differences(integers: NDArray[Any], missing: NDArray[np.bool_]) -> Cells:
    integers = np.asarray(integers)
    there = integers[~missing]
    lowest, highest = (int(there.min()), int(there.max())) if there.size else (0, 0)
    start = int(there[0]) if max(-lowest, highest) > LARGEST_EXACT else 0
    if start and highest - lowest < 2**63:
        modulo = integers.astype(np.uint64) - np.uint64(start % 2**64)
        values = modulo.view(np.int64).astype(float)
    else:
        start, values = 0, integers.astype(float)
    values[missing] = np.nan
    return Cells(values, start)
