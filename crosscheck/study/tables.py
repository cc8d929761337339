"""The tables of a study as Parquet files: sorted, the same bytes however the tasks came about."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.parquet as parquet

from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.simulated.runs import known_model
from crosscheck.study.store import Key
from crosscheck.study.tasks import Result, StudyOutcome
from graphdyn.identification import structure
from urdf.document import write_whole

RESULTS, SCENARIOS, TIMES = "results.parquet", "scenarios.parquet", "times.parquet"

ARROW_TYPES = {
    str: pa.string(),
    str | None: pa.string(),
    int: pa.int64(),
    int | None: pa.int64(),
    float: pa.float64(),
    float | None: pa.float64(),
    bool | None: pa.bool_(),
    tuple[float, ...] | None: pa.list_(pa.float64()),
}


def _columns(kind: type, *left_out: str) -> list[tuple[str, pa.DataType]]:
    """A column for every field of a class."""
    return [(name, ARROW_TYPES[of]) for name, of in get_type_hints(kind).items() if name not in left_out]


_KEY_COLUMNS = [("scenario", pa.string()), ("run", pa.int64()), ("method", pa.string())]

RESULTS_SCHEMA = pa.schema(
    [*_KEY_COLUMNS, ("measures", pa.string()), ("status", pa.string()), *_columns(Result, "method", "measures")]
)

SCENARIOS_SCHEMA = pa.schema(
    [
        ("scenario", pa.string()),
        *_columns(Scenario),
        ("base_names", pa.list_(pa.string())),
        ("base_units", pa.list_(pa.string())),
        ("truth", pa.list_(pa.float64())),
    ]
)

TIMES_SCHEMA = pa.schema(
    [*_KEY_COLUMNS, ("redrawn", pa.string()), ("repeat", pa.int64()), ("processor_seconds", pa.float64())]
)


Rows = list[dict[str, Any]]


def write_scenarios(study: Configuration, folder: Path) -> None:
    """Write scenarios.parquet, which is known before any task. Raises OSError."""
    known = [_scenario_row(study, scenario) for scenario in study.scenarios]
    _write(folder / SCENARIOS, sorted(known, key=lambda row: str(row["scenario"])), SCENARIOS_SCHEMA)


def write_results(outcomes: Iterable[tuple[Key, StudyOutcome]], folder: Path) -> None:
    """Write results.parquet and times.parquet. outcomes: sorted by scenario and run. Raises OSError."""
    rows, times = result_rows(outcomes)
    _write(folder / RESULTS, rows, RESULTS_SCHEMA)
    _write(folder / TIMES, times, TIMES_SCHEMA)


def _write(file: Path, rows: Rows, schema: pa.Schema) -> None:
    sink = pa.BufferOutputStream()
    parquet.write_table(pa.Table.from_pylist(rows, schema), sink)
    write_whole(file, sink.getvalue().to_pybytes())


def result_rows(outcomes: Iterable[tuple[Key, StudyOutcome]]) -> tuple[Rows, Rows]:
    """The rows of results.parquet and of times.parquet."""
    rows, times = Rows(), Rows()
    for (scenario, run), outcome in outcomes:
        for result, seconds in sorted(zip(outcome.results, outcome.seconds, strict=True), key=_place):
            key = {"scenario": scenario, "run": run, "method": result.method}
            values = {field.name: getattr(result, field.name) for field in fields(result)}
            rows.append({**values, **key, "status": "found" if result.reason is None else "failed"})
            record = {"redrawn": result.redrawn, "repeat": result.repeat}
            times.append({**key, **record, "processor_seconds": seconds})
    return rows, times


def _place(row: tuple[Result, float | None]) -> tuple[str, str, int]:
    """Order of the rows of a run."""
    result, _ = row
    return result.method, result.redrawn or "", result.repeat


def _scenario_row(study: Configuration, scenario: Scenario) -> dict[str, Any]:
    torque_model = known_model(study, scenario)
    base, columns = structure(torque_model).base, torque_model.columns
    values = {field.name: getattr(scenario, field.name) for field in fields(scenario)}
    return {
        "scenario": scenario.name,
        **values,
        "base_names": list(base.names([column.symbol for column in columns])),
        "base_units": [columns[k].unit for k in base.independent],
        "truth": base.values(plant_of(study.robot_of(scenario)).truth(torque_model)).tolist(),
    }
