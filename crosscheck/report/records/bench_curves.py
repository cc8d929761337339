"""What `graphdyn bench 2` says of a diagram: times against the size of a batch, the number of bodies or threads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from crosscheck.report.records._fields import Number, taken
from crosscheck.report.records.bench_times import Quartiles, Repeats, times_fields
from crosscheck.studies.bench.curves import ScalingCurve


@dataclass(frozen=True, kw_only=True)
class PointRecord:
    """One point."""

    x: int
    """What is varied."""

    median: float
    """Median of the repeats, per sample or call [s]."""

    fastest: float
    """Fastest repeat, per sample or call [s]."""

    quartiles: Quartiles
    """Lower and upper quartile of the repeats, per sample or call [s]."""

    seconds: Repeats
    """Every repeat in its order, per sample or call [s]."""


@dataclass(frozen=True, kw_only=True)
class LineRecord:
    """One contender."""

    name: str
    """Who."""

    threads: int
    """Threads that may be used; 0 where they are varied."""

    exponent: Number
    """k of a time that grows as x^k, from the fastest repeats of the upper half of the points; null for fewer than
    three.
    """

    points: Sequence[PointRecord]
    """In ascending x."""


@dataclass(frozen=True, kw_only=True)
class CurveRecord:
    """One diagram."""

    name: str
    """Which diagram."""

    title: str
    """Its name in words."""

    x: str
    """What is varied."""

    seconds_of: str
    """What the times are of: a sample, or a first call."""

    notes: Sequence[str]
    """What a reader must know."""

    lines: Sequence[LineRecord]
    """One per contender."""


def curve_record(curve: ScalingCurve) -> CurveRecord:
    return taken(
        CurveRecord,
        curve,
        seconds_of=curve.seconds,
        lines=[
            taken(
                LineRecord,
                line,
                points=[PointRecord(x=x, **times_fields(times)) for x, times in zip(line.x, line.times, strict=True)],
            )
            for line in curve.lines
        ],
    )
