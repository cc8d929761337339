"""`graphdyn crosscheck FOLDER`: many files in parallel; one that fails or ends its process does not stop the others."""

from __future__ import annotations

import typer

from crosscheck.commands.crosscheck.options import CrosscheckOptions
from crosscheck.commands.program.console import complain, progress, say
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.commands.program.options import command_line, files_below, is_folder
from crosscheck.distributing import Lost
from graphdyn import GraphDynError


def compare_folder(context: typer.Context, options: CrosscheckOptions) -> int:
    """Compare all robots and files below folders, report, and return the exit code."""
    from crosscheck.commands.crosscheck.folder_file import SweepFile, taken_over
    from crosscheck.commands.crosscheck.folder_report import MAX_DETAILED_ROBOTS, folder_report
    from crosscheck.commands.crosscheck.summary import DISAGREES, compared_row, failed_row
    from crosscheck.commands.crosscheck.worker import ComparisonTask, Details, examine

    samples, seed, json_file = options.samples, options.seed, options.json_file
    workers = options.workers
    robots, failures = [], []
    for argument in options.robots or []:
        try:
            robots += files_below(argument) if is_folder(argument) else [argument]
        except GraphDynError as error:
            complain(error, context)
            failures.append({"robot": argument, "message": str(error)})
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
            for k, outcome in workers.each(examine, tasks):
                robot = tasks[k].robot
                if isinstance(outcome, Lost):
                    message = f"the comparison was lost: {outcome.reason}; report it, with the file"
                    file.failures[robot] = {"robot": robot, "message": message}
                elif outcome.record is None:
                    file.failures[robot] = {"robot": robot, "message": str(outcome.failure)}
                else:
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
    deliver(folder_report(rows, detailed), options)
    if file.failures:
        return BAD_INPUT
    return DISAGREED if any(row.verdict == DISAGREES for row in rows) else AGREED
