"""Equations of consecutive samples, one per joint and sample, in uninterrupted runs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import RowFilter, Samples, filtered_length
from graphdyn.layout import Array


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
        return replace(
            self,
            matrix=self.matrix[rows],
            right=self.right[rows],
            measured=self.measured[rows],
            velocity=self.velocity[rows],
            kept=self.kept[rows],
            first=self.first and not rows.start,
        )


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
