"""A function over many tasks in parallel processes of this machine. One that dies costs only the task it was doing."""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from typing import Any, cast

from crosscheck.distributing.workers import Answer, Lost, Task

log = logging.getLogger(__name__)

LOGGERS = ("graphdyn", "urdf", "crosscheck")
"""Loggers whose messages of level INFO say what begins; those of a process are logged here, too."""

TOLD_INTERVAL = 0.2
"""Shortest time from one message of a process to the next [s]; those between are left out."""


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
        """Like Workers.each."""
        with self.kept() as workers:
            yield from workers.each(function, tasks)

    @contextmanager
    def kept(self) -> Iterator[KeptProcesses]:
        """Workers whose processes go on between calls of `each`, and know what they have imported and compiled."""
        workers = KeptProcesses(self.count, self.tries)
        try:
            yield workers
        finally:
            workers.end()


class KeptProcesses:
    """Local processes; one that has no task left waits for the next work."""

    def __init__(self, count: int, tries: int):
        self._count, self._tries = count, tries
        self._idle: list[_Process] = []

    def each(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Generator[tuple[int, Answer | Lost], None, None]:
        """Like Workers.each."""
        waiting = deque(range(len(tasks)))
        deaths = Counter[int]()
        busy: dict[Connection, tuple[_Process, int]] = {}

        def give_next() -> None:
            process, k = self._waiting_process(), waiting.popleft()
            busy[process.pipe] = process, k
            process.give(function, tasks[k])

        try:
            while waiting and len(busy) < self._count:
                give_next()
            while busy:
                for ready in wait(list(busy)):
                    process, k = busy.pop(cast(Connection, ready))
                    answer = process.answer()
                    if isinstance(answer, Told):
                        busy[process.pipe] = process, k
                        log.info("%s", answer.message)
                        continue
                    if isinstance(answer, Lost):
                        deaths[k] += 1
                        if deaths[k] < self._tries:
                            waiting.appendleft(k)
                            give_next()
                            continue
                        answer = Lost(f"{answer.reason}, tries: {deaths[k]}")
                    else:
                        self._idle.append(process)
                    if waiting:
                        give_next()
                    yield k, answer
        finally:
            for process, _ in busy.values():
                process.end()

    def _waiting_process(self) -> _Process:
        """A new one where none that is alive waits."""
        while self._idle:
            process = self._idle.pop()
            if process.alive:
                return process
            process.end()
        return _Process()

    def end(self) -> None:
        while self._idle:
            self._idle.pop().end()


class _Process:
    """One that answers what comes through a pipe."""

    def __init__(self) -> None:
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()
        self._function: Callable[[Any], Any] | None = None

    @property
    def alive(self) -> bool:
        return self._process.is_alive()

    def give(self, function: Callable[[Any], Any], task: object) -> None:
        """The function travels once, with its first task."""
        new = None if function is self._function else function
        self._function = function
        with suppress(OSError):  # that the process has died is noticed when its answer is awaited
            self.pipe.send((new, task, log.isEnabledFor(logging.INFO)))

    def answer(self) -> Any:
        try:
            return self.pipe.recv()
        except (EOFError, OSError):
            self.pipe.close()
            self._process.join()
            return Lost(f"its process died with code {self._process.exitcode}")

    def end(self) -> None:
        self.pipe.close()
        self._process.terminate()
        self._process.join()


def end_with_parent() -> None:
    """Let this process end as soon as the one that started it has ended, even if that was killed."""
    parent = parent_process()
    assert parent is not None

    def wait() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def _work(theirs: Connection) -> None:
    """Answer until the pipe is closed. Ctrl-C is ignored: the main process ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    function: Any = None
    telling = Telling(theirs)
    for logger in map(logging.getLogger, LOGGERS):
        logger.addHandler(telling)
    with suppress(EOFError, OSError):
        while True:
            new, task, heard = theirs.recv()
            for logger in map(logging.getLogger, LOGGERS):
                logger.setLevel(logging.INFO if heard else logging.NOTSET)
            function = new or function
            telling.answer(function(task))


@dataclass(frozen=True)
class Told:
    """A message of a process that is not yet done."""

    message: str


class Telling(logging.Handler):
    """What begins, through the pipe of the answers: the newest message at once, or TOLD_INTERVAL after the last."""

    def __init__(self, pipe: Connection) -> None:
        super().__init__(logging.INFO)
        self._pipe, self._alone, self._last = pipe, threading.Lock(), 0.0
        self._waiting: threading.Timer | None = None
        self._message = ""

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno != logging.INFO:
            return
        with self._alone:
            self._message = record.getMessage()
            if (left := self._last + TOLD_INTERVAL - time.monotonic()) <= 0:
                self._tell()
            elif self._waiting is None:
                self._waiting = threading.Timer(left, self._tell_late)
                self._waiting.daemon = True
                self._waiting.start()

    def answer(self, answer: object) -> None:
        """Send an answer; what has begun before is not told any more."""
        with self._alone:
            self._message = ""
            self._pipe.send(answer)

    def _tell_late(self) -> None:
        with self._alone:
            self._waiting = None
            if self._message:
                self._tell()

    def _tell(self) -> None:
        self._last = time.monotonic()
        with suppress(OSError):
            self._pipe.send(Told(self._message))
        self._message = ""
