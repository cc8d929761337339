"""Cells of an Arrow column as doubles."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphdyn.layout import Array


def as_doubles(column: Any) -> Array:
    """A column of text or numbers as doubles, NaN where a cell is not a number."""
    import pyarrow as pa
    from pyarrow import compute

    if pa.types.is_string(column.type):
        column = compute.utf8_trim_whitespace(column)
    try:
        return np.array(column.cast(pa.float64()), dtype=float)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError):
        return np.array([_as_double(cell) for cell in column])


def _as_double(cell: Any) -> float:
    import pyarrow as pa

    try:
        return float(cell.cast(pa.float64()).as_py())
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError, TypeError):
        return np.nan
