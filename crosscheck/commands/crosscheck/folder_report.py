"""`graphdyn crosscheck FOLDER`: many robots in short, as a report; the details of few of them."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.commands.crosscheck.report import TITLE, scales_section
from crosscheck.commands.crosscheck.robot_report import robot_section
from crosscheck.commands.crosscheck.summary import (
    AGREES,
    DISAGREES,
    KINEMATICS_ONLY,
    REFUSED,
    RobotSummary,
    counts,
    short_names,
)
from crosscheck.comparing.comparison import Comparison
from crosscheck.report.error_tables import ERROR_FORMAT
from crosscheck.report.report import Block, Column, Prose, Report, Row, Section, State, Table, Verdict

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
    blocks: list[Block] = [_terminal_table(named, keys), Prose(counts(rows), on=("text",)), *by_verdict]
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
    return Verdict(state, said, f"{counts(rows)}. {meaning}")


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
