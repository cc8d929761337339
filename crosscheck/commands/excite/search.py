"""The search for an exciting motion from several seeds in parallel; the best is kept, also after an interruption."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TYPE_CHECKING, NamedTuple

from crosscheck.commands.program.console import say
from crosscheck.distributing import LocalProcesses, Lost

if TYPE_CHECKING:
    from crosscheck.exciting.self_collision import SelfCollision
    from graphdyn.excitation import ExcitationProblem, OptimizedMotion


class SearchTask(NamedTuple):
    problem: ExcitationProblem
    seed: int
    collisions: SelfCollision | None


class SearchSummary(NamedTuple):
    """best: of the seeds that found a motion; failures: why the others did not; interrupted: before all were done"""

    best: OptimizedMotion | None
    failures: list[str]
    interrupted: bool


def search(task: SearchTask) -> OptimizedMotion | str:
    """The motion from one seed, or why there is none."""
    from crosscheck.exciting.self_collision import collision_free
    from graphdyn.excitation import NoFeasibleMotion, optimized

    try:
        if task.collisions is None:
            return optimized(task.problem, task.seed)
        return collision_free(task.problem, task.collisions, task.seed)
    except NoFeasibleMotion as error:
        return str(error)


def one_by_one(tasks: list[SearchTask]) -> Generator[tuple[int, OptimizedMotion | str]]:
    """Search in this process: starting another takes longer than a search."""
    for k, task in enumerate(tasks):
        yield k, search(task)


def best_of(
    problem: ExcitationProblem,
    collisions: SelfCollision | None,
    seeds: range,
    processes_used: int,
    advance: Callable[[str, int], None],
) -> SearchSummary:
    """The best motion from these seeds. Raises KeyboardInterrupt where it comes before the first motion is found."""
    tasks = [SearchTask(problem, seed, collisions) for seed in seeds]
    best: OptimizedMotion | None = None
    failures = list[str]()
    answers = LocalProcesses(processes_used).each(search, tasks) if processes_used > 1 else one_by_one(tasks)
    try:
        for k, outcome in answers:
            if isinstance(outcome, Lost):
                failures.append(f"the search from seed {tasks[k].seed} was lost: {outcome.reason}")
            elif isinstance(outcome, str):
                failures.append(outcome)
            elif best is None or outcome.value < best.value:
                best = outcome
            advance(f"seed {tasks[k].seed}", 1)
    except KeyboardInterrupt:
        if best is None:
            raise
        say(f"interrupted: the best motion so far, of seed {best.seed}, is kept", "yellow")
        return SearchSummary(best, failures, True)
    finally:
        answers.close()  # ends its processes
    return SearchSummary(best, failures, False)
