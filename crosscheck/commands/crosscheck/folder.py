"""`graphdyn crosscheck FOLDER`: many files in parallel; one that fails or ends its process does not stop the others."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any, Literal

import typer

from crosscheck.commands.crosscheck.checks import crosscheck_checks
from crosscheck.commands.crosscheck.folder_file import SweepFile, taken_over
from crosscheck.commands.crosscheck.folder_report import (
    MAX_DETAILED_ROBOTS,
    compared_row,
    failed_row,
    folder_report,
)
from crosscheck.commands.crosscheck.options import CrosscheckOptions
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.commands.program.console import complain, progress, say
from crosscheck.commands.program.finding_options import deliver_findings
from crosscheck.commands.program.options import command_line, files_below, is_folder
from crosscheck.comparing import compare as comparing
from crosscheck.comparing.comparison import Comparison
from crosscheck.distributing import Lost
from crosscheck.report.findings.failures import failure
from crosscheck.report.records.record import plain
from graphdyn import GraphDynError

Details = Literal["none", "disagreeing", "all"]
"""The robots whose whole Comparison is returned, which is larger than its record."""


@dataclass(frozen=True)
class ComparisonTask:
    """A robot to be compared, and how."""

    robot: str
    samples: int
    seed: int
    details: Details


@dataclass(frozen=True, eq=False)
class ComparisonOutcome:
    """The result of a task: a record as in the JSON file, or a failure as there.

    comparison: where the task asks for it
    """

    record: dict[str, Any] | None = None
    failure: dict[str, Any] | None = None
    comparison: Comparison | None = None


def examine(task: ComparisonTask) -> ComparisonOutcome:
    """Compare one robot. Warnings go into the notes, and every error into the outcome."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            comparison = comparing.compare(task.robot, task.samples, task.seed)
    except (GraphDynError, OSError) as error:
        return ComparisonOutcome(failure=failure(task.robot, error))
    except Exception as error:
        message = f"the comparison failed: {type(error).__name__}: {error}; report it"
        return ComparisonOutcome(failure=failure(task.robot, message, "comparison-failed"))
    notes = [*comparison.notes, *(str(warning.message).removeprefix(f"{task.robot}: ") for warning in caught)]
    comparison = replace(comparison, notes=tuple(notes))
    wanted = task.details == "all" or (task.details == "disagreeing" and not comparison.agrees)
    return ComparisonOutcome(plain(robot_record(comparison)), None, comparison if wanted else None)


def compare_folder(context: typer.Context, options: CrosscheckOptions) -> int:
    """Compare all robots and files below folders, report, and return the exit code."""
    samples, seed, json_file = options.samples, options.seed, options.json_file
    accepted = options.accepted("crosscheck")
    robots, failures = [], []
    for argument in options.robots or []:
        try:
            robots += files_below(argument) if is_folder(argument) else [argument]
        except GraphDynError as error:
            complain(error, context)
            failures.append(failure(argument, error))
    robots = list(dict.fromkeys(robots))
    file = SweepFile(json_file, command_line(), robots, failures)
    if options.resume and json_file is not None:
        file.records.update(taken_over(json_file.path, robots, samples, seed))
        say(f"{len(file.records)} of {len(robots)} robots taken over from {json_file.path}")
    details: Details = (
        "none" if options.html_file is None else "all" if len(robots) <= MAX_DETAILED_ROBOTS else "disagreeing"
    )
    tasks = [ComparisonTask(robot, samples, seed, details) for robot in robots if robot not in file.records]
    comparisons = {}
    try:
        with progress("crosscheck", len(robots)) as advance:
            advance("", len(file.records))
            for k, outcome in options.workers.each(examine, tasks):
                robot = tasks[k].robot
                if isinstance(outcome, Lost):
                    message = f"the comparison was lost: {outcome.reason}; report it, with the file"
                    file.failures[robot] = failure(robot, message, "comparison-failed")
                elif outcome.failure is not None:
                    file.failures[robot] = outcome.failure
                elif outcome.record is not None:
                    file.records[robot] = outcome.record
                    if outcome.comparison is not None:
                        comparisons[robot] = outcome.comparison
                advance(robot, 1)
                file.write()
    finally:
        file.write(finished=True)
    rows = [
        compared_row(file.records[robot]) if robot in file.records else failed_row(file.failures[robot])
        for robot in (*robots, *(given for given in file.failures if given not in robots))
    ]
    detailed = [comparisons[robot] for robot in robots if robot in comparisons]
    records = [file.records[robot] for robot in robots if robot in file.records]
    checks = crosscheck_checks(records, list(file.failures.values()))
    return deliver_findings("crosscheck", checks, folder_report(rows, detailed), options, accepted)
