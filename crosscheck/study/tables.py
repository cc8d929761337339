"""The tables of a study as Parquet files: sorted, and the same bytes however the tasks came about."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.parquet as parquet

from crosscheck.study.database import Key
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.simulated.runs import known_model
from crosscheck.study.tasks import StudyOutcome
from graphdyn.identification import structure
from urdf.document import write_whole

RESULTS, SCENARIOS, TIMES = "results.parquet", "scenarios.parquet", "times.parquet"

_TYPES = {str: pa.string(), int: pa.int64(), float: pa.float64(), float | None: pa.float64()}

RESULTS_SCHEMA = pa.schema(
    [
        ("scenario", pa.string()),
        ("run", pa.int64()),
        ("method", pa.string()),
        ("measures", pa.string()),
        ("status", pa.string()),
        ("reason", pa.string()),
        ("rank", pa.int64()),
        ("iterations", pa.int64()),
        ("simulations", pa.int64()),
        ("base", pa.list_(pa.float64())),
        ("sigma", pa.list_(pa.float64())),
        ("parameter_error", pa.float64()),
        ("torque_error", pa.float64()),
        ("trajectory_error", pa.float64()),
        ("consistent", pa.bool_()),
    ]
)

SCENARIOS_SCHEMA = pa.schema(
    [
        ("scenario", pa.string()),
        *((name, _TYPES[kind]) for name, kind in get_type_hints(Scenario).items()),
        ("base_names", pa.list_(pa.string())),
        ("base_units", pa.list_(pa.string())),
        ("truth", pa.list_(pa.float64())),
    ]
)

TIMES_SCHEMA = pa.schema(
    [
        ("scenario", pa.string()),
        ("run", pa.int64()),
        ("method", pa.string()),
        ("processor_seconds", pa.float64()),
    ]
)


def write_tables(study: Configuration, outcomes: Iterable[tuple[Key, StudyOutcome]], folder: Path) -> None:
    """outcomes: sorted by scenario and run. Raises OSError."""
    rows, times = list[dict[str, Any]](), list[dict[str, Any]]()
    for (scenario, run), outcome in outcomes:
        for result, seconds in sorted(zip(outcome.results, outcome.seconds, strict=True), key=lambda x: x[0].method):
            key = {"scenario": scenario, "run": run, "method": result.method}
            values = {field.name: getattr(result, field.name) for field in fields(result)}
            rows.append({**values, **key, "status": "found" if result.reason is None else "failed"})
            times.append({**key, "processor_seconds": seconds})
    known = sorted((_scenario_row(study, scenario) for scenario in study.scenarios), key=lambda row: row["scenario"])
    for name, table, schema in (
        (RESULTS, rows, RESULTS_SCHEMA),
        (SCENARIOS, known, SCENARIOS_SCHEMA),
        (TIMES, times, TIMES_SCHEMA),
    ):
        sink = pa.BufferOutputStream()
        parquet.write_table(pa.Table.from_pylist(table, schema), sink)
        write_whole(folder / name, sink.getvalue().to_pybytes())


def _scenario_row(study: Configuration, scenario: Scenario) -> dict[str, Any]:
    torque_model = known_model(study, scenario)
    base, columns = structure(torque_model).base, torque_model.columns
    values = {field.name: getattr(scenario, field.name) for field in fields(scenario)}
    return {
        "scenario": scenario.name,
        **values,
        "base_names": list(base.names([column.symbol for column in columns])),
        "base_units": [columns[k].unit for k in base.independent],
        "truth": base.values(plant_of(study.robot).truth(torque_model)).tolist(),
    }
