"""The format `graphdyn bench 4`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from crosscheck.bench.benchmark import Benchmark
from crosscheck.bench.contender import MeasuredWork, SpeedRatio, TimedContender
from crosscheck.bench.curves import Line, ScalingCurve
from crosscheck.bench.identification import IdentificationRun, Identifications
from crosscheck.bench.machine.floor import Floor
from crosscheck.bench.machine.timing import Ratio, Times
from crosscheck.bench.works import WORK_DESCRIPTIONS
from crosscheck.report.records.record import CommandRecord, Keywords, Record, attribute, written

Quartiles = Annotated[Sequence[float], Keywords(minItems=2, maxItems=2)]
Repeats = Annotated[Sequence[float], Keywords(minItems=1)]


class TimesRecord(Record, of=Times):
    """Times of one import, one first call, or one copy."""

    seconds: Repeats
    median = attribute()
    fastest = attribute()
    quartiles = attribute()


class TimedRecord(Record):
    """Somebody whose times were taken."""

    median = attribute("times.median")
    fastest = attribute("times.fastest")
    quartiles = attribute("times.quartiles")
    seconds: Repeats = attribute("times.seconds")


class ContenderRecord(TimedRecord, of=TimedContender, leave_out=("times",)):
    """One contender."""


class RatioRecord(Record):
    """How the times of two compare.

    ratio: how many times as long one takes: median of the quotients of repeats that followed each other
    fastest_ratio: quotient of the fastest repeats
    quartiles: of the quotients of repeats that followed each other
    """

    ratio: float
    fastest_ratio: float
    quartiles: Quartiles


class BenchRatioRecord(Record, of=SpeedRatio, only=("ours", "theirs", "threads", "clock")):
    """One comparison."""

    ratio = attribute("ratio.median")
    fastest_ratio = attribute("ratio.fastest")
    quartiles = attribute("ratio.quartiles")
    trusted = attribute()


class FloorRecord(RatioRecord, of=Floor):
    """What a sample takes at least, in loops that never wait and took turns with the rest, and what ours takes: the
    ratio of our first form to it.
    """


class WorkRecord(Record, of=MeasuredWork, leave_out=("limit",)):
    """One work.

    floor: what a sample takes at least on one thread of this machine; null where that is not known
    ratios: our forms against every other with the same number of threads
    """

    name: Annotated[str, Keywords(enum=list(WORK_DESCRIPTIONS))]
    agrees = attribute()
    copy: TimesRecord
    floor: FloorRecord | None
    ratios: Sequence[BenchRatioRecord] = attribute("comparisons")
    entries: Sequence[ContenderRecord]


class PointRecord(TimesRecord, of=Times):
    """One point; times are per sample or call.

    x: what is varied
    """

    x: int


class LineRecord(Record, of=Line, only=("name", "threads")):
    """One contender.

    points: in ascending x
    """

    exponent = attribute()
    points: Sequence[PointRecord]


class CurveRecord(Record, of=ScalingCurve):
    """One diagram."""

    lines: Sequence[LineRecord]


class IdentificationRatioRecord(RatioRecord):
    """Ours against Pinocchio's loop with lstsq.

    threads: that may be used
    trusted: the quartiles are close together
    """

    threads: int
    trusted: bool


class IdentificationRunRecord(TimedRecord, of=IdentificationRun, leave_out=("times",)):
    """One way."""


class BenchIdentificationRecord(Record, of=Identifications):
    """The way from a recording in memory to the inertial parameters, in fresh processes; compiling is included, imports
    are not.

    ratios: ours against Pinocchio's loop with lstsq, per number of threads
    """

    ratios: Sequence[IdentificationRatioRecord]
    entries: Sequence[IdentificationRunRecord]


class BenchRecord(CommandRecord, of=Benchmark, format="graphdyn bench 4", leave_out=("model", "effort", "floors")):
    """How fast graphdyn is beside other libraries, measured in turns in one run.

    Times in seconds: of one thread processor time, of several wall time.
    """

    n_bodies = attribute("model.n_bodies")
    repeats = attribute("effort.repeats")
    agrees = attribute()
    copy_slowdown = attribute()
    backend: Literal["llvm", "numpy"]
    works: Sequence[WorkRecord]
    identification: BenchIdentificationRecord
    imports: Mapping[str, TimesRecord]
    first_calls: Mapping[str, TimesRecord]
    curves: Sequence[CurveRecord]


def record(found: Benchmark, command: Sequence[str]) -> dict[str, Any]:
    """A benchmark but for the model."""
    ratios = [{"threads": threads, "trusted": r.steady, **_ratio(r)} for threads, r in found.identification.comparisons]
    return written(
        BenchRecord,
        found,
        command=command,
        works=[_work(measured, found.floors.get(measured.name)) for measured in found.works],
        identification=written(BenchIdentificationRecord, found.identification, ratios=ratios),
        curves=[written(CurveRecord, curve, lines=[_line(line) for line in curve.lines]) for curve in found.curves],
    )


def _work(measured: MeasuredWork, floor: Floor | None) -> dict[str, Any]:
    above = measured.above_limit
    known = None if floor is None or above is None else written(FloorRecord, floor, **_ratio(above))
    return written(WorkRecord, measured, floor=known)


def _ratio(ratio: Ratio) -> dict[str, Any]:
    return {"ratio": ratio.median, "fastest_ratio": ratio.fastest, "quartiles": ratio.quartiles}


def _line(line: Line) -> dict[str, Any]:
    points = [written(PointRecord, times, x=x) for x, times in zip(line.x, line.times, strict=True)]
    return written(LineRecord, line, points=points)
