"""Equations of consecutive samples, one per joint and sample, in uninterrupted runs, filtered or not.

A parallel filter is a linear filter along time on the torque and on every column of the regressor. For any linear F, τ
= W x implies F τ = (F W) x. No filter therefore biases x, whatever it does to sign(v). A torque that is filtered alone
lacks components that its regressor still has: friction is then wrong by percents. Gautier, "Dynamic identification of
robots with power model", IEEE ICRA 1997.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import RowFilter, Samples, filtered_length
from graphdyn.layout import Array

ROW_ARRAYS = ("matrix", "right", "measured", "velocity", "kept")


@dataclass(frozen=True, eq=False)
class Rows:
    """W x = τ in the base parameters of the structure, for N consecutive samples.

    matrix: W (N, n, b); right: measured minus known torque (N, n); measured: measured torque (N, n)
    velocity: (N, n); kept: which count in the fit (N, n)
    block: number of the time block; first: whether an uninterrupted run of the recording starts here
    """

    matrix: Array
    right: Array
    measured: Array
    velocity: Array
    kept: NDArray[np.bool_]
    block: int = 0
    first: bool = False

    def __len__(self) -> int:
        return len(self.right)

    def __getitem__(self, rows: slice) -> Rows:
        parts = {name: getattr(self, name)[rows] for name in ROW_ARRAYS}
        return replace(self, **parts, first=self.first and not rows.start)


P = TypeVar("P", Rows, Rows | Samples)


def counted(parts: Iterable[P], used: NDArray[np.bool_] | None) -> Iterator[P]:
    """The used rows (N,) of consecutive parts of a recording; None uses all.

    After a gap a new run of the recording starts. Raises InvalidInput for another number of rows.
    """
    if used is None:
        yield from parts
        return
    position = 0
    for part in parts:
        here = np.concatenate([[False], used[position : position + len(part)], [False]])
        borders = np.flatnonzero(np.diff(here)).tolist()
        for start, stop in zip(borders[::2], borders[1::2], strict=True):
            cut = part[start:stop]
            gap = start > 0 or (position > 0 and not used[position - 1])
            yield replace(cut, first=True) if gap and isinstance(cut, Rows) else cut
        position += len(part)
    if position != len(used):
        raise InvalidInput(f"used is given for {len(used)} rows; the filter leaves {position}")


@dataclass(frozen=True, eq=False)
class Run:
    """Consecutive pieces, to be read once, and their common filter."""

    row_filter: RowFilter | None
    samples: Iterator[Samples]

    def pieces(self, length: int) -> Iterator[Samples]:
        """The pieces, cut to this length at most."""
        return (part for piece in self.samples for part in piece.pieces(length))

    def filtered_length(self) -> int:
        """Number of rows that the filter keeps."""
        return filtered_length(sum(map(len, self.samples)), self.row_filter)


def runs(pieces: Iterable[Samples]) -> Iterator[Run]:
    """The runs, one after the other; each must be read to its end before the next.

    Raises InvalidInput if a piece continues one with another filter.
    """
    left = iter(pieces)
    head = next(left, None)
    while head is not None:
        following: list[Samples] = []
        yield Run(head.row_filter, chain([head], _continued(left, head.row_filter, following)))
        head = following[0] if following else None


def _continued(left: Iterator[Samples], row_filter: RowFilter | None, following: list[Samples]) -> Iterator[Samples]:
    """The pieces that continue the previous one; the first that does not goes into `following`."""
    for piece in left:
        if not piece.continues:
            following.append(piece)
            return
        if piece.row_filter != row_filter:
            raise InvalidInput("a piece that continues another has another row filter; give both the same")
        yield piece


MIN_FILTERED_ROWS = 4096
"""Smallest number of rows that are filtered at once, without the rows around them."""


def filtered(
    chunks: Iterable[Rows], row_filter: RowFilter, support: NDArray[np.bool_], min_speed: ArrayLike
) -> Iterator[Rows]:
    """The equations of one uninterrupted run, filtered, in windows that overlap by the memory of the filter.

    support: where W can differ from zero (n, b); the filtered velocity decides which equations count
    """
    n, b = support.shape
    width = int(support.sum())
    factor = row_filter.factor
    margin = -(-row_filter.memory // factor) * factor
    window = max(MIN_FILTERED_ROWS, 2 * margin)
    waiting, before, first = np.empty((0, width + 3 * n)), 0, True
    parts: list[Array] = []

    def rows_of(columns: Array) -> Rows:
        matrix = np.zeros((len(columns), n, b))
        matrix[:, support] = columns[:, :width]
        right, measured, velocity = np.split(columns[:, width:].copy(), 3, axis=1)  # so that the others can be freed
        return Rows(matrix, right, measured, velocity, np.abs(velocity) >= min_speed, first=first)

    for chunk in chunks:
        parts.append(np.hstack([chunk.matrix[:, support], chunk.right, chunk.measured, chunk.velocity]))
        if len(waiting) + sum(map(len, parts)) >= before + window + margin:
            waiting = np.concatenate([waiting, *parts])
            parts = []
            done = (len(waiting) - margin) // factor * factor
            rows = rows_of(_applied(row_filter, waiting, slice(before // factor, done // factor)))
            waiting, before, first = waiting[done - margin :].copy(), margin, False
            yield rows
    waiting = np.concatenate([waiting, *parts])
    if len(waiting):
        yield rows_of(_applied(row_filter, waiting, slice(before // factor, None)))


COLUMNS_AT_ONCE = 16
"""Columns that are filtered at once: filters make several copies of them."""


def _applied(row_filter: RowFilter, columns: Array, kept: slice) -> Array:
    """These of the filtered rows."""
    rows, width = filtered_length(len(columns), row_filter), columns.shape[1]
    found = np.empty((len(range(rows)[kept]), width))
    for first in range(0, width, COLUMNS_AT_ONCE):
        some = columns[:, first : first + COLUMNS_AT_ONCE]
        answer = np.asarray(row_filter(some), dtype=float)
        expected = (rows, some.shape[1])
        if answer.shape != expected:
            raise InvalidInput(f"the row filter answers shape {answer.shape} for {some.shape}, expected {expected}")
        found[:, first : first + COLUMNS_AT_ONCE] = answer[kept]
    return found
