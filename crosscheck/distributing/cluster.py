"""The connection to a Dask scheduler, and which workers it has."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from crosscheck.distributing.workers import NoWorkers, differences, versions

if TYPE_CHECKING:
    from distributed import Client, Future

SCHEDULER_TIMEOUT = 10.0
"""Time in which a scheduler answers, and its first worker arrives [s]."""

INSTALL_COMMAND = "pip install 'graphdyn[distributed]'"


class Cluster:
    """A scheduler whose workers have one thread each and the versions of this process. Raises NoWorkers."""

    def __init__(self, address: str) -> None:
        self.address = address
        self._client = _connected(address)
        self._known = set[str]()
        try:
            self._client.wait_for_workers(1, timeout=SCHEDULER_TIMEOUT)
        except TimeoutError:
            self._client.close()
            raise NoWorkers(
                f"the scheduler {address} has no worker; start some with: dask worker {address} --nworkers auto "
                "--nthreads 1"
            ) from None

    def __enter__(self) -> Cluster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._client.close()

    def n_workers(self) -> int:
        """How many there are now, after those that are new have been examined. Raises NoWorkers."""
        try:
            threads: dict[str, int] = self._client.nthreads()
            new = sorted(set(threads) - self._known)
            found = self._client.run(versions, workers=new, on_error="return") if new else {}
        except OSError as error:
            raise self.gone() from error
        for worker, its in found.items():
            examine(worker, threads[worker], its)
        self._known.update(new)
        return len(threads)

    def submit(self, function: Callable[[Any], Any], task: object) -> Future:
        """Begin a task; it is not remembered from earlier ones."""
        return self._client.submit(function, task, key=f"graphdyn-{uuid4().hex}", pure=False)

    def gone(self) -> NoWorkers:
        """The error to raise if the scheduler no longer answers."""
        return NoWorkers(f"the connection to the scheduler {self.address} is lost; see its log, and run this again")


def _connected(address: str) -> Client:
    try:
        from distributed import Client
        from distributed.versions import VersionMismatchWarning
    except ImportError as error:
        raise NoWorkers(f"Dask is not installed ({error}); {INSTALL_COMMAND}") from None
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


def examine(worker: str, threads: int, found: dict[str, str] | Exception) -> None:
    """Raise NoWorkers for a worker that cannot be used. found: its versions, or what asking for them raised."""
    here = versions()
    if isinstance(found, ImportError):
        raise NoWorkers(
            f"the worker {worker} does not have graphdyn ({found}); install version {here['graphdyn']} there: "
            f"{INSTALL_COMMAND}"
        )
    if isinstance(found, Exception):
        return  # it has gone in the meantime
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
