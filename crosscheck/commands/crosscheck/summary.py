"""Many cross-checks in short: one row per robot, made of the records and failures of the JSON file."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

from crosscheck.comparing.comparison import part_of_bound
from graphdyn.errors import counted

AGREES, DISAGREES, KINEMATICS_ONLY, REFUSED = VERDICTS = ("agrees", "DISAGREES", "kinematics only", "refused")
"""Kinematics only: everything that was compared agrees, but forward dynamics could not be compared."""

_ABOUT_MASS = ("no body has mass", "moving links without <inertial>")
"""Begin the notes that say once more why forward dynamics were not compared."""


@dataclass(frozen=True)
class RobotSummary:
    """The outcome of one robot.

    routes: of the comparison; empty where there was none
    nearest, error, bound: the quantity whose error takes the largest part of its bound, None where there is none
    reason: in one line, what a reader must know of this outcome
    """

    robot: str
    verdict: str
    routes: tuple[str, ...]
    nearest: str | None
    error: float | None
    bound: float | None
    reason: str


def compared_row(record: Mapping[str, Any]) -> RobotSummary:
    """The row of a robot that was compared. record: as in the JSON file (docs/json.md)."""
    quantities = record["quantities"]
    errors = {name: math.inf if (x := q["max_relative_error"]) is None else x for name, q in quantities.items()}
    nearest = max(quantities, key=lambda name: part_of_bound(errors[name], quantities[name]["bound"]))
    verdict = DISAGREES if not record["agrees"] else KINEMATICS_ONLY if record["not_compared"] else AGREES
    return RobotSummary(
        record["robot"],
        verdict,
        tuple(record["routes"]),
        nearest,
        errors[nearest],
        quantities[nearest]["bound"],
        _one_line("; ".join(_reasons(record)), record["file"], record["robot"]),
    )


def failed_row(failure: Mapping[str, str]) -> RobotSummary:
    """The row of a robot that could not be compared. failure: robot, message."""
    robot = failure["robot"]
    return RobotSummary(robot, REFUSED, (), None, None, None, _one_line(failure["message"], robot))


def counts(rows: Sequence[RobotSummary]) -> str:
    """How many robots have each verdict, in one line."""
    number = Counter(row.verdict for row in rows)
    alone = sum(row.routes == ("model",) for row in rows)
    return (
        f"{counted(len(rows), 'robot')}: "
        + ", ".join(f"{verdict} {number[verdict]}" for verdict in VERDICTS)
        + (f"; {alone} by the route 'model' alone" if alone else "")
    )


def short_names(rows: Sequence[RobotSummary]) -> list[str]:
    """The robots without the folder that all of them share."""
    parts = [Path(row.robot).parts for row in rows]
    shared = len(list(takewhile(lambda folders: len(set(folders)) == 1, zip(*(p[:-1] for p in parts), strict=False))))
    return [str(Path(*p[shared:])) for p in parts]


def _reasons(record: Mapping[str, Any]) -> list[str]:
    """What disagrees, why forward dynamics were not compared, and the notes that say something else."""
    beyond = [name for name, quantity in record["quantities"].items() if not quantity["agrees"]]
    reasons = [f"beyond the bound: {', '.join(beyond)}"] if beyond else []
    if not record["not_compared"]:
        return [*reasons, *record["notes"]]
    if record["identification"] is None:
        reasons.append("no body has mass")
    else:
        missing = dict.fromkeys(record["not_compared"].values())
        reasons += [f"forward dynamics not compared: {reason}" for reason in missing]
    return reasons + [note for note in record["notes"] if not note.startswith(_ABOUT_MASS)]


def _one_line(text: str, *paths: str) -> str:
    """One line without line breaks and without the folders of the file, which has its own column."""
    for path in paths:
        text = text.replace(path, Path(path).name)
    return " ".join(text.split())
