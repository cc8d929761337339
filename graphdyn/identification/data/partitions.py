"""Data in parts that are worked on independently of each other, in other processes or on other machines.

What comes of the parts is put together in a binary tree that their numbers fix. It is therefore the same to the last
bit wherever and in whatever order the parts were worked on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar, runtime_checkable

T = TypeVar("T")


@runtime_checkable
class Partitioned(Protocol):
    """What Problem(data=…) may be given in place of samples, beside being iterable: crosscheck.PartitionedRecording."""

    def each_part(self, problem: Any, function: Callable[[Any, slice], T]) -> list[tuple[int, T]]:
        """Number of the time block and answer of every part, in their order.

        function: of the problem of a part alone, and which of its rows are its own; the others around them are those
            that the row filter remembers. It can be pickled
        """
        ...


def merged_in_tree(merge: Callable[[T, T], T], parts: Sequence[T]) -> T:
    """Neighbours together, then neighbouring pairs, and so on; a last one without neighbour waits for a round."""
    left = list(parts)
    while len(left) > 1:
        pairs = [merge(left[k], left[k + 1]) for k in range(0, len(left) - 1, 2)]
        left = pairs + left[2 * len(pairs) :]
    return left[0]
