"""A study from its configuration to its tables, in a folder from which it can go on after any interruption.

What is done so far is in one SQLite file, written by one process, whole after every task whatever ends it.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial, reduce
from importlib.util import find_spec
from operator import add
from pathlib import Path

from crosscheck.distributing import DaskWorkers, Lost, NoWorkers, Workers
from crosscheck.identifying import ESTIMATORS
from crosscheck.study.folder import CONFIGURATION_ORIGIN, CONFIGURATION_TEXT, DATABASE, begin, begin_or_go_on, is_new
from crosscheck.study.settings.configuration import Configuration, shown_name
from crosscheck.study.simulated.plants import refuse_unfit
from crosscheck.study.store import Key, Store, opened
from crosscheck.study.tables import write_results, write_scenarios
from crosscheck.study.tasks import (
    LIBRARIES,
    StudyOutcome,
    StudyTask,
    Surroundings,
    Unfit,
    computed,
    failed,
    taking_part,
)
from graphdyn import InvalidInput
from graphdyn.errors import install_line

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
    extend: bool = False,
    versions: Mapping[str, str] | None = None,
    progress: Callable[[Progress], None] | None = None,
    tell: Callable[[str], None] | None = None,
    before: Callable[[], None] | None = None,
    first: Callable[[], None] | None = None,
) -> None:
    """Compute every task that is not done, and write the tables.

    folder: new or empty; with `resume` that of the same study, or new; with `extend` that of a part of it
    versions: of the libraries, which must be those the study was begun with
    progress: called after every task; tell: with a line about every process that died
    before: called before the first task, when nothing else is wrong; first: called after it, with the folder begun

    After any interruption, what was done is in the folder.

    Raises BadConfiguration for settings that do not fit the robot; InvalidInput for a folder that is something else, or
    of a study with another configuration; NoWorkers for processes that lack what it needs; OSError; urdf's errors.
    """
    refuse_unfit(study)
    refuse_missing_packages(study)
    if isinstance(workers, DaskWorkers):
        workers = replace(workers, libraries=LIBRARIES)
    before = before or (lambda: None)
    new = is_new(folder, resume, extend)
    if new:
        before()
        begin(study, folder)
    inputs = {
        CONFIGURATION_TEXT: study.text,
        CONFIGURATION_ORIGIN: study.origin,
        **study.own_files,
        **study.recorded_files,
        **(versions or {}),
    }
    with opened(folder / DATABASE, tell) as store:
        begin_or_go_on(study, folder, store, inputs, extend=extend)
        if not new:
            before()
        write_scenarios(study, folder)
        if first is not None:
            first()
        _compute(study, store, workers, progress or (lambda _: None), tell or (lambda _: None))
        write_results(store.outcomes(), folder)


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


def tasks_of(study: Configuration) -> list[StudyTask]:
    """All, one run of every scenario after the other, so that what is left is known early."""
    methods = [(scenario, taking_part(study.methods, scenario)) for scenario in study.scenarios]
    return [StudyTask(scenario, run, part) for run in range(study.runs) for scenario, part in methods if part]


def _tasks_left(everything: Sequence[StudyTask], done: Mapping[Key, frozenset[str]]) -> list[StudyTask]:
    """The tasks that are not done, with the methods that are missing."""
    left = []
    for task in everything:
        names = done.get(_key(task), frozenset())
        missing = tuple(method for method in task.methods if shown_name(method) not in names)
        if missing:
            left.append(replace(task, methods=missing))
    return left


def _key(task: StudyTask) -> Key:
    return task.scenario.name, task.run


def _compute(
    study: Configuration,
    store: Store,
    workers: Workers,
    progress: Callable[[Progress], None],
    tell: Callable[[str], None],
) -> None:
    everything = tasks_of(study)
    tasks = _tasks_left(everything, store.done())
    left = Remaining(tasks)
    progress(Progress(len(everything) - len(tasks), len(everything)))
    lost = list[StudyTask]()
    work = partial(computed, study, Surroundings.here(study))
    with closing(_answers(work, tasks, workers)) as answers:
        for k, answer in answers:
            task = tasks[k]
            outcome = usable(task, answer)
            if isinstance(outcome, Lost):
                tell(f"{_name(task)}: {outcome.reason}; its methods are tried one by one")
                lost.append(task)
                continue
            store.add(_key(task), outcome)
            left.count(task, outcome.total)
            progress(Progress(len(everything) - left.tasks, len(everything), left.seconds()))
    for task in lost:
        store.add(_key(task), _one_by_one(work, task, workers, tell))
        left.count(task, None)
        progress(Progress(len(everything) - left.tasks, len(everything), left.seconds()))


def _answers(
    work: Callable[[StudyTask], StudyOutcome | Unfit], tasks: Sequence[StudyTask], workers: Workers
) -> Generator[tuple[int, StudyOutcome | Unfit | Lost], None, None]:
    """Number and answer of each task. Raises NoWorkers, which says how to go on."""
    try:
        yield from workers.each(work, tasks)
    except NoWorkers as error:
        raise NoWorkers(f"{error}; what is done is kept: go on with --resume") from error


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
    with closing(_answers(work, alone, workers)) as answers:
        for k, answer in answers:
            outcome = usable(alone[k], answer)
            if isinstance(outcome, Lost):
                tell(f"{_name(task)}, {task.methods[k]}: {outcome.reason}")
                outcome = failed(alone[k], PROCESS_DIED)
            found[k] = outcome
    return reduce(add, (found[k] for k in range(len(alone))))


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
