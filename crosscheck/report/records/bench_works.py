"""What `graphdyn bench 2` says of a work: who took part, how long each took, and what the machine needs at least."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from crosscheck.report.records._fields import Number, taken
from crosscheck.report.records.bench_times import Quartiles, Repeats, ratio_fields, times_fields
from crosscheck.studies.bench.contender import Measured
from crosscheck.studies.bench.floor import Floor


@dataclass(frozen=True, kw_only=True)
class BenchRatioRecord:
    """One comparison."""

    ours: str
    """Our form."""

    theirs: str
    """The other."""

    threads: int
    """Threads that may be used."""

    ratio: float
    """How many times as long theirs takes: median of the quotients of repeats that followed each other."""

    fastest_ratio: float
    """Quotient of the fastest repeats."""

    quartiles: Quartiles
    """Quartiles of the quotients of repeats that followed each other."""

    trusted: bool
    """The machine was quiet: the runs had a core, and the quartiles are close together."""


@dataclass(frozen=True, kw_only=True)
class ContenderRecord:
    """One contender."""

    name: str
    """Who."""

    threads: int
    """Threads that may be used."""

    ours: bool
    """A form of graphdyn whose ratios are asked for."""

    samples: int
    """Samples of each run."""

    median: float
    """Median of the repeats, per sample [s]."""

    fastest: float
    """Fastest repeat, per sample [s]."""

    quartiles: Quartiles
    """Lower and upper quartile of the repeats, per sample [s]."""

    seconds: Repeats
    """Every repeat in its order, per sample [s]."""

    error: Number
    """Largest relative error against Pinocchio; null where nothing was judged."""

    judged: int
    """Samples, or joints for sums of products, that were judged."""

    included: str
    """What the time includes beside the arithmetic."""


@dataclass(frozen=True, kw_only=True)
class FloorRecord:
    """What a sample takes at least, in loops that never wait and took turns with the rest, and what ours takes."""

    operations: int
    """Floating-point operations of a sample."""

    instructions: int
    """What they take: a product and the sum that is its only use are one."""

    products: int
    """Those that multiply or divide."""

    bytes: int
    """Bytes read and written per sample."""

    seconds: float
    """Of what takes longest: all instructions, those that multiply, or the bytes [s]."""

    ratio: float
    """How many times as long our first form takes: median of the quotients of repeats that followed each other."""

    fastest_ratio: float
    """Quotient of the fastest repeats."""

    quartiles: Quartiles
    """Quartiles of the quotients of repeats that followed each other."""


@dataclass(frozen=True, kw_only=True)
class WorkRecord:
    """One work."""

    name: Literal[
        "inverse_dynamics",
        "forward_dynamics",
        "everything",
        "regressor",
        "inverse_dynamics_derivatives",
        "forward_dynamics_derivatives",
        "mass_matrix_inverse",
        "coriolis_matrix",
        "kinetic_energy",
        "frame_jacobian",
        "simulation",
        "inverse_call_100",
        "inverse_call_1000",
        "inverse_call_1000_cold",
        "forward_call_100",
        "forward_call_1000",
        "forward_call_1000_cold",
        "inverse_call_whole",
        "forward_call_whole",
        "single_inverse",
        "single_forward",
    ]
    """Which work."""

    title: str
    """Its name in words."""

    scale: str
    """What errors are relative to."""

    bound: float
    """Largest relative error that counts as agreement."""

    agrees: bool
    """Our answers are within the bound."""

    core_share: float
    """Part of the time of runs on one thread for which they had a core: below 0.95, others disturbed them."""

    floor: FloorRecord | None
    """What a sample takes at least on one thread of this machine; null where that is not known."""

    ratios: Sequence[BenchRatioRecord]
    """Our forms against every other with the same number of threads."""

    entries: Sequence[ContenderRecord]
    """Everyone who took part."""


def work_record(measured: Measured, floor: Floor | None) -> WorkRecord:
    above = measured.above_limit
    return taken(
        WorkRecord,
        measured,
        scale=measured.error,
        floor=None if floor is None or above is None else taken(FloorRecord, floor, **ratio_fields(above)),
        ratios=[taken(BenchRatioRecord, compared, **ratio_fields(compared.ratio)) for compared in measured.comparisons],
        entries=[taken(ContenderRecord, entry, **times_fields(entry.times)) for entry in measured.entries],
    )
