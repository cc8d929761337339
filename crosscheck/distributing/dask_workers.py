"""A function over many tasks on the workers of a Dask scheduler, which gives those of a lost worker to another.

A worker that dies takes tasks with it that only waited beside the one that killed it. Dask gives up on all of them
after some deaths; here each of them is then tried again with nothing beside it, so that the right one is blamed.
"""

from __future__ import annotations

import logging
import os
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, chdir, closing, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from crosscheck.distributing.workers import Answer, Lost, NoWorkers, Task, differences, versions
from graphdyn.display import short_repr
from graphdyn.errors import install_line

if TYPE_CHECKING:
    from distributed import Client, Future


SCHEDULER_TIMEOUT = 10.0
"""Time in which a scheduler answers, and its first worker arrives [s]."""

INSTALL_COMMAND = install_line("distributed")


NOISY_LOGGERS = ("distributed.client", "distributed.core", "distributed.comm.tcp", "distributed.batched", "asyncio")
"""Loggers that tell the end of a scheduler by their own traces; here it is one error, with a remedy."""


@contextmanager
def quiet_loggers() -> Iterator[None]:
    """None of them says anything, whichever levels Dask gives them when it is imported."""

    def nothing(record: logging.LogRecord) -> bool:
        return False

    loggers = [logging.getLogger(name) for name in NOISY_LOGGERS]
    for logger in loggers:
        logger.addFilter(nothing)
    try:
        yield
    finally:
        for logger in loggers:
            logger.removeFilter(nothing)


class Cluster:
    """A scheduler whose workers have one thread each and the versions of this process. Raises NoWorkers."""

    def __init__(self, address: str, libraries: Sequence[str] = ()) -> None:
        """libraries: further ones whose versions have to be those of this process"""
        self.address = address
        self._libraries = tuple(libraries)
        self._known = set[str]()
        with ExitStack() as opened:
            opened.enter_context(quiet_loggers())
            self._client = _connected(address)
            opened.callback(lambda: self._client.close())
            try:
                self._client.wait_for_workers(1, timeout=SCHEDULER_TIMEOUT)
            except TimeoutError:
                raise NoWorkers(
                    f"the scheduler {address} has no worker; start some with: dask worker {address} --nworkers auto "
                    "--nthreads 1"
                ) from None
            self._opened = opened.pop_all()

    def close(self) -> None:
        self._opened.close()

    def n_workers(self) -> int:
        """How many there are now, after those that are new have been examined. Raises NoWorkers."""
        try:
            threads: dict[str, int] = self._client.nthreads()
            new = sorted(set(threads) - self._known)
            found = self._client.run(versions, self._libraries, workers=new, on_error="return") if new else {}
        except OSError as error:
            raise self.gone() from error
        for worker, its in found.items():
            examine(worker, threads[worker], its, self._libraries)
        self._known.update(new)
        return len(threads)

    def submit(self, function: Callable[[Any], Any], task: object) -> Future:
        """Begin a task; it is not remembered from earlier ones."""
        return self._client.submit(function, task, key=f"graphdyn-{uuid4().hex}", pure=False)

    def gone(self) -> NoWorkers:
        """The error to raise if the scheduler no longer answers."""
        return NoWorkers(f"the connection to the scheduler {self.address} is lost; see its log, and start it again")


def _connected(address: str) -> Client:
    try:
        from distributed import Client
        from distributed.versions import VersionMismatchWarning
    except ImportError as error:
        raise NoWorkers(f"the package distributed is not installed ({error}); run: {INSTALL_COMMAND}") from None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", VersionMismatchWarning)  # what matters here is examined for every worker
        try:
            return Client(address, timeout=SCHEDULER_TIMEOUT, set_as_default=False)
        except (OSError, ValueError, ImportError) as error:
            reason = " ".join(str(error).split())
            raise NoWorkers(
                f"no Dask scheduler answers at {address}: {reason}; start one with: dask scheduler, and give the "
                "address that it prints, such as tcp://10.0.0.1:8786"
            ) from None


def examine(worker: str, threads: int, found: dict[str, str] | Exception, libraries: Sequence[str] = ()) -> None:
    """Raise NoWorkers for a worker that cannot be used.

    found: its versions, or what asking for them raised; libraries: further ones that it reports
    """
    here = versions(libraries)
    if isinstance(found, ImportError):
        raise NoWorkers(
            f"the worker {worker} does not have graphdyn ({found}); install version {here['graphdyn']} there: "
            f"{INSTALL_COMMAND}"
        )
    if isinstance(found, OSError | TimeoutError):
        return  # it has gone in the meantime
    if isinstance(found, Exception):
        raise NoWorkers(
            f"the worker {worker} cannot say which versions it has ({type(found).__name__}: {found}); install graphdyn "
            f"{here['graphdyn']} there: {INSTALL_COMMAND}"
        )
    different = differences(here, found)
    if different:
        raise NoWorkers(
            f"the worker {worker} has {different}; install the versions of this process there, for answers that are "
            "the same to the last bit"
        )
    if threads != 1:
        raise NoWorkers(
            f"the worker {worker} does {threads} tasks at once in one process; start it with --nthreads 1, and with "
            f"--nworkers {threads} for as many processes"
        )


TASKS_PER_WORKER = 2
"""Tasks per worker that are given out: one is done while the next one waits."""

ANSWER_TIMEOUT = 5.0
"""After this time without an answer the scheduler is asked whether it has workers [s]."""

MAX_CHECKS_WITHOUT_WORKERS = 12
"""So often in a row it may have none: a lost one is replaced in the meantime."""


@dataclass(frozen=True)
@short_repr
class DaskWorkers:
    """The workers of a Dask scheduler.

    address: of the scheduler, such as tcp://10.0.0.1:8786
    libraries: further ones whose versions have to be those of this process

    Every worker has one thread, and the versions of this process; files are found under the same paths as here. A
    scheduler or workers that cannot be used raise NoWorkers when the work begins.
    """

    address: str
    libraries: tuple[str, ...] = ()

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
        with closing(Cluster(self.address, self.libraries)) as cluster:

            def start(k: int) -> None:
                future = cluster.submit(work, tasks[k])
                running[future.key] = future, k
                future.add_done_callback(lambda done: ended.put(done.key))

            while waiting or running:
                # one waits for a new worker, if need be
                room = max(1, TASKS_PER_WORKER * cluster.n_workers()) if waiting else 0
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
    raise NoWorkers(f"the scheduler {cluster.address} has lost its last worker; start others")


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
        return Lost(f"{type(error).__name__}: {error}", died=False)
    try:
        return future.result()
    except CancelledError as error:  # it was done, but could not be fetched
        raise cluster.gone() from error


def _in_folder(function: Callable[[Any], Any], folder: str, task: object) -> Any:
    """Run the task in the folder of the process that gives the task, where there is one, so that relative paths mean
    the same."""
    with chdir(folder if Path(folder).is_dir() else "."):
        return function(task)
