"""A study from its configuration to its tables, in a folder from which it can go on after any interruption.

What is done so far is in one SQLite file, written by one process, whole after every task whatever ends it. The tables
are Parquet files: sorted, the same bytes however the tasks came about.
"""

from __future__ import annotations

import json
import time
import tomllib
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, fields, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.parquet as parquet

from crosscheck.distributing import MISSING, DaskWorkers, Lost, NoWorkers, Workers
from crosscheck.identifying import ESTIMATORS
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.simulated.runs import known_model
from crosscheck.study.store import Key, Store, opened
from crosscheck.study.tasks import (
    LIBRARIES,
    Result,
    StudyOutcome,
    StudyTask,
    Surroundings,
    Unfit,
    computed,
    failed,
    taking_part,
)
from crosscheck.toml_text import toml_document
from graphdyn import InvalidInput
from graphdyn.errors import install_line
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


def write_tables(study: Configuration, outcomes: Iterable[tuple[Key, StudyOutcome]], folder: Path) -> None:
    """outcomes: sorted by scenario and run. Raises OSError."""
    rows, times = list[dict[str, Any]](), list[dict[str, Any]]()
    for (scenario, run), outcome in outcomes:
        for result, seconds in sorted(zip(outcome.results, outcome.seconds, strict=True), key=_place):
            key = {"scenario": scenario, "run": run, "method": result.method}
            values = {field.name: getattr(result, field.name) for field in fields(result)}
            rows.append({**values, **key, "status": "found" if result.reason is None else "failed"})
            record = {"redrawn": result.redrawn, "repeat": result.repeat}
            times.append({**key, **record, "processor_seconds": seconds})
    known = sorted((_scenario_row(study, scenario) for scenario in study.scenarios), key=lambda row: row["scenario"])
    for name, table, schema in (
        (RESULTS, rows, RESULTS_SCHEMA),
        (SCENARIOS, known, SCENARIOS_SCHEMA),
        (TIMES, times, TIMES_SCHEMA),
    ):
        sink = pa.BufferOutputStream()
        parquet.write_table(pa.Table.from_pylist(table, schema), sink)
        write_whole(folder / name, sink.getvalue().to_pybytes())


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
        "truth": base.values(plant_of(study.robot).truth(torque_model)).tolist(),
    }


CONFIGURATION, DATABASE = "study.toml", "study.sqlite"

PROCESS_DIED = "the process that worked on this method died, each time it was tried"


@dataclass
class Progress:
    """How far a study is. remaining: wall time that is left [s], None as long as nothing is known of it."""

    done: int
    total: int
    remaining: float | None = None


def run_study(
    study: Configuration,
    folder: Path,
    workers: Workers,
    *,
    resume: bool = False,
    versions: Mapping[str, str] | None = None,
    progress: Callable[[Progress], None] | None = None,
    tell: Callable[[str], None] | None = None,
    before: Callable[[], None] | None = None,
) -> None:
    """Compute every task that is not done, and write the tables.

    folder: new or empty; with `resume` that of the same study, or new
    versions: of the libraries, which must be those the study was begun with
    progress: called after every task; tell: with a line about every process that died
    before: called before the first task, when nothing else is wrong

    After any interruption, what was done is in the folder.

    Raises BadConfiguration for settings that do not fit the robot; InvalidInput for a folder that is something else, or
    of a study with another configuration; NoWorkers for processes that lack what it needs; OSError; urdf's errors.
    """
    plant_of(study.robot)  # which refuses what does not fit the robot
    refuse_missing_packages(study)
    if isinstance(workers, DaskWorkers):
        workers = replace(workers, libraries=LIBRARIES)
    before = before or (lambda: None)
    new = is_new(folder, resume)
    if new:
        before()
        begin(study, folder)
    inputs = {"configuration": study.text, **study.own_files, **(versions or {})}
    with opened(folder / DATABASE, tell) as store:
        _same(study, folder, store, inputs)
        if not new:
            before()
        _compute(study, store, workers, progress or (lambda _: None), tell or (lambda _: None))
        write_tables(study, store.outcomes(), folder)


def refuse_missing_packages(study: Configuration) -> None:
    """Raise InvalidInput for a method without a package that it always needs."""
    for method in study.methods:
        needed = getattr(ESTIMATORS[method](), "packages", ()) if method in ESTIMATORS else ()
        missing = [package for package in needed if find_spec(package) is None]
        if missing:
            raise InvalidInput(
                f"{study.file}: {method} in methods needs {', '.join(missing)}, which is not installed; leave it out, "
                f"or run: {install_line('identify')}"
            )


def is_new(folder: Path, resume: bool) -> bool:
    """Whether the folder is new or empty. Raises InvalidInput where no study can begin or go on in it."""
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set[str]()
    if folder.exists() and not folder.is_dir():
        raise InvalidInput(f"{folder} is no folder; name a new one")
    if there and CONFIGURATION not in there:
        raise InvalidInput(f"{folder} holds other files, such as {min(there)}; name a new folder")
    if there and not resume:
        raise InvalidInput(f"{folder} holds a study already; go on with it by --resume, or name a new folder")
    return not there


def begin(study: Configuration, folder: Path) -> None:
    """The folder, with the configuration in it."""
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / CONFIGURATION, study.text.encode())


def _same(study: Configuration, folder: Path, store: Store, inputs: Mapping[str, str]) -> None:
    """Raises InvalidInput where the study was begun with other inputs."""
    begun = store.inputs()
    before = begun or {**inputs, "configuration": _copy(folder) or study.text}
    changes = _changes(tomllib.loads(before["configuration"]), tomllib.loads(study.text), "")
    names = sorted({*before, *inputs} - {"configuration"})
    for name in names:
        if before.get(name) == MISSING and name in LIBRARIES:
            continue  # no result has needed it
        if before.get(name) != inputs.get(name):
            what = "has changed" if Path(name).is_absolute() else f"was {before.get(name)}, is {inputs.get(name)}"
            changes.append(f"{name} {what}")
    if changes:
        raise InvalidInput(
            f"{folder} holds a study with another configuration than {study.file}: {'; '.join(changes)}; give the one "
            f"that it was begun with (a copy is in {folder / CONFIGURATION}), or name a new folder"
        )
    if not begun:
        begin(study, folder)
        store.begin(inputs)


def _copy(folder: Path) -> str | None:
    """The configuration in a folder whose store has lost it; None where it cannot be read either."""
    content = (folder / CONFIGURATION).read_bytes()
    try:
        toml_document(content)
    except ValueError:
        return None
    return content.decode()


def _changes(before: Any, now: Any, where: str) -> list[str]:
    """What differs between two documents."""
    if isinstance(before, dict) and isinstance(now, dict):
        keys = [*before, *(key for key in now if key not in before)]
        inside = [(f"{where}.{key}" if where else key, before.get(key), now.get(key)) for key in keys]
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        inside = [(f"{where} {k}", *pair) for k, pair in enumerate(zip(before, now, strict=True), start=1)]
    else:
        said = ["missing" if value is None else json.dumps(value) for value in (before, now)]
        return [] if before == now else [f"{where} was {said[0]}, is {said[1]}"]
    return [change for name, old, new in inside for change in _changes(old, new, name)]


def tasks_of(study: Configuration) -> list[StudyTask]:
    """All, one run of every scenario after the other, so that what is left is known early."""
    methods = [(scenario, taking_part(study.methods, scenario)) for scenario in study.scenarios]
    return [StudyTask(scenario, run, part) for run in range(study.runs) for scenario, part in methods if part]


def _compute(
    study: Configuration,
    store: Store,
    workers: Workers,
    progress: Callable[[Progress], None],
    tell: Callable[[str], None],
) -> None:
    done, everything = store.done(), tasks_of(study)
    tasks = [task for task in everything if (task.scenario.name, task.run) not in done]
    left = Remaining(tasks)
    progress(Progress(len(done), len(everything)))
    lost = list[StudyTask]()
    work = partial(computed, study, Surroundings.here(study))
    with closing(workers.each(work, tasks)) as answers:
        for k, answer in answers:
            task = tasks[k]
            outcome = usable(task, answer)
            if isinstance(outcome, Lost):
                tell(f"{_name(task)}: {outcome.reason}; its methods are tried one by one")
                lost.append(task)
                continue
            store.write((task.scenario.name, task.run), outcome)
            left.count(task, outcome.total)
            progress(Progress(len(everything) - left.tasks, len(everything), left.seconds()))
    for task in lost:
        store.write((task.scenario.name, task.run), _one_by_one(work, task, workers, tell))
        left.count(task, None)
        progress(Progress(len(everything) - left.tasks, len(everything), left.seconds()))


def usable(task: StudyTask, answer: StudyOutcome | Unfit | Lost) -> StudyOutcome | Lost:
    """The answer. Raises NoWorkers for that of a process that cannot do the task, which says nothing of the methods."""
    if isinstance(answer, Unfit) or (isinstance(answer, Lost) and not answer.died):
        raise NoWorkers(f"{_name(task)}: {answer.reason}; nothing of it is kept: mend this, and go on with --resume")
    return answer


def _one_by_one(
    work: Callable[[StudyTask], StudyOutcome | Unfit], task: StudyTask, workers: Workers, tell: Callable[[str], None]
) -> StudyOutcome:
    """A task during which a process died, each method by itself, so that only the one that is to blame fails."""
    alone = [StudyTask(task.scenario, task.run, (method,)) for method in task.methods]
    found: dict[int, StudyOutcome] = {}
    with closing(workers.each(work, alone)) as answers:
        for k, answer in answers:
            outcome = usable(alone[k], answer)
            if isinstance(outcome, Lost):
                tell(f"{_name(task)}, {task.methods[k]}: {outcome.reason}")
                outcome = failed(alone[k], PROCESS_DIED)
            found[k] = outcome
    parts = [found[k] for k in range(len(alone))]
    return StudyOutcome(
        tuple(result for part in parts for result in part.results),
        tuple(seconds for part in parts for seconds in part.seconds),
        sum(part.total for part in parts),
    )


def _name(task: StudyTask) -> str:
    return f"scenario {task.scenario.name}, run {task.run}"


class Remaining:
    """Wall time that is left, from what tasks have taken so far.

    A task takes as long as the finished ones of its scenario, or, before there is one, as all finished ones; as many
    run at once as so far.
    """

    def __init__(self, tasks: Sequence[StudyTask], clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._begin = clock, clock()
        self._left: dict[str, int] = defaultdict(int)
        self._taken: dict[str, list[float]] = defaultdict(list)
        for task in tasks:
            self._left[task.scenario.name] += 1

    @property
    def tasks(self) -> int:
        """Number of those that are left."""
        return sum(self._left.values())

    def count(self, task: StudyTask, seconds: float | None) -> None:
        """One is done. seconds: processor time, None where it is not known."""
        self._left[task.scenario.name] -= 1
        if seconds is not None:
            self._taken[task.scenario.name].append(seconds)

    def seconds(self) -> float | None:
        """[s]"""
        everything = [seconds for taken in self._taken.values() for seconds in taken]
        total = sum(everything)
        if not total:
            return None
        work = 0.0
        for name, count in self._left.items():
            taken = self._taken.get(name, everything)
            work += count * sum(taken) / len(taken)
        return work * (self._clock() - self._begin) / total
