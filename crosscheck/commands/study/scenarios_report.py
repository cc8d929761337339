"""The scenarios of a study one by one: errors, bias and spread of the parameters, and every run.

Bias and spread of every base parameter in one scenario are one small panel per method, all on the same axes.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.commands.study.words import METHOD_CLASSES, SOURCES_IN_WORDS, interval_text, percent_text
from crosscheck.report.pictures.svg import BAR, CURVES, INK, MIDDLE_COLOR, picture
from crosscheck.report.plain_text import time_text
from crosscheck.report.report import Block, Code, Column, Facts, Group, Hover, Picture, Prose, Row, Section, Table
from crosscheck.study.settings.design import SOURCES
from crosscheck.study.statistics.grid import Grid, with_unit
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL
from crosscheck.study.statistics.outcomes import ERRORS, ScenarioOutcomes
from crosscheck.study.statistics.ranking import record_ranks
from crosscheck.study.statistics.summary import MethodSummary, StudySummary
from graphdyn.errors import counted
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, PANEL, TITLE, LEFT, EDGE = 7.6, 1.0, 0.3, 0.5, 0.4
"""Sizes of the picture, height of a panel, of what is above it, room on the left and below [inches]."""

PARAMETER_PANELS_PER_ROW = 4
"""Panels beside each other."""

MAX_LINEAR_VALUE = 1.0
"""Up to here the axis is linear, beyond logarithmic."""


def study_parameters(key: str, methods: Sequence[MethodSummary], scale: Array, unit: str) -> Markup:
    """scale: a parameter's bias and spread are drawn as parts of it (b,); unit: what the parts are, in words."""
    label = "Bias and spread of the base parameters: " + ", ".join(
        f"{one.method.name} {one.parameters.biased} biased" for one in methods
    )
    height = -(-len(methods) // PARAMETER_PANELS_PER_ROW) * (PANEL + TITLE) + EDGE
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, methods, scale, unit, height))


def _draw(axes: Axes, methods: Sequence[MethodSummary], scale: Array, unit: str, height: float) -> None:
    axes.set_axis_off()
    width = (WIDTH - LEFT) / PARAMETER_PANELS_PER_ROW
    drawn = [part / scale for one in methods for part in (one.parameters.bias.value, one.parameters.spread.value)]
    finite = np.concatenate(drawn)
    reach = 1.3 * max(MAX_LINEAR_VALUE, float(np.abs(finite[np.isfinite(finite)]).max(initial=0.0)))
    for k, one in enumerate(methods):
        row, column = divmod(k, PARAMETER_PANELS_PER_ROW)
        bottom = height - (row + 1) * (PANEL + TITLE)
        place = ((LEFT + column * width) / WIDTH, bottom / height, 0.94 * width / WIDTH, PANEL / height)
        panel = axes.inset_axes(place)
        _frame(panel, one, len(scale), reach, numbers=column == 0, named=k + PARAMETER_PANELS_PER_ROW >= len(methods))
        _draw_method(panel, one, scale, reach)
    axes.text(0, 1 - (TITLE + PANEL / 2) / height, unit, fontsize=7.5, color=INK, rotation=90, va="center", ha="left")


def _frame(panel: Axes, one: MethodSummary, count: int, reach: float, *, numbers: bool, named: bool) -> None:
    from matplotlib.ticker import FixedLocator, NullLocator

    panel.spines[["top", "right", "bottom"]].set_visible(False)
    panel.spines["left"].set_color(MIDDLE_COLOR)
    panel.set_yscale("symlog", linthresh=MAX_LINEAR_VALUE, linscale=1.0)
    panel.set(xlim=(0, count + 1), ylim=(-reach, reach))
    title = f"{one.method.name}: {one.parameters.biased} biased"
    panel.set_title(title, fontsize=8, color=INK, loc="left", pad=3, y=1.0)
    decades = [10.0**k for k in range(int(np.floor(np.log10(reach))) + 1)]
    ticks = [*(-y for y in reversed(decades)), 0.0, *decades]
    panel.yaxis.set_major_locator(FixedLocator(ticks if len(ticks) < 8 else [ticks[0], -1.0, 0.0, 1.0, ticks[-1]]))
    panel.yaxis.set_minor_locator(NullLocator())
    panel.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    panel.tick_params(axis="y", labelsize=7, length=0, labelleft=numbers)
    panel.tick_params(axis="x", labelsize=7, length=2, color=MIDDLE_COLOR, labelbottom=named, pad=1)
    panel.axhline(0, color=MIDDLE_COLOR, linewidth=0.6)
    if named:
        panel.set_xlabel("number of the parameter", fontsize=7.5, color=INK, labelpad=1)


def _draw_method(panel: Axes, one: MethodSummary, scale: Array, reach: float) -> None:
    """Pale bars: ± the spread; dots: the bias, upright lines: its interval, red where it does not have zero in it."""
    found = one.parameters
    x = np.arange(len(scale)) + 1.0
    spread = found.spread.value / scale
    panel.plot(*_strokes(x, -spread, spread), color=BAR, linewidth=2.4, alpha=0.45, solid_capstyle="butt")
    biased = (found.bias.low > 0) | (found.bias.high < 0)
    for which, color in ((~biased, INK), (biased, CURVES[1])):
        at, low, high = x[which], found.bias.low[which] / scale[which], found.bias.high[which] / scale[which]
        panel.plot(*_strokes(at, np.maximum(low, -reach), np.minimum(high, reach)), color=color, linewidth=0.9)
        panel.plot(
            at, found.bias.value[which] / scale[which], linestyle="", marker="o", markersize=1.8, mew=0, color=color
        )


def _strokes(x: Any, low: Any, high: Any) -> tuple[Array, Array]:
    """Upright lines as one curve with gaps, which keeps the page small."""
    gap = np.full(len(x), np.nan)
    return np.column_stack([x, x, gap]).ravel(), np.column_stack([low, high, gap]).ravel()


MAX_RUNS, MAX_DETAILED_SCENARIOS = 120, 8
"""Runs that a page has one by one, in all; scenarios of which it has the parameters."""

ZERO_VALUE = 1e-12
"""True values below this are zeros that were rounded [kg, m, N, s]."""

BIAS_NOTE = (
    "Dots: mean of found minus true, with its {level:.0%} interval; red where zero is outside, which happens to one "
    "parameter in twenty without any bias. Pale bars: ± standard deviation over the runs. All as parts of the standard "
    "deviation that is usual for the parameter, the median over the methods. Linear up to 1, logarithmic beyond. Where "
    "runs have CAD models of their own, a method that draws parameters towards them has no bias: read z, which grows."
)


@dataclass(frozen=True)
class ShownRuns:
    """The first runs of every scenario are on the page."""

    each: int

    def key(self, scenario: int, row: int) -> str | None:
        """Anchor of a run; None where it is not on the page."""
        return f"run-{scenario + 1}-{row}" if row < self.each else None

    def every(self, found: StudySummary) -> Iterator[tuple[int, int, str]]:
        """Numbers of scenario and run, and the anchor, of all that are on the page."""
        for number, scenario in enumerate(found.outcomes.scenarios):
            for row, run in enumerate(scenario.runs[: self.each]):
                yield number, int(run), f"run-{number + 1}-{row}"


def shown_runs(found: StudySummary) -> ShownRuns:
    return ShownRuns(max(1, MAX_RUNS // len(found.scenarios)))


def scenario_sections(
    found: StudySummary, grid: Grid, on_page: ShownRuns, repeat: Callable[[str, int], Sequence[str]]
) -> Iterator[Section]:
    """Sections of the scenarios in the order of the grid; the first ones with their parameters."""
    for place, number in enumerate(grid.order()):
        scenario = found.scenarios[number]
        outcomes = scenario.outcomes
        in_order = [
            scenario.methods[k] for measures in METHOD_CLASSES for k in found.methods(measures) if outcomes.taken[k]
        ]
        blocks: list[Block] = [_axes(outcomes), _results(outcomes, in_order)]
        if place < MAX_DETAILED_SCENARIOS:
            blocks += _parameters(outcomes, in_order)
        if outcomes.redrawn:
            blocks.append(_sources(in_order))
        blocks.append(_runs(number, outcomes, found, on_page, repeat))
        yield Section(f"scenario-{number + 1}", f"Scenario: {grid.words(outcomes)}", tuple(blocks))


def _axes(outcomes: ScenarioOutcomes) -> Facts:
    said = [(axis.replace("_", " "), with_unit(axis, value)) for axis, value in outcomes.axes.items()]
    return Facts((*said, ("name", outcomes.name)), title="Settings", folded=True, on=("page",))


def _results(outcomes: ScenarioOutcomes, methods: Sequence[MethodSummary]) -> Table:
    rows, before = [], None
    for one in methods:
        cells = (
            one.method.name,
            METHOD_CLASSES[one.method.measures][1],
            *(percent_text(one.errors[error]) for error in ERRORS),
            f"{one.parameters.biased} of {len(outcomes.truth)}" if one.found > 1 else None,
            _median(one.parameters.z),
            percent_text(one.consistent),
            percent_text(one.failed),
            one.iterations[0],
            one.seconds.value,
        )
        rows.append(Row(cells, rule=before not in (None, one.method.measures)))
        before = one.method.measures
    return Table(
        (
            Column("method", "name"),
            Column("measured"),
            Column("parameters", "number", "%", meaning="relative distance of the base parameters, median"),
            Column("torque", "number", "%", meaning="of another motion, median"),
            Column("trajectory", "number", "%", meaning="of the simulated closed loop, median"),
            Column("biased", "number", meaning="parameters whose interval of the bias does not have zero in it"),
            Column(
                "z",
                "number",
                form=".2f",
                meaning="(x − x*) / σ as stated, root mean square; median over x; 1 is honest",
            ),
            Column("real bodies", "number", "%"),
            Column("failed", "number", "%"),
            Column("iterations", "number", form=".3g", meaning="median"),
            Column("time", "number", form=time_text, meaning="median of the processor time"),
        ),
        tuple(rows),
        caption=f"{counted(len(outcomes.runs), 'run')}; medians and shares with {CONFIDENCE_LEVEL:.0%} intervals",
        on=("page",),
    )


def _median(values: Array) -> float | None:
    values = values[np.isfinite(values)]
    return float(np.median(values)) if len(values) else None


def _sources(methods: Sequence[MethodSummary]) -> Table:
    """The parts of noise, motion, CAD model and start in the scatter of the parameters."""
    drawn = {source for one in methods for source in one.parameters.shares}
    sources = [source for source in SOURCES if source in drawn]
    rows = []
    for one in methods:
        shares = [_median(100 * one.parameters.shares[source]) for source in sources]
        with np.errstate(divide="ignore", invalid="ignore"):
            held = _median(one.parameters.held_bias / one.parameters.spread.value)
        rows.append(Row((one.method.name, *shares, held)))
    return Table(
        (
            Column("method", "name"),
            *(Column(SOURCES_IN_WORDS[source], "number", "%", ".2g") for source in sources),
            Column("held bias / spread", "number", form=".2f", meaning="for one motion and one CAD model"),
        ),
        tuple(rows),
        title="Sources of the scatter",
        caption="median over the parameters of the part of their variance that is drawn anew with each source",
        on=("page",),
    )


def _parameters(outcomes: ScenarioOutcomes, methods: Sequence[MethodSummary]) -> Iterator[Block]:
    answered = [one for one in methods if one.found > 1]
    if not answered:
        return
    usual = np.median([one.parameters.spread.value for one in answered], axis=0)
    usual = np.where(usual > 0, usual, 1.0)
    for measures, (title, _) in METHOD_CLASSES.items():
        of_class = [one for one in answered if one.method.measures == measures]
        if of_class:
            draw = partial(study_parameters, methods=of_class, scale=usual, unit="parts of the usual spread")
            caption = BIAS_NOTE.format(level=CONFIDENCE_LEVEL)
            yield Picture(draw, caption, title=f"{title}: bias and spread of the parameters", on=("page",))
    tables = tuple(_parameter_table(outcomes, answered, what) for what in ("bias", "spread"))
    yield Group(tables, title="Bias and spread in numbers", folded=True, on=("page",))


def _parameter_table(outcomes: ScenarioOutcomes, methods: Sequence[MethodSummary], what: str) -> Table:
    def cell(one: MethodSummary, k: int) -> Hover:
        found = getattr(one.parameters, what)[k]
        return Hover(found.value, interval_text(found, ".3g"))

    rows = [
        Row((name, outcomes.base_units[k], outcomes.truth[k], *(cell(one, k) for one in methods)))
        for k, name in enumerate(outcomes.base_names)
    ]
    words = {"bias": "mean of found minus true", "spread": "standard deviation over the runs"}[what]
    return Table(
        (
            Column("base parameter", "name"),
            Column("unit"),
            Column("true", "number", form=lambda value: f"{value:.4g}" if abs(value) > ZERO_VALUE else "0"),
            *(Column(one.method.name, "number", form=".2g") for one in methods),
        ),
        tuple(rows),
        title=what.capitalize(),
        caption=f"{words}; its {CONFIDENCE_LEVEL:.0%} interval where the pointer rests",
    )


def _runs(
    number: int,
    outcomes: ScenarioOutcomes,
    found: StudySummary,
    on_page: ShownRuns,
    repeat: Callable[[str, int], Sequence[str]],
) -> Group:
    """One folded table per run, where links lead."""
    methods = [(method.name, method.measures) for method in found.outcomes.methods]
    ranks: dict[int, Array] = {}
    for measures in METHOD_CLASSES:
        columns = [k for k in found.methods(measures) if outcomes.taken[k]]
        ranks |= dict(zip(columns, record_ranks(outcomes.errors["torque_error"][:, columns]).T, strict=True))
    groups: list[Block] = []
    for row, run in enumerate(outcomes.runs[: on_page.each]):
        table = _run_table(outcomes, row, methods, {k: of[row] for k, of in ranks.items()})
        failed = int((outcomes.taken & ~outcomes.found[row]).sum())
        title = f"run {run}{f': {failed} failed' if failed else ''}"
        command = Code(shlex.join(repeat(outcomes.name, int(run))))
        groups.append(Group((table, command), title=title, folded=True, key=on_page.key(number, row) or ""))
    left = len(outcomes.runs) - len(groups)
    more = (Prose(f"results.parquet has {left} more.", soft=True),) if left > 0 else ()
    return Group((*groups, *more), title="Runs", on=("page",))


def _run_table(
    outcomes: ScenarioOutcomes, row: int, methods: Sequence[tuple[str, str]], ranks: dict[int, float]
) -> Table:
    rows = []
    for k in ranks:
        name, measures = methods[k]
        numbers: list[Array] = [outcomes.errors[error] for error in ERRORS]
        errors = [100 * float(values[row, k]) if outcomes.found[row, k] else None for values in numbers]
        real = outcomes.consistent[row, k]
        rows.append(
            Row(
                (
                    name, measures, *errors, ranks[k], None if np.isnan(real) else "yes" if real else "no",
                    outcomes.iterations[row, k], outcomes.seconds[row, k], outcomes.reasons.get((row, k), ""),
                ),
                "plain" if outcomes.found[row, k] else "disagrees",
            )
        )  # fmt: skip
    return Table(
        (
            Column("method", "name"),
            Column("measured"),
            Column("parameters", "number", "%", ".3g"),
            Column("torque", "number", "%", ".3g"),
            Column("trajectory", "number", "%", ".3g"),
            Column("rank", "number", form="g", meaning="by torque error, among those that measure the same"),
            Column("real bodies"),
            Column("iterations", "number", form="g"),
            Column("time", "number", form=time_text),
            Column("failed because"),
        ),
        tuple(rows),
        failures_first=False,
    )
