"""What other programs take from a benchmark: cores, and caches that all cores share."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from crosscheck.bench.machine.clocks import Elapsed, elapsed
from graphdyn.layout import Array

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


COPIED_DOUBLES = 2**19
"""Doubles of a copy, 4 MB read and 4 MB written: more than second-level caches hold, less than most of the third."""

MAX_COPY_SLOWDOWN = 1.25
"""How many times as long as at best a copy may take: on a quiet machine 1.1, 1.5 where other programs copy 32 MB."""

N_COPIES = 100
"""Copies in a row, some ten milliseconds."""


@dataclass
class Disturbance:
    """What was taken from the runs of a work.

    processor, wall: time of the runs on one thread, by both clocks [s]
    copies: processor time of a copy within the caches, after every repeat [s]
    """

    processor: float = 0.0
    wall: float = 0.0
    copies: list[float] = field(default_factory=list)

    def add(self, run: Elapsed) -> None:
        self.processor += run.processor
        self.wall += run.wall

    @property
    def core_share(self) -> float:
        """Part of the time for which runs on one thread had a core; 1 before anything was measured."""
        return min(1.0, self.processor / self.wall) if self.wall else 1.0

    def copy(self) -> None:
        """Time a copy, which takes longer where other programs drive its memory out of the caches."""
        source, target = _memory()
        self.copies.append(elapsed(lambda: np.copyto(target, source), N_COPIES).processor / N_COPIES)


@cache
def _memory() -> tuple[Array, Array]:
    return np.ones(COPIED_DOUBLES), np.ones(COPIED_DOUBLES)
