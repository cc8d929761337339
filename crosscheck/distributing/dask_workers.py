"""A function over many tasks on the workers of a Dask scheduler, which gives those of a lost worker to another.

A worker that dies takes tasks with it that only waited beside the one that killed it. Dask gives up on all of them
after some deaths; here each of them is then tried again with nothing beside it, so that the right one is blamed.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import CancelledError
from contextlib import chdir, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from crosscheck.distributing.cluster import Cluster
from crosscheck.distributing.workers import Answer, Lost, NoWorkers, Task

if TYPE_CHECKING:
    from distributed import Future

TASKS_PER_WORKER = 2
"""Tasks per worker that are given out: one is done while the next one waits."""

ANSWER_TIMEOUT = 5.0
"""After this time without an answer the scheduler is asked whether it has workers [s]."""

MAX_CHECKS_WITHOUT_WORKERS = 12
"""So often in a row it may have none: a lost one is replaced in the meantime."""


@dataclass(frozen=True)
class DaskWorkers:
    """The workers of a Dask scheduler.

    address: of the scheduler, such as tcp://10.0.0.1:8786

    Every worker has one thread, and the versions of this process; files are found under the same paths as here. A
    scheduler or workers that cannot be used raise NoWorkers when the work begins.
    """

    address: str

    def each(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Generator[tuple[int, Answer | Lost], None, None]:
        """Like Workers.each."""
        if not tasks:
            return
        work = partial(_in_folder, function, os.getcwd())
        waiting, suspected = deque(range(len(tasks))), deque[int]()
        running: dict[str, tuple[Future, int]] = {}
        ended: SimpleQueue[str] = SimpleQueue()
        with Cluster(self.address) as cluster:

            def start(k: int) -> None:
                future = cluster.submit(work, tasks[k])
                running[future.key] = future, k
                future.add_done_callback(lambda done: ended.put(done.key))

            while waiting or running:
                room = (
                    max(1, TASKS_PER_WORKER * cluster.n_workers()) if waiting else 0
                )  # one waits for a new worker, if need be
                while waiting and len(running) < room:
                    start(waiting.popleft())
                future, k = running.pop(_next(ended, cluster))
                if _killed(future):
                    suspected.append(k)
                else:
                    yield k, _answer(future, cluster)
            for k in suspected:
                start(k)
                future, _ = running.pop(_next(ended, cluster))
                yield k, _answer(future, cluster)

    def kept(self) -> nullcontext[DaskWorkers]:
        """Like LocalProcesses.kept; the processes of a scheduler go on anyway."""
        return nullcontext(self)


def _next(ended: SimpleQueue[str], cluster: Cluster) -> str:
    """Key of the next task that has ended. Raises NoWorkers where none is left for some time."""
    for _ in range(MAX_CHECKS_WITHOUT_WORKERS):
        while True:
            try:
                return ended.get(timeout=ANSWER_TIMEOUT)
            except Empty:
                if not cluster.n_workers():
                    break
    raise NoWorkers(f"the scheduler {cluster.address} has lost its last worker; start others, and run this again")


def _killed(future: Future) -> bool:
    from distributed import KilledWorker

    return future.status == "error" and isinstance(future.exception(), KilledWorker)


def _answer(future: Future, cluster: Cluster) -> Any:
    if future.status == "canceled":
        raise cluster.gone()
    if _killed(future):
        killed: Any = future.exception()
        return Lost(
            f"its process died, the last time with no task beside it, tries: {2 * (killed.allowed_failures + 1)}"
        )
    if future.status == "error":
        error = future.exception()
        return Lost(f"{type(error).__name__}: {error}")
    try:
        return future.result()
    except CancelledError as error:  # it was done, but could not be fetched
        raise cluster.gone() from error


def _in_folder(function: Callable[[Any], Any], folder: str, task: object) -> Any:
    """Run the task in the folder of the process that gives the task, where there is one, so that relative paths mean
    the same."""
    with chdir(folder if Path(folder).is_dir() else "."):
        return function(task)
