"""A planned motion at equal steps of time, as it is written to a file, and what a file gives back."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from graphdyn import InvalidInput
from graphdyn.excitation import FiniteMotion, sample_times
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class TimedMotion:
    """joint_names (n,), prismatic (n,): which of the joints slide; time (N,) [s]; q, v, a (N, n) [rad or m, …]"""

    joint_names: tuple[str, ...]
    prismatic: tuple[bool, ...]
    time: Array
    q: Array
    v: Array
    a: Array

    @classmethod
    def of(
        cls, course: FiniteMotion, joint_names: tuple[str, ...], prismatic: tuple[bool, ...], rate: float
    ) -> TimedMotion:
        """The motion at a rate [Hz]; the end is a row even where it is no multiple of the period."""
        times = sample_times(course.duration, rate)
        if course.duration - times[-1] > 1e-9 * course.duration:
            times = np.append(times, course.duration)
        return cls(joint_names, prismatic, times, *course.motion(times)[:3])

    @property
    def period(self) -> float:
        """Time from each row to the next [s]. Raises InvalidInput where it is not the same for all."""
        steps = np.diff(self.time)
        if np.ptp(steps) > 1e-6 * steps[0]:
            raise InvalidInput(
                f"the last step of {steps[-1]:g} s is none of {steps[0]:g} s, but programs have steps that are all "
                "equal; choose a rate that divides the duration"
            )
        return float(self.time[-1] / len(steps))


class GivenMotion(NamedTuple):
    """What a file states: times (N,) [s]; positions, velocities, accelerations (N, n), None where it has none"""

    times: Array
    positions: Array
    velocities: Array | None = None
    accelerations: Array | None = None


def dividing_rate(duration: float, rate: float) -> float:
    """The lowest rate not below this one whose period divides the duration [Hz]."""
    return max(math.ceil(duration * rate * (1 - 1e-9)), 1) / duration
