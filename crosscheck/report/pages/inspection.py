"""The page of inspected files: the verdict on each, and every finding."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from crosscheck.report.pages.rendering import render
from crosscheck.report.versions import versions
from urdf import Report

SYMBOLS = {"dynamics": ("agrees", "✓"), "kinematics only": ("undecided", "?"), "refused": ("disagrees", "✗")}
"""Per verdict: how it looks, and its symbol."""


def inspection_page(
    reports: Sequence[Report], command: Sequence[str], failures: Sequence[Mapping[str, str]] = ()
) -> str:
    """One page about all files. The same arguments and versions give the same characters.

    command: the arguments that made the reports
    failures: what could not be found: robot, message
    """
    verdicts = Counter(report.verdict for report in reports)
    return render(
        "inspection.html",
        reports=[(f"file-{k}", Path(report.robot).name, report) for k, report in enumerate(reports, start=1)],
        verdicts={verdict: verdicts[verdict] for verdict in SYMBOLS},  # type: ignore[index]
        occurrences=Counter(code for report in reports for code in report.codes).most_common(),
        symbols=SYMBOLS,
        failures=failures,
        command=shlex.join(command),
        versions=versions(),
    )
