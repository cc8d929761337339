"""One robot among many: it is compared, or it is told why not. Runs in a process of its own."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any, Literal

from crosscheck.referee import compare as comparing
from crosscheck.referee.comparison import Comparison
from crosscheck.report.json import plain
from crosscheck.report.records.crosscheck import robot_record
from graphdyn import GraphDynError

Details = Literal["none", "disagreeing", "all"]
"""Of which robots the whole Comparison is wanted: it is larger than its record."""


@dataclass(frozen=True)
class Task:
    """What is to be compared."""

    robot: str
    samples: int
    seed: int
    details: Details


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of it: a record as in the JSON file, or why there is none.

    comparison: where the task wants it
    """

    robot: str
    record: dict[str, Any] | None = None
    failure: str | None = None
    comparison: Comparison | None = None


def examine(task: Task) -> Outcome:
    """Compare one robot. Warnings go into the notes, and every error into the outcome."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            comparison = comparing.compare(task.robot, task.samples, task.seed)
    except (GraphDynError, OSError) as error:
        return Outcome(task.robot, failure=str(error))
    except Exception as error:
        return Outcome(task.robot, failure=f"the comparison failed: {type(error).__name__}: {error}; report it")
    notes = [*comparison.notes, *(str(warning.message).removeprefix(f"{task.robot}: ") for warning in caught)]
    comparison = replace(comparison, notes=tuple(notes))
    wanted = task.details == "all" or (task.details == "disagreeing" and not comparison.agrees)
    return Outcome(task.robot, plain(robot_record(comparison)), None, comparison if wanted else None)
