"""`graphdyn crosscheck --exact`: the true errors of every code, robot by robot, those of folders in processes."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import typer

from crosscheck.commands.crosscheck.exact.report import accuracy_report
from crosscheck.commands.crosscheck.options import CrosscheckOptions
from crosscheck.commands.program.console import complain, err, progress, warnings_shown
from crosscheck.commands.program.delivery import deliver, figure_at_rest
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.commands.program.options import files_below, is_folder
from crosscheck.comparing.accuracy import TrueErrors, true_errors
from crosscheck.comparing.compare import count_states
from crosscheck.distributing import Lost
from crosscheck.exact import Truth, check_installed
from crosscheck.report.findings.failures import Failure, failure
from graphdyn import GraphDynError
from urdf import Reading

Choice = tuple[str, Reading]
"""A robot as given, and how it is read."""


@dataclass(frozen=True)
class MeasuringTask:
    """A robot to be measured, and how."""

    robot: str
    samples: int
    seed: int
    truth: Truth


def examine(task: MeasuringTask) -> TrueErrors | Failure:
    """The errors of one robot, or why there are none."""
    try:
        with warnings.catch_warnings(action="ignore"):
            return true_errors(task.robot, task.samples, task.seed, truth=task.truth)
    except (GraphDynError, OSError) as error:
        return failure(task.robot, error)
    except Exception as error:
        return failure(task.robot, f"the measurement failed: {type(error).__name__}: {error}; report it")


def measure(context: typer.Context, options: CrosscheckOptions, choice: Sequence[Choice]) -> int:
    """Measure all robots and files below folders, report, and return the exit code."""
    check_installed()
    assert options.exact is not None
    folders = any(is_folder(robot) for robot, _ in choice)
    measured: list[TrueErrors] = []
    failures: list[Failure] = []
    for found in (_in_processes if folders else _in_turn)(context, options, choice):
        if isinstance(found, TrueErrors):
            measured.append(found)
        else:
            failures.append(found)
    deliver(
        accuracy_report(measured, failures),
        options,
        lambda: [figure_at_rest(one.robot, one.model, one.reading) for one in measured],
    )
    if failures:
        return BAD_INPUT
    return AGREED if all(one.agrees for one in measured) else DISAGREED


def _in_turn(
    context: typer.Context, options: CrosscheckOptions, choice: Sequence[Choice]
) -> Iterator[TrueErrors | Failure]:
    """One robot after the other, with the progress of each."""
    samples = options.exact or 0
    for number, (robot, how) in enumerate(choice, start=1):
        title = robot if len(choice) == 1 else f"{robot} ({number} of {len(choice)})"
        try:
            total = count_states(robot, samples, options.seed, how) if err.is_terminal else None
            with progress(title, total) as advance, warnings_shown():
                found: TrueErrors | Failure = true_errors(
                    robot, samples, options.seed, truth=options.truth, reading=how, progress=advance
                )
        except (GraphDynError, OSError) as error:
            complain(error, context)
            found = failure(robot, error)
        yield found


def _in_processes(
    context: typer.Context, options: CrosscheckOptions, choice: Sequence[Choice]
) -> Iterator[TrueErrors | Failure]:
    """Every file of folders, several at once."""
    robots: list[str] = []
    for robot, _ in choice:
        try:
            robots += files_below(robot) if is_folder(robot) else [robot]
        except GraphDynError as error:
            complain(error, context)
            yield failure(robot, error)
    robots = list(dict.fromkeys(robots))
    found: dict[str, TrueErrors | Failure] = {}
    with progress("exact values", len(robots)) as advance:
        tasks = [MeasuringTask(robot, options.exact or 0, options.seed, options.truth) for robot in robots]
        for k, outcome in options.workers.each(examine, tasks):
            if isinstance(outcome, Lost):
                outcome = failure(robots[k], f"it was lost: {outcome.reason}; report it")
            found[robots[k]] = outcome
            advance(robots[k], 1)
    yield from (found[robot] for robot in robots)
