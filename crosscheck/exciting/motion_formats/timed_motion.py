"""A planned motion at equal steps of time, as it is written to a file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
