"""What a study has done so far, and its tables as Parquet files: sorted, the same bytes however the tasks came about.

What is done is in one SQLite file, written by one process, whole after every task whatever ends it.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.parquet as parquet

from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.simulated.runs import known_model
from crosscheck.study.tasks import StudyOutcome
from graphdyn import InvalidInput
from graphdyn.identification import structure
from urdf.document import write_whole

Key = tuple[str, int]
"""Name of a scenario, and number of a run."""

LOCK_TIMEOUT = 1.0
"""Time to wait for another process to leave the file [s]."""

TABLE_DEFINITIONS = """
CREATE TABLE IF NOT EXISTS inputs (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS tasks (
    scenario TEXT NOT NULL, run INTEGER NOT NULL, outcome TEXT NOT NULL, PRIMARY KEY (scenario, run)
);
"""


class Database:
    """The outcome of every task that is done; each is written for good before the next."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._connection = connection

    def inputs(self) -> dict[str, str]:
        """What the study was begun with; empty where it has just begun."""
        return dict(self._connection.execute("SELECT name, value FROM inputs"))

    def begin(self, inputs: Mapping[str, str]) -> None:
        with self._connection:
            self._connection.executemany("INSERT INTO inputs VALUES (?, ?)", inputs.items())

    def write(self, key: Key, outcome: StudyOutcome) -> None:
        with self._connection:
            self._connection.execute("INSERT INTO tasks VALUES (?, ?, ?)", (*key, json.dumps(outcome.as_json())))

    def done(self) -> set[Key]:
        return set(self._connection.execute("SELECT scenario, run FROM tasks"))

    def outcomes(self) -> Iterator[tuple[Key, StudyOutcome]]:
        """Sorted by scenario and run."""
        for scenario, run, outcome in self._connection.execute("SELECT * FROM tasks ORDER BY scenario, run"):
            yield (scenario, run), StudyOutcome.from_json(json.loads(outcome))


@contextmanager
def opened(file: Path) -> Iterator[Database]:
    """No other process can open it in the meantime.

    Raises InvalidInput where one has, and for other files; OSError where it cannot be written, as on a full disk.
    """
    with closing(sqlite3.connect(file, timeout=LOCK_TIMEOUT)) as connection:
        try:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            connection.execute("PRAGMA journal_mode = WAL")
            connection.executescript(f"BEGIN IMMEDIATE; {TABLE_DEFINITIONS} COMMIT;")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error):
                raise InvalidInput(f"{file} cannot be opened: {error}") from None
            raise InvalidInput(f"{file} is in use: a study writes there; wait for it, or name another folder") from None
        except sqlite3.DatabaseError as error:
            raise InvalidInput(f"{file} is damaged: {error}; remove it, or name another folder") from None
        try:
            yield Database(connection)
        except sqlite3.OperationalError as error:
            raise OSError(f"{file} cannot be written: {error}; make room, and go on with --resume") from None


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
