"""Whatever works on many tasks at once, and what can be wrong with it whatever the tasks."""

from __future__ import annotations

import platform
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Protocol, TypeVar

from graphdyn import GraphDynError


class NoWorkers(GraphDynError):
    """A scheduler or workers that cannot be used; the message says why and what to do."""


SHARED_LIBRARIES = ("graphdyn", "numpy", "scipy", "llvmlite")

MISSING = "missing"
"""What stands in place of the version of a library that is not installed."""


def versions(further: Iterable[str] = ()) -> dict[str, str]:
    """Versions of this process. further: libraries beside SHARED_LIBRARIES, which may be missing"""
    python = ".".join(platform.python_version_tuple()[:2])
    shared = {name: version(name) for name in SHARED_LIBRARIES}
    return {"python": python, **shared, **{name: _version(name) for name in further}}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return MISSING


def differences(here: Mapping[str, str], there: Mapping[str, str]) -> str:
    """Differences in words; empty where there is none."""
    return ", ".join(
        f"{name} {there.get(name)} in place of {here[name]}" for name in here if there.get(name) != here[name]
    )


Task = TypeVar("Task")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Lost:
    """The stand-in for an answer where none was given.

    reason: in words
    died: the process did; otherwise it could not do the task at all
    """

    reason: str
    died: bool = True


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
