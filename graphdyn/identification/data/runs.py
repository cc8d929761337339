"""Uninterrupted runs of a recording: pieces that follow each other without a gap."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.row_filter import RowFilter, filtered_length
from graphdyn.identification.data.samples import Samples


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
