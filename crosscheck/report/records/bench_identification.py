"""What `graphdyn bench 2` says of the identification."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from crosscheck.report.records._fields import taken
from crosscheck.report.records.bench_times import Quartiles, Repeats, ratio_fields, times_fields
from crosscheck.studies.bench.identification import Identifications


@dataclass(frozen=True, kw_only=True)
class IdentificationRatioRecord:
    """One comparison."""

    threads: int
    """Threads that may be used."""

    ratio: float
    """How many times as long theirs takes: median of the quotients of repeats that followed each other."""

    fastest_ratio: float
    """Quotient of the fastest repeats."""

    quartiles: Quartiles
    """Quartiles of the quotients of repeats that followed each other."""

    trusted: bool
    """The quartiles are close together."""


@dataclass(frozen=True, kw_only=True)
class WayRecord:
    """One way."""

    name: str
    """Which way."""

    threads: int
    """Cores it is held to."""

    samples: int
    """That were worked on; where fewer than the recording has, the time of the whole is extrapolated in proportion."""

    median: float
    """Median of the repeats, per sample [s]."""

    fastest: float
    """Fastest repeat, per sample [s]."""

    quartiles: Quartiles
    """Lower and upper quartile of the repeats, per sample [s]."""

    seconds: Repeats
    """Every repeat in its order, per sample [s]."""

    extra_bytes: int | None
    """Peak of the memory beside the recording [bytes]; null where the system does not tell."""

    error: float
    """Largest error of torques predicted at other states, relative to the largest torque."""


@dataclass(frozen=True, kw_only=True)
class BenchIdentificationRecord:
    """From a recording in memory to the inertial parameters, in fresh processes; compiling is included, imports are
    not.
    """

    samples: int
    """Length of the recording."""

    ratios: Sequence[IdentificationRatioRecord]
    """Ours against Pinocchio's loop with lstsq, per number of threads."""

    entries: Sequence[WayRecord]
    """Both ways, per number of threads."""


def bench_identification_record(found: Identifications) -> BenchIdentificationRecord:
    return BenchIdentificationRecord(
        samples=found.samples,
        ratios=[
            IdentificationRatioRecord(threads=threads, trusted=ratio.steady, **ratio_fields(ratio))
            for threads, ratio in found.comparisons
        ],
        entries=[taken(WayRecord, entry, **times_fields(entry.times)) for entry in found.entries],
    )
