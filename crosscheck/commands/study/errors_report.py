"""Errors against noise, as numbers and as pictures: one small panel per method, all on the same axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.commands.study.scenarios_report import ShownRuns
from crosscheck.commands.study.words import ERRORS_IN_WORDS, HEADLINE_ERROR, METHOD_CLASSES, percent_text
from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, MIDDLE_COLOR, picture
from crosscheck.report.report import Block, Column, Picture, Prose, Row, Section, Table
from crosscheck.study.statistics.grid import Grid, View
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL
from crosscheck.study.statistics.outcomes import ERRORS, Measures
from crosscheck.study.statistics.summary import StudySummary
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, PANEL_HEIGHT, TITLE_HEIGHT, LEFT_MARGIN = 7.6, 1.25, 0.26, 0.5
"""Sizes of the picture, height of a panel, of what is above it, room for the numbers on the left [inches]."""

ERROR_PANELS_PER_ROW = 5
"""Panels beside each other."""

KEY_HEIGHT, SPACE_BELOW = 0.3, 0.55
"""Room above for the key, and below for the axis [inches]."""

BEST_DASHES = (0, (3, 2))
"""Dashes of the smallest median."""

RUN_SPREAD = 0.6
"""Part of the distance of two places over which the runs at one are spread."""


@dataclass(frozen=True, eq=False)
class ErrorLine:
    """Scenarios that differ in their place along the axis alone.

    places: numbers of those that it has, from 0                                   (P,)
    errors: [%] of every place, runs by methods; infinite for failures      P times (R, M)
    middle, low, high: medians and the ends of their intervals [%]              (P, M)
    links: of every place and run, to the page; "" without
    joined: whether the medians are joined by a line
    """

    name: str
    places: Sequence[int]
    errors: Sequence[Array]
    middle: Array
    low: Array
    high: Array
    links: Sequence[Sequence[str]]
    joined: bool


def study_errors(
    key: str,
    label: str,
    methods: Sequence[str],
    places: Sequence[str],
    title: str,
    lines: Sequence[ErrorLine],
    hovers: Mapping[str, str],
) -> Markup:
    """methods: of the columns; places: of the axis in words, title: of the axis; hovers: of the links."""
    rows = -(-len(methods) // ERROR_PANELS_PER_ROW)
    height = KEY_HEIGHT + rows * (PANEL_HEIGHT + TITLE_HEIGHT) + SPACE_BELOW
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, methods, places, title, lines, height), hovers)


def _draw(
    axes: Axes, methods: Sequence[str], places: Sequence[str], title: str, lines: Sequence[ErrorLine], height: float
) -> None:
    axes.set_axis_off()
    across = min(ERROR_PANELS_PER_ROW, len(methods))
    width = (WIDTH - LEFT_MARGIN) / ERROR_PANELS_PER_ROW
    there = np.concatenate([part.ravel() for line in lines for part in line.errors])
    there = there[np.isfinite(there) & (there > 0)]
    reach = (there.min() / 1.5, there.max() * 1.5) if there.size else (0.1, 1.0)
    for k, name in enumerate(methods):
        row, column = divmod(k, ERROR_PANELS_PER_ROW)
        bottom = height - KEY_HEIGHT - row * (PANEL_HEIGHT + TITLE_HEIGHT) - TITLE_HEIGHT - PANEL_HEIGHT
        place = ((LEFT_MARGIN + column * width) / WIDTH, bottom / height, 0.93 * width / WIDTH, PANEL_HEIGHT / height)
        panel = axes.inset_axes(place)
        lowest = k + ERROR_PANELS_PER_ROW >= len(methods)
        _frame(panel, name, places, reach, numbers=column == 0, named=lowest)
        for color, line in enumerate(lines):
            _draw_line(panel, line, k, (color - (len(lines) - 1) / 2) / max(1, len(lines)), color, reach[1])
    bottom = 0.08 / height
    axes.text(
        (LEFT_MARGIN + across * width / 2) / WIDTH, bottom, title, fontsize=8.5, color=INK, ha="center", va="bottom"
    )
    _draw_key(axes, lines)


def _frame(
    panel: Axes, name: str, places: Sequence[str], reach: tuple[float, float], *, numbers: bool, named: bool
) -> None:
    panel.spines[["top", "right"]].set_visible(False)
    panel.spines[["left", "bottom"]].set_color(MIDDLE_COLOR)
    panel.set(yscale="log", xlim=(-0.6, len(places) - 0.4), ylim=(reach[0], reach[1] * 1.6))
    panel.set_title(name, fontsize=8.5, color=INK, loc="left", pad=3, y=1.0)  # given, it is not looked for
    panel.grid(axis="y", color=FAINT_COLOR, linewidth=0.5)
    panel.set_axisbelow(True)
    panel.set_xticks(range(len(places)), places if named else [""] * len(places))
    rotation = 30 if sum(map(len, places)) > 22 else 0
    panel.tick_params(axis="x", labelsize=6.5, length=2, color=MIDDLE_COLOR, rotation=rotation, pad=1)
    panel.tick_params(axis="y", which="both", labelsize=7, length=0, labelleft=numbers)
    panel.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    panel.minorticks_off()
    if numbers:
        panel.set_ylabel("%", fontsize=7.5, color=INK, labelpad=1, rotation=0)


def _draw_line(panel: Axes, line: ErrorLine, method: int, aside: float, color: int, top: float) -> None:
    """aside: of the middle of the places, so that lines do not cover each other."""
    shade = CURVES[color % len(CURVES)]
    x = np.array(line.places) + RUN_SPREAD * aside
    best = np.where(np.isfinite(line.middle), line.middle, np.inf).min(axis=1)
    _draw_medians(panel, x, best, line.joined, color=MIDDLE_COLOR, linewidth=0.7, linestyle=BEST_DASHES)
    low, middle, high = (part[:, method] for part in (line.low, line.middle, line.high))
    _draw_medians(panel, x, middle, line.joined, color=shade, linewidth=1.2)
    panel.vlines(x, low, np.minimum(high, 10 * top), color=shade, linewidth=3, alpha=0.3)
    for at, errors, links in zip(x, line.errors, line.links, strict=True):
        _draw_runs(panel, at, errors[:, method], links, shade, top)


def _draw_medians(panel: Axes, x: Array, y: Array, joined: bool, **style: Any) -> None:
    y = np.where(np.isfinite(y), y, np.nan)
    if joined:
        panel.plot(x, y, **style)
    else:
        panel.hlines(y, x - RUN_SPREAD / 2, x + RUN_SPREAD / 2, **style)


def _draw_runs(panel: Axes, at: float, errors: Array, links: Sequence[str], color: str, top: float) -> None:
    """Dots, crosses at the top for what is infinite; each leads to its run."""
    count = len(errors)
    x = at + RUN_SPREAD * 0.5 * (np.arange(count) - (count - 1) / 2) / max(1, count)
    for which, marker, size, shade in (
        (np.isfinite(errors), "o", 5, color),
        (~np.isfinite(errors), "x", 9, INK),
    ):
        if which.any():
            y = np.where(np.isfinite(errors), errors, top * 1.3)[which]
            style = {"linewidths": 0} if marker == "o" else {"linewidths": 0.9}
            dots = panel.scatter(x[which], y, s=size, marker=marker, color=shade, clip_on=False, zorder=3, **style)
            if any(links):
                dots.set_urls([links[k] for k in np.flatnonzero(which).tolist()])


def _draw_key(axes: Axes, lines: Sequence[ErrorLine]) -> None:
    named = [line for line in lines if line.name]
    handles = [
        axes.plot([], [], color=CURVES[k % len(CURVES)], linewidth=1.4, marker="o", markersize=3, label=line.name)[0]
        for k, line in enumerate(lines)
        if line.name
    ]
    handles += [
        axes.plot(
            [], [], color=MIDDLE_COLOR, linewidth=0.7, linestyle=(0, (3, 2)), label="smallest median of all methods"
        )[0],
        axes.plot([], [], color=INK, linestyle="", marker="x", markersize=4, label="failed, or not finite")[0],
    ]
    axes.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0.02, 1.0), ncols=min(6, 2 + len(named)), fontsize=8,
        frameon=False, borderpad=0, borderaxespad=0, handletextpad=0.5, columnspacing=1.4,
    )  # fmt: skip


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
        folded=True,
        on=("text", "page") if error == HEADLINE_ERROR else ("page",),
    )
