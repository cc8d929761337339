"""Times of several implementations of the same work, taken in turns, so that disturbances affect all of them."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from crosscheck.bench.machine.clocks import STEPS_PER_RUN, Clock, clock_step, elapsed
from crosscheck.bench.machine.disturbance import Disturbance

log = logging.getLogger(__name__)

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


def fitting_count(run: Callable[[int], object], least: int, most: int, duration: float, clock: Clock) -> int:
    """The number of samples, between least and most, that run takes about the duration for [s]."""
    count = max(least, min(FIRST_RUN_SAMPLES, most))
    while True:
        seconds = min(elapsed(partial(run, count)).of_one(clock) for _ in range(2))  # the first run is slower
        if count == most or seconds > duration / 4:
            return max(least, min(most, int(count * duration / seconds)))
        count = min(4 * count, most)


@dataclass(frozen=True)
class TimedRun:
    """What takes turns with others.

    threads: number that it may use in linear algebra libraries; clock: which time of it counts
    """

    call: Callable[[], object]
    threads: int
    clock: Clock


def in_turns(
    runs: Sequence[TimedRun], repeats: int, shortest: float = MIN_RUN_TIME, disturbance: Disturbance | None = None
) -> list[list[float]]:
    """Seconds per call of each run, for every repeat.

    shortest: time below which a run is several calls in a row [s]; disturbance: is told of every repeat
    """
    rows: list[list[float]] = [[] for _ in runs]
    in_a_row = []
    for run in runs:
        with linear_algebra_threads(run.threads):
            run.call()
            least = max(shortest, STEPS_PER_RUN * clock_step()) if run.clock == "processor" else shortest
            in_a_row.append(max(1, round(least / elapsed(run.call).of_one(run.clock))))
    for k in range(repeats):
        log.info("turn %d of %d", k + 1, repeats)
        for row, run, calls in zip(rows, runs, in_a_row, strict=True):
            with linear_algebra_threads(run.threads):
                taken = elapsed(run.call, calls)
            row.append(taken.by(run.clock) / calls)
            if disturbance and run.threads == 1:
                disturbance.add(taken)
        if disturbance:
            disturbance.copy()
    return rows


def linear_algebra_threads(count: int) -> AbstractContextManager[Any]:
    """NumPy's linear algebra library uses at most this number of threads within the context."""
    limited: AbstractContextManager[Any] = _libraries().limit(limits=count, user_api="blas")
    return limited


@cache
def _libraries() -> Any:
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def _quartiles(values: Sequence[float]) -> tuple[float, float]:
    low, high = np.quantile(values, (0.25, 0.75))
    return float(low), float(high)
