"""Times of several ways to do the same work, taken in turns, so that what disturbs one disturbs all."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

FIRST = 16
"""Samples of the first try, from which the number for a given duration is found."""

SHORTEST = 2e-3
"""[s] Shorter runs are repeated in a row until they take this long: the clock and what is called first weigh less."""

STEADY = 5e-2
"""[s] The same where throughput is measured. A processor that has just done something else takes some ten milliseconds
to be at full speed with wide vectors; whoever evaluates millions of samples is past that."""


@dataclass(frozen=True)
class Times:
    """Seconds per sample, one number per repeat, in their order."""

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        return float(np.median(self.seconds))

    @property
    def fastest(self) -> float:
        return min(self.seconds)

    @property
    def spread(self) -> tuple[float, float]:
        """Lower and upper quartile."""
        return _quartiles(self.seconds)


@dataclass(frozen=True)
class Ratio:
    """How many times as long theirs takes as ours.

    median: quotient of the medians; fastest: of the fastest repeats; spread: quartiles of the quotients of repeats that
    were measured one after the other
    """

    median: float
    fastest: float
    spread: tuple[float, float]


def ratio(ours: Times, theirs: Times) -> Ratio:
    quotients = [y / x for x, y in zip(ours.seconds, theirs.seconds, strict=True)]
    return Ratio(theirs.median / ours.median, theirs.fastest / ours.fastest, _quartiles(quotients))


def fitting_count(run: Callable[[int], object], least: int, most: int, duration: float) -> int:
    """How many samples, between least and most, this does in about the duration [s]."""
    count = max(least, min(FIRST, most))
    while True:
        seconds = min(_seconds(partial(run, count)) for _ in range(2))  # the first one is cold
        if count == most or seconds > duration / 4:
            return max(least, min(most, int(count * duration / seconds)))
        count = min(4 * count, most)


def in_turns(
    runs: Sequence[Callable[[], object]], threads: Sequence[int], repeats: int, shortest: float = SHORTEST
) -> list[list[float]]:
    """Seconds per call of each run, for every repeat. threads: as many as each may use in linear algebra libraries."""
    rows: list[list[float]] = [[] for _ in runs]
    in_a_row = []
    for run, count in zip(runs, threads, strict=True):
        with linear_algebra_threads(count):
            run()
            in_a_row.append(max(1, round(shortest / _seconds(run))))
    for _ in range(repeats):
        for row, run, calls, count in zip(rows, runs, in_a_row, threads, strict=True):
            with linear_algebra_threads(count):
                row.append(_seconds(run, calls) / calls)
    return rows


def linear_algebra_threads(count: int) -> AbstractContextManager[Any]:
    """So many threads, at most, in NumPy's linear algebra library."""
    return _libraries().limit(limits=count, user_api="blas")


@cache
def _libraries() -> Any:
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def _seconds(run: Callable[[], object], calls: int = 1) -> float:
    """With the garbage collector off, as timeit has it."""
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
