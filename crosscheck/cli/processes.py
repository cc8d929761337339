"""A function over many items in parallel processes, of which any may die: the item it held is then known."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar, cast

Item = TypeVar("Item")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Died:
    """In place of an answer. code: of the process's end, negative for the number of a signal."""

    code: int | None


def each(
    function: Callable[[Item], Answer], items: Sequence[Item], processes: int
) -> Iterator[tuple[int, Answer | Died]]:
    """Number and answer of each item, as they come. The processes end with the iterator, however it ends.

    function: one that can be pickled and raises nothing
    """
    busy: dict[Connection, tuple[BaseProcess, int]] = {}
    waiting = iter(range(len(items)))
    try:
        for k in islice(waiting, processes):
            process, ours = _started(function)
            busy[ours] = process, k
            _give(ours, items[k])
        while busy:
            for ready in wait(list(busy)):
                ours = cast(Connection, ready)
                process, k = busy.pop(ours)
                answer: Answer | Died = _answer(process, ours)
                following = next(waiting, None)
                if following is None:
                    _end(process, ours)
                else:
                    if isinstance(answer, Died):
                        process, ours = _started(function)
                    busy[ours] = process, following
                    _give(ours, items[following])
                yield k, answer
    finally:
        for ours, (process, _) in busy.items():
            _end(process, ours)


def _started(function: Callable[[Item], Answer]) -> tuple[BaseProcess, Connection]:
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(function, theirs), daemon=True)
    process.start()
    theirs.close()
    return process, ours


def _give(ours: Connection, item: object) -> None:
    with suppress(OSError):  # a process that has just died is noticed where its answer is awaited
        ours.send(item)


def _answer(process: BaseProcess, ours: Connection) -> Any:
    try:
        return ours.recv()
    except (EOFError, OSError):
        ours.close()
        process.join()
        return Died(process.exitcode)


def _end(process: BaseProcess, ours: Connection) -> None:
    ours.close()
    process.terminate()
    process.join()


def _work(function: Callable[[Item], Answer], theirs: Connection) -> None:
    """Answer until there is nobody to ask. Ctrl-C is for the program, which then ends its processes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(EOFError, OSError):
        while True:
            theirs.send(function(theirs.recv()))
