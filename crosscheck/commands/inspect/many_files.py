"""Inspects many files in parallel processes. No file stops the others, whatever it does to its process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from crosscheck.distributing import LocalProcesses, Lost
from graphdyn.compiler import cores
from urdf import Finding, Inspection, inspect

MIN_PARALLEL_FILES = 16
"""So many files take less time than starting processes, a second each."""

Examine = Callable[[str], Inspection]


def inspect_files(
    robots: Sequence[str], done: Callable[[str, int], None], examine: Examine = inspect
) -> list[Inspection]:
    """One report per robot, in their order. done: called with what was just inspected, and 1."""
    work = partial(_examined, examine)
    reports: dict[int, Inspection] = {}
    answers = (
        LocalProcesses(cores()).each(work, robots) if len(robots) > MIN_PARALLEL_FILES else enumerate(map(work, robots))
    )
    for k, answer in answers:
        if isinstance(answer, Lost):
            answer = _failed(robots[k], f"the inspection was lost: {answer.reason}")
        reports[k] = answer
        done(robots[k], 1)
    return [reports[k] for k in range(len(robots))]


def _examined(examine: Examine, robot: str) -> Inspection:
    try:
        return examine(robot)
    except Exception as error:
        return _failed(robot, f"the inspection failed: {type(error).__name__}: {error}")


def _failed(robot: str, message: str) -> Inspection:
    finding = Finding("inspection-failed", "error", None, None, message, "report it, with the file")
    return Inspection(robot, robot, (finding,))
