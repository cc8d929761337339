"""`graphdyn crosscheck FOLDER`: many robots in short, as a report; the details of few of them.

There is one row per robot, made of the records and failures of the JSON file.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

from crosscheck.commands.crosscheck.report import TITLE, scales_section
from crosscheck.commands.crosscheck.robot_report import robot_section
from crosscheck.comparing.comparison import Comparison, part_of_bound
from crosscheck.report.error_tables import ERROR_FORMAT
from crosscheck.report.report import Block, Column, Prose, Report, Row, Section, State, Table, Verdict
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


def failed_row(failure: Mapping[str, Any]) -> RobotSummary:
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


MAX_DETAILED_ROBOTS = 12
"""Robots of which a page shows all details, some 400 kB each; of more robots, only of those that disagree, as many."""

FOLDER_STATES: dict[str, State] = {
    DISAGREES: "disagrees",
    REFUSED: "disagrees",
    KINEMATICS_ONLY: "undecided",
    AGREES: "agrees",
}
"""Folder states in the order of the page."""


def folder_report(rows: Sequence[RobotSummary], comparisons: Sequence[Comparison]) -> Report:
    """comparisons: those to be shown in detail, of which the page has the MAX_DETAILED_ROBOTS worst, the worst first"""
    comparisons = sorted(comparisons, key=_part_of_bound, reverse=True)[:MAX_DETAILED_ROBOTS]
    keys = {comparison.robot: f"robot-{k}" for k, comparison in enumerate(comparisons, start=1)}
    named = list(zip(short_names(rows), rows, strict=True))
    by_verdict = [
        _table([(name, row) for name, row in named if row.verdict == verdict], keys, verdict)
        for verdict in FOLDER_STATES
    ]
    compared = sum(row.verdict != REFUSED for row in rows)
    blocks: list[Block] = [_terminal_table(named, keys), *by_verdict]
    if len(comparisons) < compared:
        blocks.append(Prose(_why_not_all(rows), soft=True, on=("page",)))
    robots = [robot_section(comparison, keys[comparison.robot], detailed=False) for comparison in comparisons]
    return Report(
        TITLE,
        _verdict(rows),
        (Section("robots", "", tuple(blocks)), *robots, *((scales_section(),) if comparisons else ())),
    )


def _part_of_bound(comparison: Comparison) -> float:
    return max(result.part_of_bound for result in comparison.quantities.values())


def _verdict(rows: Sequence[RobotSummary]) -> Verdict:
    found = {row.verdict for row in rows}
    words, state = next(
        ((words, state) for words, state in FOLDER_STATES.items() if words in found), (AGREES, "agrees")
    )
    meaning = (
        "“kinematics only”: all that was compared agrees, but forward dynamics could not be compared; “refused”: "
        "there was nothing to compare."
    )
    said = {REFUSED: "incomplete", KINEMATICS_ONLY: "no robot disagrees"}.get(words, words)
    number, robots = sum(row.verdict == words for row in rows), counted(len(rows), "robot")
    sentence = {
        DISAGREES: f"graphdyn and Pinocchio disagree on {number} of {robots}.",
        REFUSED: f"{number} of {robots} could not be compared.",
        KINEMATICS_ONLY: f"No robot disagrees, but {number} of {robots} could be compared in kinematics only.",
        AGREES: f"graphdyn and Pinocchio agree on {robots}.",
    }[words]
    return Verdict(state, said, f"{counts(rows)}. {meaning}", sentence)


def _why_not_all(rows: Sequence[RobotSummary]) -> str:
    if len(rows) <= MAX_DETAILED_ROBOTS:
        return "Robots taken over from an earlier run have no details here; a run without --resume shows them."
    return (
        f"Details are shown of robots that disagree and were compared in this run, the {MAX_DETAILED_ROBOTS} worst; "
        "the JSON file has the numbers of all."
    )


def _terminal_table(named: Sequence[tuple[str, RobotSummary]], keys: dict[str, str]) -> Table:
    """All robots in one table, in their order."""
    columns = (Column("robot"), *_columns())
    return Table(columns, tuple(_row(name, row, keys) for name, row in named), failures_first=False, on=("text",))


def _table(named: Sequence[tuple[str, RobotSummary]], keys: dict[str, str], verdict: str) -> Table:
    """The robots of one verdict, for the page; folded where there are many that agree."""
    return Table(
        (Column("robot", "name"), *_columns()),
        tuple(_row(name, row, keys) for name, row in named),
        title=f"{verdict}: {len(named)}",
        caption="Each with the quantity whose error takes the largest part of its bound",
        on=("page",),
        folded=verdict == AGREES and len(named) > MAX_DETAILED_ROBOTS,
    )


def _columns() -> tuple[Column, ...]:
    return (
        Column("verdict", "verdict"),
        Column("routes"),
        Column("nearest its bound"),
        Column("error", **ERROR_FORMAT),
        Column("bound", **ERROR_FORMAT),
        Column("reason"),
    )


def _row(name: str, row: RobotSummary, keys: dict[str, str]) -> Row:
    verdict = Verdict(FOLDER_STATES[row.verdict], row.verdict)
    routes = "both" if len(row.routes) > 1 else "".join(row.routes) or None
    cells = (name, verdict, routes, row.nearest, row.error, row.bound, row.reason)
    return Row(cells, verdict.state, link=keys.get(row.robot))
