"""Whatever works on many tasks at once."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

Task = TypeVar("Task")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Lost:
    """In place of an answer, where none was given. reason: in words."""

    reason: str


class Workers(Protocol):
    """Processes that answer tasks, in no fixed order."""

    def each(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Generator[tuple[int, Answer | Lost], None, None]:
        """Number and answer of each task, in the order of completion. The work ends when the generator is closed.

        function: can be pickled, and raises nothing
        A task whose process dies is tried again, and is Lost where that does not help. Raises NoWorkers.
        """
        ...
