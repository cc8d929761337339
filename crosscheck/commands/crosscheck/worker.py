"""One robot of a sweep, compared in a process of its own; a failure becomes part of the outcome."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any, Literal

from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.comparing import compare as comparing
from crosscheck.comparing.comparison import Comparison
from crosscheck.report.records.json import plain
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
    """The result of a task: a record as in the JSON file, or the reason for a failure.

    comparison: where the task asks for it
    """

    robot: str
    record: dict[str, Any] | None = None
    failure: str | None = None
    comparison: Comparison | None = None


def examine(task: ComparisonTask) -> ComparisonOutcome:
    """Compare one robot. Warnings go into the notes, and every error into the outcome."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            comparison = comparing.compare(task.robot, task.samples, task.seed)
    except (GraphDynError, OSError) as error:
        return ComparisonOutcome(task.robot, failure=str(error))
    except Exception as error:
        return ComparisonOutcome(
            task.robot, failure=f"the comparison failed: {type(error).__name__}: {error}; report it"
        )
    notes = [*comparison.notes, *(str(warning.message).removeprefix(f"{task.robot}: ") for warning in caught)]
    comparison = replace(comparison, notes=tuple(notes))
    wanted = task.details == "all" or (task.details == "disagreeing" and not comparison.agrees)
    return ComparisonOutcome(task.robot, plain(robot_record(comparison)), None, comparison if wanted else None)
