"""A benchmark as plain data. The format is described in docs/json.md."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from crosscheck.studies.bench.benchmark import Benchmark
from crosscheck.studies.bench.contender import Measured
from crosscheck.studies.bench.curves import ScalingCurve
from crosscheck.studies.bench.floor import Floor
from crosscheck.studies.bench.identification import Identifications
from crosscheck.studies.bench.timing import Ratio, Times

BENCH_FORMAT = "graphdyn bench 1"


def as_json(found: Benchmark) -> dict[str, Any]:
    """Everything; times in seconds."""
    return {
        "robot": found.robot,
        "n_bodies": found.model.n_bodies,
        "samples": found.samples,
        "seed": found.seed,
        "quick": found.quick,
        "repeats": found.effort.repeats,
        "cores": found.cores,
        "threads": list(found.threads),
        "backend": found.backend,
        "agrees": found.agrees,
        "peers": dict(found.peers),
        "left_out": dict(found.left_out),
        "machine": [asdict(machine) for machine in found.machine],
        "works": [_work(measured, found.floors.get(measured.name)) for measured in found.works],
        "identification": _identification(found.identification),
        "imports": {name: _times(times) for name, times in found.imports.items()},
        "first_calls": {name: _times(times) for name, times in found.first_calls.items()},
        "curves": [_curve(curve) for curve in found.curves],
    }


def _work(measured: Measured, floor: Floor | None) -> dict[str, Any]:
    return {
        "name": measured.name,
        "title": measured.title,
        "scale": measured.error,
        "bound": measured.bound,
        "agrees": measured.agrees,
        "floor": None if floor is None else asdict(floor),
        "ratios": [
            {"ours": c.ours, "theirs": c.theirs, "threads": c.threads, **_ratio(c.ratio)} for c in measured.comparisons
        ],
        "entries": [
            {
                "name": entry.name,
                "threads": entry.threads,
                "ours": entry.ours,
                "samples": entry.samples,
                **_times(entry.times),
                "error": entry.error,
                "judged": entry.judged,
                "included": entry.included,
            }
            for entry in measured.entries
        ],
    }


def _identification(found: Identifications) -> dict[str, Any]:
    return {
        "samples": found.samples,
        "ratios": [{"threads": threads, **_ratio(ratio)} for threads, ratio in found.comparisons],
        "entries": [
            {
                "name": entry.name,
                "threads": entry.threads,
                "samples": entry.samples,
                **_times(entry.times),
                "extra_bytes": entry.extra_bytes,
                "error": entry.error,
            }
            for entry in found.entries
        ],
    }


def _curve(curve: ScalingCurve) -> dict[str, Any]:
    return {
        "name": curve.name,
        "title": curve.title,
        "x": curve.x,
        "seconds_of": curve.seconds,
        "notes": list(curve.notes),
        "lines": [
            {
                "name": line.name,
                "threads": line.threads,
                "exponent": line.exponent,
                "points": [{"x": x, **_times(times)} for x, times in zip(line.x, line.times, strict=True)],
            }
            for line in curve.lines
        ],
    }


def _times(times: Times) -> dict[str, Any]:
    return {
        "median": times.median,
        "fastest": times.fastest,
        "quartiles": list(times.spread),
        "seconds": list(times.seconds),
    }


def _ratio(ratio: Ratio) -> dict[str, Any]:
    return {"ratio": ratio.median, "fastest_ratio": ratio.fastest, "quartiles": list(ratio.spread)}
