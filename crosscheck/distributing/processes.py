"""A function over many tasks in parallel processes of this machine. One that dies costs only the task it was doing."""

from __future__ import annotations

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from typing import Any, cast

from crosscheck.distributing.workers import Answer, Lost, Task


@dataclass(frozen=True)
class LocalProcesses:
    """Processes of this machine.

    count: of processes at once
    tries: how often a task is begun whose process dies
    """

    count: int
    tries: int = 2

    def each(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Generator[tuple[int, Answer | Lost], None, None]:
        """As in Workers."""
        waiting = deque(range(len(tasks)))
        deaths = Counter[int]()
        busy: dict[Connection, tuple[_Process, int]] = {}

        def give_next(process: _Process) -> None:
            k = waiting.popleft()
            busy[process.pipe] = process, k
            process.give(tasks[k])

        try:
            while waiting and len(busy) < self.count:
                give_next(_Process(function))
            while busy:
                for ready in wait(list(busy)):
                    process, k = busy.pop(cast(Connection, ready))
                    answer = process.answer()
                    if isinstance(answer, _Died):
                        deaths[k] += 1
                        if deaths[k] < self.tries:
                            waiting.appendleft(k)
                            give_next(_Process(function))
                            continue
                        answer = Lost(f"its process died with code {answer.code}, tries: {deaths[k]}")
                        process = _Process(function) if waiting else process
                    if waiting:
                        give_next(process)
                    else:
                        process.end()
                    yield k, answer
        finally:
            for process, _ in busy.values():
                process.end()


@dataclass(frozen=True)
class _Died:
    """code: exit code of a process that ended without an answer, or minus the number of a signal."""

    code: int | None


class _Process:
    """One that answers what comes through a pipe."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(function, theirs), daemon=True)
        self._process.start()
        theirs.close()

    def give(self, task: object) -> None:
        with suppress(OSError):  # that the process has died is noticed when its answer is awaited
            self.pipe.send(task)

    def answer(self) -> Any:
        try:
            return self.pipe.recv()
        except (EOFError, OSError):
            self.pipe.close()
            self._process.join()
            return _Died(self._process.exitcode)

    def end(self) -> None:
        self.pipe.close()
        self._process.terminate()
        self._process.join()


def end_with_parent() -> None:
    """From now on this process ends as soon as the one that started it has ended, even if that was killed."""
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _work(function: Callable[[Any], Any], theirs: Connection) -> None:
    """Answer until the pipe is closed. Ctrl-C is ignored: the main process ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    with suppress(EOFError, OSError):
        while True:
            theirs.send(function(theirs.recv()))
