"""What an integration hands over: rows of numbers, and why it ended."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array

COURSE_COLUMNS = ("q", "v", "work", "loss", "tau", "a", "passive")


@dataclass(frozen=True)
class Event:
    """A function of t, q and v whose change of sign is looked for.

    function: (t, q, v) → a number
    name: in the result
    stop: whether the simulation ends there
    direction: 1 for a rise through zero, -1 for a fall, 0 for both
    """

    function: Callable[[float, Array, Array], float]
    name: str = "event"
    stop: bool = True
    direction: Literal[-1, 0, 1] = 0


@dataclass(frozen=True, eq=False)
class Occurrence:
    """An event that happened. time [s]; q, v (n,)"""

    name: str
    time: float
    q: Array
    v: Array


@dataclass(frozen=True, eq=False)
class SimulatedCourse:
    """Times (N,) and the columns of COURSE_COLUMNS (N, width).

    ended: name of the event that ended it, "" for the duration
    """

    time: Array
    columns: dict[str, Array]
    occurrences: tuple[Occurrence, ...] = ()
    ended: str = ""

    @staticmethod
    def joined(parts: list[SimulatedCourse], occurrences: list[Occurrence], ended: str) -> SimulatedCourse:
        columns = {name: np.concatenate([part.columns[name] for part in parts]) for name in COURSE_COLUMNS}
        return SimulatedCourse(np.concatenate([part.time for part in parts]), columns, tuple(occurrences), ended)

    def rows(self, chosen: NDArray[np.int64] | slice) -> SimulatedCourse:
        """Some of the rows."""
        columns = {name: column[chosen] for name, column in self.columns.items()}
        return SimulatedCourse(self.time[chosen], columns, self.occurrences, self.ended)
