"""A work (one task of the benchmark), its contenders (implementations of it), and their measurements."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from crosscheck.bench.machine.clocks import Clock, clock_of
from crosscheck.bench.machine.disturbance import Disturbance
from crosscheck.bench.machine.timing import (
    MIN_STEADY_TIME,
    Ratio,
    TimedRun,
    Times,
    fitting_count,
    in_turns,
    linear_algebra_threads,
    ratio,
)
from crosscheck.bench.states import States
from graphdyn.layout import Array

log = logging.getLogger(__name__)

UNLIMITED_SAMPLES = sys.maxsize
"""Largest number of samples of a contender without a limit of its own."""

AMORTIZED_SAMPLES = 10_000
"""Number of samples per call from which the overhead of the call is negligible."""

MIN_CORE_SHARE = 0.95
"""Part of their time for which runs on one thread need a core, so that wall times, those of several threads, are to be
trusted. 0.99 and more on a quiet machine, 0.5 where two other programs keep both of two cores busy."""


@dataclass(frozen=True, eq=False)
class Contender:
    """One implementation of a work.

    name, threads: of the implementation, and the number of threads it may use
    run: run(count) computes the first count samples and returns the result
    errors: of that result against Pinocchio's, per sample; None where nothing is judged
    included: what the time includes besides the arithmetic
    ours: whether it is the form of graphdyn that the ratios refer to
    least, most: smallest number of samples of a run, where a call has an overhead, and largest
    """

    name: str
    threads: int
    run: Callable[[int], Array]
    errors: Callable[[Array], Array] | None
    included: str
    ours: bool = False
    least: int = 1
    most: int = UNLIMITED_SAMPLES


Forms = Callable[[States, Sequence[int]], list[Contender]]
"""The contenders of a work by one library, with each number of threads."""


@dataclass(frozen=True, eq=False)
class Work:
    """One task, and the contenders that do it.

    scale: what errors are relative to, in words; bound: the largest error that counts as agreement
    """

    name: str
    title: str
    scale: str
    bound: float
    contenders: tuple[Contender, ...]


@dataclass(frozen=True)
class TimedContender:
    """A contender with its times.

    name, threads: of the implementation, and the number of threads it may use
    clock: what its times are: processor time of one thread, wall time of several
    ours: whether it is a form of graphdyn whose ratios are asked for
    samples: of each run
    error: largest relative error against Pinocchio; None where nothing was judged
    judged: samples, or joints for sums of products, that were judged
    included: what the time includes besides the arithmetic
    """

    name: str
    threads: int
    clock: Clock
    ours: bool
    samples: int
    times: Times
    error: float | None
    judged: int
    included: str


@dataclass(frozen=True)
class SpeedRatio:
    """The ratio of two entries with the same number of threads.

    ours, theirs: names of our form and of the other; threads: that may be used
    clock: processor time of one thread, wall time of several
    undisturbed: whether the runs had the cores, where it is a ratio of wall times
    """

    ours: str
    theirs: str
    threads: int
    clock: Clock
    ratio: Ratio
    undisturbed: bool = True

    @property
    def trusted(self) -> bool:
        """Whether the quartiles are close together and, where wall times are compared, the runs had the cores."""
        return self.ratio.steady and (self.undisturbed or self.clock == "processor")


@dataclass(frozen=True)
class MeasuredWork:
    """A measured work.

    name: which work; title: its name in words
    scale: what errors are relative to; bound: largest relative error that counts as agreement
    entries: everyone who took part
    core_share: part of the time of runs on one thread for which they had a core; below 0.95, others disturbed them
    copy: times of a copy of 4 MB within the caches, after every repeat; longer where other programs use the caches
    limit: times of a loop that does as much and never waits, on one thread; None where there is none
    """

    name: str
    title: str
    scale: str
    bound: float
    entries: tuple[TimedContender, ...]
    core_share: float
    copy: Times
    limit: Times | None = None

    @property
    def undisturbed(self) -> bool:
        return self.core_share >= MIN_CORE_SHARE

    @property
    def comparisons(self) -> tuple[SpeedRatio, ...]:
        """Our form against every other entry with the same number of threads."""
        return tuple(
            SpeedRatio(
                ours.name, theirs.name, ours.threads, ours.clock, ratio(ours.times, theirs.times), self.undisturbed
            )
            for ours in self.entries
            if ours.ours
            for theirs in self.entries
            if not theirs.ours and theirs.threads == ours.threads
        )

    @property
    def above_limit(self) -> Ratio | None:
        """How many times as long as the limit our first form on one thread takes."""
        if self.limit is None:
            return None
        return ratio(self.limit, next(entry.times for entry in self.entries if entry.ours and entry.threads == 1))

    @property
    def agrees(self) -> bool:
        """Whether our answers are within the bound."""
        return all(entry.error is None or entry.error <= self.bound for entry in self.entries if entry.ours)


def measure(
    work: Work,
    samples: int,
    duration: float,
    repeats: int,
    limit: Callable[[int], object] | None = None,
    clock: Callable[[int], Clock] = clock_of,
) -> MeasuredWork:
    """Measure all contenders of a work in turns.

    duration: of one run of slow ones, which get fewer samples [s]
    limit: a loop for so many samples that takes turns with them, directly after the first
    clock: which time counts, by number of threads
    """
    counts = []
    for contender in work.contenders:
        log.info("samples for %s", contender.name)
        with linear_algebra_threads(contender.threads):
            most = min(samples, contender.most)
            least = min(contender.least, most)
            counts.append(fitting_count(contender.run, least, most, duration, clock(contender.threads)))
    errors = [_largest_error(contender, count) for contender, count in zip(work.contenders, counts, strict=True)]
    runs = [
        TimedRun(partial(c.run, count), c.threads, clock(c.threads))
        for c, count in zip(work.contenders, counts, strict=True)
    ]
    if limit is not None:
        runs.insert(1, TimedRun(partial(limit, samples), 1, clock(1)))
    disturbance = Disturbance()
    rows = in_turns(runs, repeats, MIN_STEADY_TIME, disturbance)
    limited = None if limit is None else _per_sample(rows.pop(1), samples)
    entries = tuple(
        TimedContender(
            c.name, c.threads, clock(c.threads), c.ours, count, _per_sample(row, count), error, judged, c.included
        )
        for c, count, row, (error, judged) in zip(work.contenders, counts, rows, errors, strict=True)
    )
    share, copy = disturbance.core_share, Times(tuple(disturbance.copies))
    return MeasuredWork(work.name, work.title, work.scale, work.bound, entries, share, copy, limited)


def _per_sample(seconds: Sequence[float], samples: int) -> Times:
    return Times(tuple(second / samples for second in seconds))


def _largest_error(contender: Contender, count: int) -> tuple[float | None, int]:
    if contender.errors is None:
        return None, 0
    errors = contender.errors(contender.run(count))
    return float(np.where(np.isnan(errors), np.inf, errors).max()), len(errors)
