"""The page of a cross-check: the verdict on every robot, and every number behind it."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from crosscheck.referee.comparison import Comparison, QuantityResult
from crosscheck.report import snippets
from crosscheck.report.comparisons import versions
from crosscheck.report.pages.rendering import render
from crosscheck.report.pictures.spread import Row, spread
from crosscheck.report.pictures.stick_figure import pose_text, stick_figure
from crosscheck.report.summary import part_of_bound


@dataclass(frozen=True, eq=False)
class Section:
    """What the template needs of one robot beyond its comparison.

    name: without the folders of a path; key: of its ids on the page
    results: those that disagree first, then in the order of the table
    nearest: the one with the largest error relative to its bound
    worst: (result, Python that reproduces its worst state), the nearest to the bound, or farthest beyond it, first
    left_out: (reason, names) of what was not compared
    """

    comparison: Comparison
    name: str
    key: str
    results: tuple[QuantityResult, ...]
    nearest: QuantityResult
    worst: tuple[tuple[QuantityResult, str], ...]
    left_out: tuple[tuple[str, tuple[str, ...]], ...]
    figure: Markup
    pose: str
    spread: Markup


def comparison_page(
    comparisons: Sequence[Comparison], command: Sequence[str], failures: Sequence[Mapping[str, str]] = ()
) -> str:
    """One page about all robots. The same arguments and versions give the same characters.

    command: the arguments that made the comparisons
    failures: robots that could not be compared: robot, message
    """
    return render(
        "comparison.html",
        sections=[section(comparison, f"robot-{k}") for k, comparison in enumerate(comparisons, start=1)],
        command=shlex.join(command),
        failures=failures,
        versions=versions(),
    )


def section(comparison: Comparison, key: str) -> Section:
    """What the template shows of one robot."""
    name = Path(comparison.robot).name
    in_order = list(comparison.quantities.values())
    results = sorted(in_order, key=lambda result: result.agrees)  # stable: the order of the table otherwise
    by_margin = sorted(in_order, key=_margin, reverse=True)
    reasons = dict.fromkeys(comparison.not_compared.values())
    found = ((result, snippets.worst_state(comparison, result)) for result in by_margin)
    return Section(
        comparison,
        name,
        key,
        tuple(results),
        by_margin[0],
        tuple((result, text) for result, text in found if text is not None),
        tuple(
            (reason, tuple(name for name, why in comparison.not_compared.items() if why == reason))
            for reason in reasons
        ),
        stick_figure(f"{key}-figure", comparison.model, name),
        pose_text(comparison.model),
        spread(
            f"{key}-spread",
            [Row(result.quantity.name, result.errors, result.quantity.tolerance.bound) for result in results],
        ),
    )


def _margin(result: QuantityResult) -> float:
    return part_of_bound(result.max_relative_error, result.quantity.tolerance.bound)
