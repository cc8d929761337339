"""Two clocks: processor time of a thread, which stands still while another program has the core, and wall time.

One thread is timed in processor time. Several threads are timed in wall time, which is what they are for. The processor
time of the whole program would also count threads of libraries that wait busily after their work, as those of OpenMP.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from functools import cache
from typing import Literal, NamedTuple

Clock = Literal["processor", "wall"]
"""Which time counts: that in which the calling thread had a core, or that of a clock on the wall."""


def clock_of(threads: int) -> Clock:
    """The clock by which a run with so many threads is timed."""
    return "processor" if threads == 1 else "wall"


class Elapsed(NamedTuple):
    """What both clocks say about a run [s]."""

    processor: float
    wall: float

    def by(self, clock: Clock) -> float:
        return self.processor if clock == "processor" else self.wall

    def of_one(self, clock: Clock) -> float:
        """The time of a single run, which may be too short for the clock of processor time: then wall time."""
        return self.wall if self.processor < STEPS_PER_RUN * clock_step() else self.by(clock)


def elapsed(call: Callable[[], object], calls: int = 1) -> Elapsed:
    """The time of these calls, with the garbage collector off, as in timeit."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        wall, processor = time.perf_counter(), time.thread_time()
        for _ in range(calls):
            call()
        return Elapsed(time.thread_time() - processor, time.perf_counter() - wall)
    finally:
        if collecting:
            gc.enable()


@cache
def clock_step() -> float:
    """The smallest step of processor time that is seen [s]: mostly a microsecond, in some sandboxes 10 ms."""
    steps: list[float] = []
    before = time.thread_time()
    while len(steps) < N_STEPS:
        after = time.thread_time()
        if after > before:
            steps.append(after - before)
            before = after
    return min(steps)


N_STEPS = 3
"""Number of steps of the clock that are looked at."""

STEPS_PER_RUN = 200
"""Steps of the clock in the shortest run: they limit its error to half a percent."""
