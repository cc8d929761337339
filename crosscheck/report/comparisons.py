"""Comparisons as tables for people and as JSON for machines."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from crosscheck.referee.comparison import Comparison, QuantityResult
from crosscheck.referee.pinocchio_model import VERSION as PINOCCHIO_VERSION
from urdf._files import write_whole

JSON_FORMAT = "graphdyn crosscheck 1"

LIBRARIES = ("graphdyn", "numpy", "scipy", "yourdfpy", "example-robot-data")

TEXT_WIDTH = 140
"""Characters of a line in the messages of assert_agrees."""


def versions() -> dict[str, str]:
    """Versions of everything that takes part in a comparison."""
    return {**{name: version(name) for name in LIBRARIES}, "pinocchio": PINOCCHIO_VERSION}


def as_json(comparison: Comparison) -> dict[str, Any]:
    """Everything as plain data; numbers that are not finite become null. The format is described in docs/json.md."""
    as_they_are = (
        "robot", "file", "file_sha256", "n_bodies", "samples", "seed", "locked", "chain", "routes", "not_compared",
        "notes",
    )  # fmt: skip
    identification = comparison.identification
    record = {
        **{name: getattr(comparison, name) for name in as_they_are},
        "agrees": comparison.agrees,
        "quantities": {name: _quantity_record(result) for name, result in comparison.quantities.items()},
        "conditioning": asdict(comparison.conditioning),
        "identification": asdict(identification) if identification else None,
    }
    return finite(record)


def _quantity_record(result: QuantityResult) -> dict[str, Any]:
    return {
        "agrees": result.agrees,
        "max_relative_error": result.max_relative_error,
        "quantiles": result.quantiles,
        "bound": result.quantity.tolerance.bound,
        "bound_reason": result.quantity.tolerance.why,
        "scale": result.quantity.scale,
        "against": result.quantity.against,
        "by_case": dict(result.by_case),
        "by_route": dict(result.by_route),
        "worst": asdict(result.worst) if result.worst else None,
    }


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write the record as a whole file or not at all. Raises OSError."""
    write_whole(path, (json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode())


def finite(value: Any) -> Any:
    """The same data with null for numbers that are not finite: JSON has no others."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
