"""Errors against noise, as pictures and numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from crosscheck.commands.study.error_pictures import ErrorLine, study_errors
from crosscheck.commands.study.scenarios_report import ShownRuns
from crosscheck.commands.study.words import ERRORS_IN_WORDS, HEADLINE_ERROR, METHOD_CLASSES, percent_text
from crosscheck.report.report import Block, Column, Picture, Prose, Row, Section, Table
from crosscheck.study.statistics.grid import Grid, View
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL
from crosscheck.study.statistics.outcomes import ERRORS, Measures
from crosscheck.study.statistics.summary import StudySummary

MAX_LINES_PER_PICTURE = 4
"""Lines of one picture; more make a picture each."""

ERRORS_NOTE = (
    "One panel per method, all on the same axes. Dots: runs; click one for what all methods made of its record. Lines: "
    "medians, with failures as infinite; pale bars: {level:.0%} intervals of the median."
)


def errors_section(found: StudySummary, grid: Grid, measures: Measures, on_page: ShownRuns) -> Section:
    """Errors of the methods that measure this."""
    columns = found.methods(measures)
    blocks: list[Block] = [Prose(ERRORS_NOTE.format(level=CONFIDENCE_LEVEL), soft=True, on=("page",))]
    for error in ERRORS:
        if any(np.isfinite(one.errors[error][:, columns]).any() for one in found.outcomes.scenarios):
            for view in grid.views():
                blocks += _pictures(found, grid, view, columns, error, on_page)
            blocks.append(_medians(found, grid, columns, error))
    return Section(f"errors-{measures}", f"Errors ({METHOD_CLASSES[measures][1]} measured)", tuple(blocks))


def _pictures(
    found: StudySummary, grid: Grid, view: View, columns: Sequence[int], error: str, on_page: ShownRuns
) -> list[Block]:
    title = f"{ERRORS_IN_WORDS[error].capitalize()} against {view.along[0].replace('_', ' ')}"
    methods = [found.outcomes.methods[k].name for k in columns]
    hovers = {
        f"#{key}": f"run {run}, {grid.words(found.outcomes.scenarios[number])}: all methods"
        for number, run, key in on_page.every(found)
    }
    lines = [_line(found, view, k, columns, error, on_page) for k in range(len(view.lines))]
    lines = [line for line in lines if line.places]
    if len(lines) == 1:
        lines = [replace(lines[0], name="")]
    parts = [lines[k : k + MAX_LINES_PER_PICTURE] for k in range(0, len(lines), MAX_LINES_PER_PICTURE)]
    label = f"{title}, in percent on a logarithmic axis, of {len(methods)} methods"
    return [
        Picture(
            partial(
                study_errors, label=label, methods=methods, places=view.places, title=view.title, lines=part,
                hovers=hovers,
            ),
            title=title if k == 0 else "",
            on=("page",),
        )
        for k, part in enumerate(parts)
    ]  # fmt: skip


def _line(
    found: StudySummary, view: View, number: int, columns: Sequence[int], error: str, on_page: ShownRuns
) -> ErrorLine:
    name, numbers = view.lines[number]
    there = [
        (place, number)
        for place, number in enumerate(numbers)
        if number is not None and found.outcomes.scenarios[number].taken[columns].all()
    ]
    intervals = [[found.scenarios[number].methods[k].errors[error] for k in columns] for _, number in there]
    shown = [found.outcomes.scenarios[number].errors[error][: on_page.each][:, columns] for _, number in there]
    middle, low, high = (
        100 * np.array([[getattr(x, end) for x in row] for row in intervals]) for end in ("value", "low", "high")
    )
    return ErrorLine(
        name,
        places=[place for place, _ in there],
        errors=[100 * errors for errors in shown],
        middle=middle,
        low=low,
        high=high,
        links=[
            [f"#{on_page.key(number, k)}" for k in range(len(errors))]
            for (_, number), errors in zip(there, shown, strict=True)
        ],
        joined=view.numeric,
    )


def _medians(found: StudySummary, grid: Grid, columns: Sequence[int], error: str) -> Table:
    """Methods by rows, scenarios by columns."""
    ordered = [found.scenarios[number] for number in grid.order()]
    rows = []
    for k in columns:
        cells = (percent_text(scenario.methods[k].errors[error]) for scenario in ordered)
        rows.append(Row((found.outcomes.methods[k].name, *cells)))
    return Table(
        (Column("method", "name"), *(Column(grid.words(one.outcomes), "number", "%") for one in ordered)),
        tuple(rows),
        title=f"{ERRORS_IN_WORDS[error].capitalize()}, medians",
        caption=f"with {CONFIDENCE_LEVEL:.0%} intervals; failures count as infinite",
        failures_first=False,
        folded=True,
        on=("text", "page") if error == HEADLINE_ERROR else ("page",),
    )
