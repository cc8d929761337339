"""The page of a sweep: one row per robot, and the details of few of them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from crosscheck.referee.comparison import Comparison
from crosscheck.report.comparisons import versions
from crosscheck.report.pages.comparisons import section
from crosscheck.report.pages.rendering import render
from crosscheck.report.summary import AGREES, DISAGREES, KINEMATICS_ONLY, REFUSED, Row, counts, short_names

FEW = 12
"""Robots of which a page shows all details, some 150 kB each; of more robots, only of those that disagree."""

SYMBOLS = {AGREES: "✓", DISAGREES: "✗", KINEMATICS_ONLY: "?", REFUSED: "✗"}


def summary_page(rows: Sequence[Row], comparisons: Sequence[Comparison], command: Sequence[str]) -> str:
    """One page about all robots. comparisons: those to be shown in detail, in the order of the rows."""
    keys = {comparison.robot: f"robot-{k}" for k, comparison in enumerate(comparisons, start=1)}
    return render(
        "summary.html",
        rows=[(name, keys.get(row.robot), row) for name, row in zip(short_names(rows), rows, strict=True)],
        sections=[section(comparison, keys[comparison.robot]) for comparison in comparisons],
        counts=counts(rows),
        compared=sum(row.verdict != REFUSED for row in rows),
        few=len(rows) <= FEW,
        SYMBOLS=SYMBOLS,
        command=shlex.join(command),
        versions=versions(),
    )
