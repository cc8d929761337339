"""The format `graphdyn bench 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.records._fields import FORMAT, Command, Keywords, Versions, taken
from crosscheck.report.records.bench_curves import CurveRecord, curve_record
from crosscheck.report.records.bench_identification import BenchIdentificationRecord, bench_identification_record
from crosscheck.report.records.bench_times import Quartiles, Repeats, times_fields
from crosscheck.report.records.bench_works import WorkRecord, work_record
from crosscheck.report.versions import versions
from crosscheck.studies.bench.benchmark import Benchmark
from crosscheck.studies.bench.floor import Machine
from crosscheck.studies.bench.load import Load


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
