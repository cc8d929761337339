"""The interface of a linear filter along time."""

from __future__ import annotations

from typing import Protocol

from graphdyn.layout import Array


class RowFilter(Protocol):
    """A linear filter along the rows, the same for every column: low-pass, decimation, or a sequence of them.

    factor: of the rows 0, 1, 2, … every factor-th one is kept
    memory: number of rows before and after a row on which its filtered value depends
    """

    @property
    def factor(self) -> int: ...
    @property
    def memory(self) -> int: ...

    def __call__(self, columns: Array) -> Array:
        """Filtered rows: (N, k) → (⌈N / factor⌉, k). Raises InvalidInput for too few rows."""
        ...


def filtered_length(rows: int, row_filter: RowFilter | None) -> int:
    """Number of rows that a filter keeps."""
    return rows if row_filter is None else -(-rows // row_filter.factor)
