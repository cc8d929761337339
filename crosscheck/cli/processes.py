"""A function over many items in parallel processes. A process that dies costs only the item it was working on."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar, cast

Item = TypeVar("Item")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Died:
    """In place of an answer where the process died. code: its exit code, or minus the number of a signal."""

    code: int | None


def each(
    function: Callable[[Item], Answer], items: Sequence[Item], processes: int
) -> Iterator[tuple[int, Answer | Died]]:
    """Number and answer of each item, in the order of completion. The processes end when the iterator is closed.

    function: can be pickled, and raises nothing
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
    with suppress(OSError):  # that the process has died is noticed when its answer is awaited
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


def end_with_parent() -> None:
    """From now on this process ends as soon as the one that started it has ended, even if that was killed."""
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _work(function: Callable[[Item], Answer], theirs: Connection) -> None:
    """Answer until the pipe is closed. Ctrl-C is ignored: the main process ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    with suppress(EOFError, OSError):
        while True:
            theirs.send(function(theirs.recv()))
