"""What all times and ratios of `graphdyn bench 2` have in common.

What `graphdyn bench 2` says of a work: who took part, how long each took, and what the machine needs at least.

What `graphdyn bench 2` says of a diagram: times against the size of a batch, the number of bodies or threads.

What `graphdyn bench 2` says of the identification.

The format `graphdyn bench 2`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from crosscheck.bench.benchmark import Benchmark
from crosscheck.bench.contender import MeasuredWork
from crosscheck.bench.curves import ScalingCurve
from crosscheck.bench.identification import Identifications
from crosscheck.bench.machine.floor import Floor, Machine
from crosscheck.bench.machine.load import Load
from crosscheck.bench.machine.timing import Ratio, Times
from crosscheck.report.record_fields import FORMAT, Command, Keywords, Number, Versions, taken
from crosscheck.report.versions import versions

Quartiles = Annotated[Sequence[float], Keywords(minItems=2, maxItems=2)]
Repeats = Annotated[Sequence[float], Keywords(minItems=1)]


def times_fields(times: Times) -> dict[str, Any]:
    return {"median": times.median, "fastest": times.fastest, "quartiles": times.spread, "seconds": times.seconds}


def ratio_fields(ratio: Ratio) -> dict[str, Any]:
    return {"ratio": ratio.median, "fastest_ratio": ratio.fastest, "quartiles": ratio.spread}


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


def work_record(measured: MeasuredWork, floor: Floor | None) -> WorkRecord:
    above = measured.above_limit
    return taken(
        WorkRecord,
        measured,
        scale=measured.error,
        floor=None if floor is None or above is None else taken(FloorRecord, floor, **ratio_fields(above)),
        ratios=[taken(BenchRatioRecord, compared, **ratio_fields(compared.ratio)) for compared in measured.comparisons],
        entries=[taken(ContenderRecord, entry, **times_fields(entry.times)) for entry in measured.entries],
    )


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


@dataclass(frozen=True, kw_only=True)
class TimesRecord:
    """Times of one import, or one first call."""

    median: float
    """Median of the repeats [s]."""

    fastest: float
    """Fastest repeat [s]."""

    quartiles: Quartiles
    """Lower and upper quartile of the repeats [s]."""

    seconds: Repeats
    """Every repeat in its order [s]."""


@dataclass(frozen=True, kw_only=True)
class BenchRecord:
    """How fast graphdyn is beside other libraries, measured in turns in one run. Times in seconds."""

    format: Annotated[Literal["graphdyn bench 2"], FORMAT] = "graphdyn bench 2"

    versions: Versions = field(default_factory=versions)

    command: Command

    robot: str
    """Name or file as given."""

    n_bodies: int
    """Moving bodies, and joints."""

    samples: int
    """Random states per run; the identification and the largest batch take ten times as many."""

    seed: int
    """Of the random states."""

    quick: bool
    """Fewer repeats and points were asked for."""

    repeats: int
    """Of every measurement, in turns."""

    cores: int
    """Processor cores that the program may use."""

    load: Annotated[Sequence[Load], Keywords(minItems=2, maxItems=2)]
    """Of the machine, before and after."""

    threads: Sequence[int]
    """Numbers of threads that were compared."""

    backend: Literal["llvm", "numpy"]
    """What runs graphdyn's recursive forms: compiled code or NumPy arrays."""

    agrees: bool
    """Every answer of graphdyn's own forms is within the bound of its work."""

    peers: Mapping[str, str]
    """What took part: version, instruction set of the build as far as it is known, and how it was used, by library."""

    left_out: Mapping[str, str]
    """Why a library took no part, by name."""

    machine: Sequence[Machine]
    """What this machine could do at best, by number of threads; empty where nothing can be compiled."""

    works: Sequence[WorkRecord]
    """What was done, in several ways."""

    identification: BenchIdentificationRecord
    """From a recording in memory to the inertial parameters, in fresh processes; compiling is included, imports are
    not.
    """

    imports: Mapping[str, TimesRecord]
    """Seconds of an import in a fresh process, by module."""

    first_calls: Mapping[str, TimesRecord]
    """Seconds of the first call of a verb in a fresh process, which records and compiles, by verb; the first one loads
    the compiler too.
    """

    curves: Sequence[CurveRecord]
    """Times against the size of a batch, the number of bodies or of threads."""


def record(found: Benchmark, command: Sequence[str]) -> BenchRecord:
    """A benchmark but for the model."""
    return taken(
        BenchRecord,
        found,
        command=command,
        n_bodies=found.model.n_bodies,
        repeats=found.effort.repeats,
        works=[work_record(measured, found.floors.get(measured.name)) for measured in found.works],
        identification=bench_identification_record(found.identification),
        imports={name: TimesRecord(**times_fields(times)) for name, times in found.imports.items()},
        first_calls={name: TimesRecord(**times_fields(times)) for name, times in found.first_calls.items()},
        curves=[curve_record(curve) for curve in found.curves],
    )
