"""Times of several implementations of the same work, taken in turns, so that disturbances affect all of them."""

from __future__ import annotations

import gc
import os
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

MAX_LOAD = 0.5
"""Programs per core of the machine, over the last minute, beyond which a benchmark is disturbed."""


@dataclass(frozen=True)
class Load:
    """How busy the machine is, over the last minute.

    programs: mean number of programs that had a core or waited for one; None where the system has no figure
    cores: of the whole machine, of which this program may be allowed fewer
    """

    programs: float | None
    cores: int

    @property
    def busy(self) -> bool:
        return self.programs is not None and self.programs > MAX_LOAD * self.cores


def load() -> Load:
    try:
        programs = os.getloadavg()[0]
    except (AttributeError, OSError):  # Windows has none
        programs = None
    return Load(programs, os.cpu_count() or 1)


FIRST_RUN_SAMPLES = 16
"""Number of samples of the first run, from which the number for a given duration is estimated."""

MIN_RUN_TIME = 2e-3
"""Time below which a run is repeated without a pause [s], to reduce the weight of the clock and of the first call."""

MIN_STEADY_TIME = 5e-2
"""The same where throughput is measured [s]. A processor takes some ten milliseconds to reach full speed with wide
vectors; in the evaluation of millions of samples this does not matter."""


MAX_QUARTILE_RATIO = 1.5
"""Upper over lower quartile of a ratio from which it is not to be trusted; on a quiet machine they are within 1.1."""


@dataclass(frozen=True)
class Times:
    """Times of the repeats of a run.

    seconds: every repeat in its order, per sample [s]
    """

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median of the repeats, per sample [s]."""
        return float(np.median(self.seconds))

    @property
    def fastest(self) -> float:
        """Fastest repeat, per sample [s]."""
        return min(self.seconds)

    @property
    def quartiles(self) -> tuple[float, float]:
        """Lower and upper quartile of the repeats, per sample [s]."""
        return _quartiles(self.seconds)


@dataclass(frozen=True)
class Ratio:
    """The time of another implementation divided by ours.

    median: how many times as long theirs takes: median of the quotients of repeats that followed each other
    quartiles: of the quotients of repeats that followed each other
    fastest: quotient of the fastest repeats
    """

    median: float
    fastest: float
    quartiles: tuple[float, float]

    @property
    def steady(self) -> bool:
        """Whether its quartiles are close together."""
        low, high = self.quartiles
        return high <= MAX_QUARTILE_RATIO * low


def ratio(ours: Times, theirs: Times) -> Ratio:
    quotients = [y / x for x, y in zip(ours.seconds, theirs.seconds, strict=True)]
    return Ratio(float(np.median(quotients)), theirs.fastest / ours.fastest, _quartiles(quotients))


@dataclass
class CoreShare:
    """What part of the time of runs on one thread they had a core: less than all where others were at work too."""

    elapsed: float = 0.0
    used: float = 0.0

    def add(self, elapsed: float, used: float) -> None:
        self.elapsed += elapsed
        self.used += used

    @property
    def share(self) -> float:
        """Share between 0 and 1; 1 before anything was measured."""
        return min(1.0, self.used / self.elapsed) if self.elapsed else 1.0


def fitting_count(run: Callable[[int], object], least: int, most: int, duration: float) -> int:
    """The number of samples, between least and most, that run takes about the duration for [s]."""
    count = max(least, min(FIRST_RUN_SAMPLES, most))
    while True:
        seconds = min(_seconds(partial(run, count)) for _ in range(2))  # the first run is slower
        if count == most or seconds > duration / 4:
            return max(least, min(most, int(count * duration / seconds)))
        count = min(4 * count, most)


def in_turns(
    runs: Sequence[Callable[[], object]],
    threads: Sequence[int],
    repeats: int,
    shortest: float = MIN_RUN_TIME,
    share: CoreShare | None = None,
) -> list[list[float]]:
    """Seconds per call of each run, for every repeat.

    threads: number that each may use in linear algebra libraries; share: counts the runs on one thread
    """
    share = share or CoreShare()
    rows: list[list[float]] = [[] for _ in runs]
    in_a_row = []
    for run, count in zip(runs, threads, strict=True):
        with linear_algebra_threads(count):
            run()
            in_a_row.append(max(1, round(shortest / _seconds(run))))
    for _ in range(repeats):
        for row, run, calls, count in zip(rows, runs, in_a_row, threads, strict=True):
            with linear_algebra_threads(count):
                before = time.process_time()
                elapsed = _seconds(run, calls)
                if count == 1:
                    share.add(elapsed, time.process_time() - before)
                row.append(elapsed / calls)
    return rows


def linear_algebra_threads(count: int) -> AbstractContextManager[Any]:
    """NumPy's linear algebra library uses at most this number of threads within the context."""
    limited: AbstractContextManager[Any] = _libraries().limit(limits=count, user_api="blas")
    return limited


@cache
def _libraries() -> Any:
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def _seconds(run: Callable[[], object], calls: int = 1) -> float:
    """Seconds of these calls, with the garbage collector off, as in timeit."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        start = time.perf_counter()
        for _ in range(calls):
            run()
        return time.perf_counter() - start
    finally:
        if collecting:
            gc.enable()


def _quartiles(values: Sequence[float]) -> tuple[float, float]:
    low, high = np.quantile(values, (0.25, 0.75))
    return float(low), float(high)
