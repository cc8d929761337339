"""A study from its configuration to its tables, in a folder from which it can go on after any interruption."""

from __future__ import annotations

import json
import time
import tomllib
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from crosscheck.distributing import Lost, Workers
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.tables import Database, opened, write_tables
from crosscheck.study.tasks import StudyOutcome, StudyTask, compute, failed, taking_part
from graphdyn import InvalidInput
from urdf.document import write_whole

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
) -> None:
    """Compute every task that is not done, and write the tables.

    folder: new or empty; with `resume` that of the same study, or new
    versions: of the libraries, which must be those the study was begun with
    progress: called after every task; tell: with a line about every process that died

    After any interruption, what was done is in the folder.

    Raises BadConfiguration for settings that do not fit the robot; InvalidInput for a folder that is something else, or
    of a study with another configuration; OSError; urdf's errors; what the workers raise.
    """
    plant_of(study.robot)  # which refuses what does not fit the robot
    begin(study, folder, resume)
    inputs = {"configuration": study.text, **study.own_files, **(versions or {})}
    with opened(folder / DATABASE) as database:
        _same(study, folder, database, inputs)
        _compute(study, database, workers, progress or (lambda _: None), tell or (lambda _: None))
        write_tables(study, database.outcomes(), folder)


def begin(study: Configuration, folder: Path, resume: bool) -> None:
    """The folder, with the configuration in it."""
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set[str]()
    if folder.exists() and not folder.is_dir():
        raise InvalidInput(f"{folder} is no folder; name a new one")
    if there and CONFIGURATION not in there:
        raise InvalidInput(f"{folder} holds other files, such as {min(there)}; name a new folder")
    if there and not resume:
        raise InvalidInput(f"{folder} holds a study already; go on with it by --resume, or name a new folder")
    if not there:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / CONFIGURATION, study.text.encode())


def _same(study: Configuration, folder: Path, database: Database, inputs: Mapping[str, str]) -> None:
    """Raises InvalidInput where the study was begun with other inputs."""
    before = database.inputs()
    if not before:
        database.begin(inputs)
        return
    changes = _changes(tomllib.loads(before["configuration"]), tomllib.loads(study.text), "")
    names = sorted({*before, *inputs} - {"configuration"})
    for name in names:
        if before.get(name) != inputs.get(name):
            what = "has changed" if Path(name).is_absolute() else f"was {before.get(name)}, is {inputs.get(name)}"
            changes.append(f"{name} {what}")
    if changes:
        raise InvalidInput(
            f"{folder} holds a study with another configuration than {study.file}: {'; '.join(changes)}; give the one "
            f"that it was begun with (a copy is in {folder / CONFIGURATION}), or name a new folder"
        )


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
    database: Database,
    workers: Workers,
    progress: Callable[[Progress], None],
    tell: Callable[[str], None],
) -> None:
    done, everything = database.done(), tasks_of(study)
    tasks = [task for task in everything if (task.scenario.name, task.run) not in done]
    left = Remaining(tasks)
    progress(Progress(len(done), len(everything)))
    lost = list[StudyTask]()
    with closing(workers.each(partial(compute, study), tasks)) as answers:
        for k, outcome in answers:
            task = tasks[k]
            if isinstance(outcome, Lost):
                tell(f"{_name(task)}: {outcome.reason}; its methods are tried one by one")
                lost.append(task)
                continue
            database.write((task.scenario.name, task.run), outcome)
            left.count(task, outcome.total)
            progress(Progress(len(everything) - left.tasks, len(everything), left.seconds()))
    for task in lost:
        database.write((task.scenario.name, task.run), _one_by_one(study, task, workers, tell))
        left.count(task, None)
        progress(Progress(len(everything) - left.tasks, len(everything), left.seconds()))


def _one_by_one(study: Configuration, task: StudyTask, workers: Workers, tell: Callable[[str], None]) -> StudyOutcome:
    """A task during which a process died, each method by itself, so that only the one that is to blame fails."""
    alone = [StudyTask(task.scenario, task.run, (method,)) for method in task.methods]
    found: dict[int, StudyOutcome] = {}
    with closing(workers.each(partial(compute, study), alone)) as answers:
        for k, outcome in answers:
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
