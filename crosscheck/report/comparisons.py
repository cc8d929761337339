"""Comparisons as tables for people and as JSON for machines."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from crosscheck.referee.comparison import Comparison, QuantityResult
from crosscheck.referee.pinocchio_model import VERSION as PINOCCHIO_VERSION
from crosscheck.referee.quantities import BY_NAME
from urdf._files import write_whole

JSON_FORMAT = "graphdyn crosscheck 1"

LIBRARIES = ("graphdyn", "numpy", "scipy", "yourdfpy", "example-robot-data")

TEXT_WIDTH = 140
"""Characters of a line in the messages of assert_agrees."""

ROOMY = 120
"""Characters of a line from which the table of one robot has columns that explain."""

_NAME_WIDTH = max(map(len, BY_NAME)) + len("│ ") + len(" │ 1.0e-13 │")
_ROBOT_WIDTH = len(" DISAGREES │")


def versions() -> dict[str, str]:
    """Versions of everything that takes part in a comparison."""
    return {**{name: version(name) for name in LIBRARIES}, "pinocchio": PINOCCHIO_VERSION}


def detail(comparison: Comparison, width: int) -> Table:
    """One robot, one row per quantity; the explaining columns only where the width [characters] has room for them."""
    table = Table(title=heading(comparison), title_justify="left", caption_justify="left")
    table.caption = "\n".join(footnotes(comparison))
    roomy = width >= ROOMY
    for column, justify in (("quantity", "left"), ("error", "right"), ("bound", "right"), ("", "left")):
        table.add_column(column, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    if roomy:
        table.add_column("against", overflow="fold")
        table.add_column("worst at", overflow="fold")
    for name, result in comparison.quantities.items():
        explained = (
            result.quantity.against,
            f"{result.worst.case} ({result.worst.route})" if result.worst else "",
        )
        table.add_row(
            name,
            f"{result.max_relative_error:.1e}",
            f"{result.quantity.tolerance.bound:.1e}",
            _verdict(result.agrees),
            *(explained if roomy else ()),
        )
    return table


def overview(comparisons: Sequence[Comparison], width: int) -> list[Table]:
    """Several robots side by side, as many tables as the width [characters] needs."""
    per_table = max(1, (width - _NAME_WIDTH) // _ROBOT_WIDTH)
    groups = [comparisons[k : k + per_table] for k in range(0, len(comparisons), per_table)]
    return [_overview(group) for group in groups]


def _overview(comparisons: Sequence[Comparison]) -> Table:
    table = Table(caption_justify="left")
    table.add_column("largest relative error", no_wrap=True)
    table.add_column("bound", justify="right", no_wrap=True)
    for comparison in comparisons:
        table.add_column(Path(comparison.robot).name, justify="right", overflow="fold")
    for name, quantity in BY_NAME.items():
        results = [comparison.quantities.get(name) for comparison in comparisons]
        if any(results):
            table.add_row(name, f"{quantity.tolerance.bound:.1e}", *map(_cell, results))
    table.add_section()
    table.add_row("verdict", "", *(_verdict(comparison.agrees) for comparison in comparisons))
    return table


def _cell(result: QuantityResult | None) -> str:
    return "–" if result is None else f"{result.max_relative_error:.1e}{'' if result.agrees else ' ✗'}"


def heading(comparison: Comparison) -> str:
    """Name, size and verdict in one line."""
    chain = f" from {comparison.chain[0]} to {comparison.chain[1]}" if comparison.chain else ""
    locked = f", locked: {', '.join(comparison.locked)}" if comparison.locked else ""
    return (
        f"{comparison.robot}: {_verdict(comparison.agrees)} "
        f"({comparison.n_bodies} joints{chain}{locked}; {comparison.samples} random states and the awkward ones, "
        f"seed {comparison.seed}; routes: {', '.join(comparison.routes)})"
    )


def footnotes(comparison: Comparison) -> list[str]:
    """Conditioning, base parameters, what was left out and why."""
    c = comparison.conditioning
    lines = [
        f"rank φ_q {_span(c.constraint_rank)} of {5 * comparison.n_bodies}, cond {_span(c.constraint_condition)}; "
        f"rank KKT {_span(c.kkt_rank)} of {11 * comparison.n_bodies}, cond {_span(c.kkt_condition)}; "
        f"cond M {_span(c.mass_matrix_condition)}"
    ]
    if comparison.identification is not None:
        i = comparison.identification
        lines.append(
            f"base parameters: {i.rank} (Pinocchio's regressor: {i.rank_there}), cond {i.condition_number:.3g}"
        )
    for reason in dict.fromkeys(comparison.not_compared.values()):
        names = [name for name, why in comparison.not_compared.items() if why == reason]
        lines.append(f"not compared: {', '.join(names)}: {reason}")
    return [*lines, *comparison.notes]


def as_text(comparison: Comparison) -> str:
    """The detail table as plain text, for error messages and logs."""
    buffer = io.StringIO()
    Console(file=buffer, width=TEXT_WIDTH, markup=False).print(detail(comparison, TEXT_WIDTH))
    return buffer.getvalue()


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


def _verdict(agrees: bool) -> str:
    return "agrees" if agrees else "DISAGREES"


def _span(pair: tuple[float, float]) -> str:
    low, high = (f"{value:.3g}" for value in pair)
    return low if low == high else f"{low} … {high}"
