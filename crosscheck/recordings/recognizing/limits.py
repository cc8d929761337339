"""Positions against the limits of the robot, which tell degrees, and angles in front of the gears."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.recordings.mapping.units import TURNING_UNITS
from crosscheck.recordings.recognizing.work import LogWork
from graphdyn.layout import Array

ZERO_SLACK = 0.1
"""Part of the range of a joint by which its positions may leave its limits: zeros differ from those of the file."""

MOST_TURNS = 4 * np.pi
"""Largest position of a joint without limits that is taken for an angle behind the gears [rad]."""

LEAST_DEGREES = 2 * np.pi
"""Range below which positions that may be rad are not taken for degrees: a motion of 6° identifies nothing."""


def units_within(work: LogWork, values: Array) -> list[str]:
    """Units in which positions (N, n) are within the limits; deg only for motion that would be seen."""
    found = [unit for unit in ("rad", "deg") if beyond(work, values * TURNING_UNITS["q"][unit]) <= ZERO_SLACK]
    size = float(np.max(np.ptp(values, axis=0), initial=0.0))
    if found == ["rad", "deg"] and size < LEAST_DEGREES:
        return ["rad"]
    return found


def beyond(work: LogWork, q: Array) -> float:
    """The distance of positions (N, n) [rad or m] beyond the limits, as a part of the range, at the worst joint."""
    worst = 0.0
    for j, (lower, upper) in enumerate(_ranges(work)):
        here = q[:, j][np.isfinite(q[:, j])]
        if here.size:
            worst = max(worst, (here.max() - upper) / (upper - lower), (lower - here.min()) / (upper - lower))
    return float(worst)


def reaches(work: LogWork, values: Array) -> Array:
    """The largest position of each joint as a multiple of its largest limit."""
    most = np.nanmax(np.abs(values), axis=0, initial=0.0)
    return np.array([size / max(abs(a), abs(b)) for size, (a, b) in zip(most, _ranges(work), strict=True)])


def _ranges(work: LogWork) -> Iterator[tuple[float, float]]:
    by_name = {joint.name: joint for joint in work.model.joints}
    for name in work.model.independent_joints:
        limits = by_name[name].limits
        lower, upper = limits.lower, limits.upper
        known = lower is not None and upper is not None and lower < upper
        yield (lower, upper) if known else (-MOST_TURNS, MOST_TURNS)  # type: ignore[misc]
