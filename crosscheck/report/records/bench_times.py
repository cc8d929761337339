"""What all times and ratios of `graphdyn bench 2` have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from crosscheck.report.records._fields import Keywords
from crosscheck.studies.bench.timing import Ratio, Times

Quartiles = Annotated[Sequence[float], Keywords(minItems=2, maxItems=2)]
Repeats = Annotated[Sequence[float], Keywords(minItems=1)]


def times_fields(times: Times) -> dict[str, Any]:
    return {"median": times.median, "fastest": times.fastest, "quartiles": times.spread, "seconds": times.seconds}


def ratio_fields(ratio: Ratio) -> dict[str, Any]:
    return {"ratio": ratio.median, "fastest_ratio": ratio.fastest, "quartiles": ratio.spread}
