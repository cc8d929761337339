"""Data in independent parts, which can be processed in other processes or on other machines.

The results of the parts are merged in a binary tree that the numbers of the parts fix. The merged result is therefore
the same to the last bit, wherever and in whatever order the parts are processed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar, runtime_checkable

T = TypeVar("T")


@runtime_checkable
class Partitioned(Protocol):
    """Data in parts, for Problem(data=…) in place of samples; iterable, such as crosscheck.PartitionedRecording."""

    def each_part(self, problem: Any, function: Callable[[Any, slice], T]) -> list[tuple[int, T]]:
        """Number of the time block and result of every part, in their order.

        function: of the problem of one part and of which of its rows belong to it; the other rows are those around it
            that the row filter needs. It can be pickled
        """
        ...


def merged_in_tree(merge: Callable[[T, T], T], parts: Sequence[T]) -> T:
    """Sum of the parts in a binary tree: neighbors are merged, then neighboring pairs, and so on.

    A last part without a neighbor waits for the next round.
    """
    left = list(parts)
    while len(left) > 1:
        pairs = [merge(left[k], left[k + 1]) for k in range(0, len(left) - 1, 2)]
        left = pairs + left[2 * len(pairs) :]
    return left[0]
