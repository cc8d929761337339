"""Inspected files as tables for the terminal."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from urdf import Finding, Report

PLACES = 3
"""Elements named per kind of finding; --json and --html have all."""

REASONS = 5
"""Reasons told of a verdict."""

WORST = 4
"""Codes told per file in the table of several."""

SEVERITIES = ("error", "warning", "note")


def one(report: Report) -> Iterator[RenderableType]:
    """One file: a row per kind of finding, the verdict, and why."""
    table = Table()
    for column in ("severity", "finding", "where", "what, and what to do"):
        table.add_column(column, overflow="fold")
    for kind in grouped(report):
        first = kind[0]
        number = f" {len(kind)}×" if len(kind) > 1 else ""
        table.add_row(first.severity, first.code + number, _places(kind), f"{first.message}\n→ {first.remedy}")
    yield table
    counts = ", ".join(f"{report.count(severity)} {severity}s" for severity in SEVERITIES)  # type: ignore[arg-type]
    yield Text(f"{report.robot}: {report.verdict} ({counts})")
    for reason in report.reasons[:REASONS]:
        yield Text(f"  {reason}")
    if len(report.reasons) > REASONS:
        yield Text(f"  and {len(report.reasons) - REASONS} more")


def several(reports: Sequence[Report]) -> Iterator[RenderableType]:
    """A row per file with its worst findings, how often each finding occurs, and how many files have which verdict."""
    folder = _common_folder([report.robot for report in reports])
    table = Table(title=folder or None, title_justify="left")
    table.add_column("file", overflow="fold")
    table.add_column("verdict", no_wrap=True)
    for severity in SEVERITIES:
        table.add_column(f"{severity}s", justify="right")
    table.add_column("worst", overflow="fold")
    for report in reports:
        counts = (str(report.count(severity)) for severity in SEVERITIES)  # type: ignore[arg-type]
        table.add_row(
            os.path.relpath(report.robot, folder) if folder else report.robot,
            report.verdict,
            *counts,
            ", ".join(worst(report)),
        )
    yield table
    often = Table("finding", "files", title="How many files have it", title_justify="left")
    for code, number in occurrences(reports).items():
        often.add_row(code, str(number))
    yield often
    verdicts = Counter(report.verdict for report in reports)
    yield Text(f"{len(reports)} files: " + ", ".join(f"{number} {verdict}" for verdict, number in verdicts.items()))


def grouped(report: Report) -> list[list[Finding]]:
    """The findings by severity and code, in the order of the report."""
    kinds: dict[tuple[str, str], list[Finding]] = {}
    for finding in report.findings:
        kinds.setdefault((finding.severity, finding.code), []).append(finding)
    return list(kinds.values())


def worst(report: Report) -> list[str]:
    """The first codes of the worst severity there is, notes left out."""
    codes = [dict.fromkeys(f.code for f in report.findings if f.severity == severity) for severity in SEVERITIES[:2]]
    return list(next((found for found in codes if found), {}))[:WORST]


def occurrences(reports: Sequence[Report]) -> dict[str, int]:
    """By code, the number of files that have it, most frequent first."""
    return dict(Counter(code for report in reports for code in report.codes).most_common())


def _common_folder(robots: Sequence[str]) -> str:
    """The folder that all are in; empty where there is none."""
    try:
        return os.path.commonpath([os.path.dirname(robot) for robot in robots])
    except ValueError:  # names, or absolute and relative paths
        return ""


def _places(kind: Sequence[Finding]) -> str:
    lines = [
        ", ".join(part for part in (finding.element, finding.line and f"line {finding.line}") if part)
        for finding in kind[:PLACES]
    ]
    more = [f"and {len(kind) - PLACES} more"] if len(kind) > PLACES else []
    return "\n".join([*lines, *more])
