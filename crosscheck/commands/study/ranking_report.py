"""Ranks of methods, and their accuracy against their time, as parts of the report of a study.

Mean ranks are drawn with their intervals, and with the groups within which no methods are apart: the
diagram of Demšar, Journal of Machine Learning Research 7, 2006, upright, so that names stand beside their ranks. Of
accuracy against time, methods than which no other is both faster and more accurate are joined by a line.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.commands.study.words import ERRORS_IN_WORDS, HEADLINE_ERROR, interval_text
from crosscheck.report.pictures.svg import BAR, CURVES, FAINT_COLOR, INK, MIDDLE_COLOR, picture
from crosscheck.report.report import NO_VALUE, Block, Column, Picture, Prose, Row, Table
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, median
from crosscheck.study.statistics.outcomes import Measures
from crosscheck.study.statistics.ranking import Ranking
from crosscheck.study.statistics.summary import StudySummary
from graphdyn.errors import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, ROW, AXIS = 4.1, 0.175, 0.75
"""Sizes of the picture, of one row, of axis and distance [inches]."""

GROUP_DISTANCE = 0.07
"""Distance of the bars of two groups [inches]."""


def study_ranks(key: str, ranking: Ranking, what: str) -> Markup:
    """what: by which error."""
    label = f"Mean ranks by {what}: " + ", ".join(
        f"{name} {mean:.2f}" for name, mean in zip(ranking.methods, ranking.rank.value, strict=True)
    )
    height = AXIS + ROW * len(ranking.methods)
    return picture(key, label, (WIDTH, height), lambda axes: _draw_ranks(axes, ranking, height))


def _draw_ranks(axes: Axes, ranking: Ranking, height: float) -> None:
    count = len(ranking.methods)
    columns = bar_columns(ranking.alike)
    right = 0.12 + GROUP_DISTANCE * (1 + max(columns, default=0))
    axes.set_position((0.34, 0.36 / height, 1 - 0.34 - right / WIDTH, ROW * count / height))
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set(xlim=(0.5, count + 0.5), ylim=(count, 0))
    y = np.arange(count) + 0.5
    axes.set_yticks(y, ranking.methods, fontsize=8, color=INK)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=7.5, length=2, color=INK)
    axes.hlines(y, 0.5, count + 0.5, color=FAINT_COLOR, linewidth=0.5, zorder=0)
    axes.hlines(y, ranking.rank.low, ranking.rank.high, color=BAR, linewidth=3.5)
    colors = [INK if ranking.apart(0, k) else CURVES[0] for k in range(count)]
    axes.scatter(ranking.rank.value, y, s=16, color=colors, zorder=3, linewidths=0)
    axes.set_xlabel("mean rank, 1 is best", fontsize=8, color=INK, labelpad=1)
    for (first, last), column in zip(ranking.alike, columns, strict=True):
        x = 1 + (0.08 + GROUP_DISTANCE * column) / (WIDTH * axes.get_position().width)
        ends = (1 - (first + 0.2) / count, 1 - (last + 0.8) / count)
        axes.plot([x, x], ends, color=INK, linewidth=2.2, transform=axes.transAxes, clip_on=False)
    if ranking.differ:
        at = 1 + 0.12 / (ROW * count)
        reach = min(ranking.distance, count)
        axes.plot(
            [1, 1 + reach], [at, at], color=INK, linewidth=1, marker="|", markersize=5,
            transform=axes.get_xaxis_transform(), clip_on=False,
        )  # fmt: skip
        words = f"critical distance {ranking.distance:.2f}"
        above = at + 0.07 / (ROW * count)
        axes.text(1, above, words, fontsize=7.5, color=INK, va="bottom", transform=axes.get_xaxis_transform())
    else:
        at = 1 + 0.1 / (ROW * count)
        axes.text(0.5, at, "Friedman: no difference", fontsize=7.5, color=INK, transform=axes.get_xaxis_transform())


def bar_columns(groups: list[tuple[int, int]]) -> list[int]:
    """A column for the bar of each group, none of them over another."""
    taken: list[int] = []
    columns = []
    for first, last in groups:
        column = next((k for k, end in enumerate(taken) if end < first), len(taken))
        taken[column : column + 1] = [last]
        columns.append(column)
    return columns


WIDTH, HEIGHT = 7.6, 4.2
"""[inches]"""

OPEN = 1e-30, 1e30
"""Ends in place of zero and infinity, beyond any axis."""

MIN_NAME_DISTANCE = 0.032
"""Least distance of two names, as a part of the height."""


@dataclass(frozen=True)
class Trade:
    """One method: processor time [s] and error relative to the best, with its interval.

    whole: whether it answered on every record
    """

    name: str
    seconds: float
    ratio: float
    low: float
    high: float
    whole: bool


def efficient(trades: Sequence[Trade]) -> list[Trade]:
    """Methods than which no other is faster and as accurate, or as fast and more accurate; fastest first."""
    kept: list[Trade] = []
    for trade in sorted(trades, key=lambda one: (one.seconds, one.ratio)):
        if not kept or trade.ratio < kept[-1].ratio:
            kept.append(trade)
    return kept


def study_pareto(key: str, trades: Sequence[Trade], what: str, best: str) -> Markup:
    """what: error; best: the reference."""
    label = f"{what} relative to {best} against processor time; efficient: " + ", ".join(
        trade.name for trade in efficient(trades)
    )
    return picture(key, label, (WIDTH, HEIGHT), lambda axes: _draw_front(axes, trades, what, best))


def _draw_front(axes: Axes, trades: Sequence[Trade], what: str, best: str) -> None:
    axes.set_position((0.08, 0.11, 0.78, 0.83))
    axes.spines[["top", "right"]].set_visible(False)
    axes.set(xscale="log", yscale="log")
    axes.grid(color=FAINT_COLOR, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.tick_params(which="both", labelsize=8, length=2, color=INK)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
        axis.set_minor_formatter(lambda value, _: "")
    line = efficient(trades)
    axes.step(
        [t.seconds for t in line], [t.ratio for t in line], where="post", color=MIDDLE_COLOR, linewidth=1, zorder=1
    )
    for trade in trades:
        color = CURVES[0] if trade in line else MIDDLE_COLOR
        axes.vlines(trade.seconds, max(trade.low, OPEN[0]), min(trade.high, OPEN[1]), color=color, linewidth=1.2)
        fill = color if trade.whole else "none"
        axes.plot(trade.seconds, trade.ratio, marker="o", markersize=5, mfc=fill, mec=color, linestyle="")
    axes.set_xlabel("processor time, median [s]", fontsize=8.5, color=INK)
    axes.set_ylabel(f"{what} / that of {best}", fontsize=8.5, color=INK)
    values = [value for trade in trades for value in (trade.low, trade.ratio, trade.high)]
    ends = [value for value in values if np.isfinite(value) and value > 0]
    times = [trade.seconds for trade in trades]
    axes.set(xlim=(min(times) / 1.5, 1.5 * max(times)), ylim=(min(ends) / 1.2, 1.2 * max(ends)))
    _name(axes, trades, line)


def _name(axes: Axes, trades: Sequence[Trade], line: Sequence[Trade]) -> None:
    """Names to the right of their points, moved up or down until none is over another, with a thin line back."""
    to_axes = axes.transData + axes.transAxes.inverted()
    at = {trade.name: to_axes.transform((trade.seconds, trade.ratio)) for trade in trades}
    placed: list[tuple[float, float, float]] = []
    for trade in sorted(trades, key=lambda one: at[one.name][1]):
        x, y = at[trade.name]
        wide = 0.0125 * len(trade.name)
        beside = [other for other in placed if other[0] < x + 0.015 + wide and x < other[0] + other[2]]
        height = y + 0.6 * MIN_NAME_DISTANCE
        while any(abs(other[1] - height) < MIN_NAME_DISTANCE for other in beside):
            height += MIN_NAME_DISTANCE / 4
        placed.append((x, height, 0.015 + wide))
        style: dict[str, Any] = {"color": INK if trade in line else MIDDLE_COLOR, "transform": axes.transAxes}
        if height - y > MIN_NAME_DISTANCE:
            axes.plot([x, x + 0.006], [y, height], **style | {"color": MIDDLE_COLOR}, linewidth=0.5, zorder=0)
        axes.text(x + 0.008, height, trade.name, fontsize=7.5, va="center", **style)


RANKING_NOTE = (
    "In every run the method with the smallest error has rank 1, by the geometric mean over the scenarios; errors that "
    "are equal up to rounding share a rank, and methods that failed in some scenario share the last one. Bars: "
    "Student's {level:.0%} intervals of the mean rank over the runs. Thick lines join methods whose mean ranks are "
    "closer than Nemenyi's critical distance, or all where Friedman's test finds no difference. Blue: not apart from "
    "the first. This is a picture: which of two methods is better is decided by their comparison above, in which no "
    "other method takes part."
)
TRADE_OFF_NOTE = (
    "Geometric mean of the error relative to the reference over the runs in which both have all answers, with its "
    "simultaneous {level:.0%} interval; median processor time of all runs. Hollow: failed in some run, which is not in "
    "this mean. The line joins methods than which no other is faster and more accurate."
)


def ranks(rankings: dict[str, Ranking]) -> Iterator[Block]:
    """Ranks of the methods of one class by every error."""
    for error, ranking in rankings.items():
        what = ERRORS_IN_WORDS[error]
        yield Picture(partial(study_ranks, ranking=ranking, what=what), title=f"By {what}", wide=False, on=("page",))
    yield Prose(RANKING_NOTE.format(level=CONFIDENCE_LEVEL), soft=True, on=("page",))
    first = next(iter(rankings.values()))
    of = {error: {name: k for k, name in enumerate(ranking.methods)} for error, ranking in rankings.items()}
    rows = []
    for name in first.methods:
        cells = [interval_text(ranking.rank[of[error][name]], ".2f") for error, ranking in rankings.items()]
        rows.append(Row((name, *cells, first.failures[of[next(iter(rankings))][name]] or None)))
    tested = ", ".join(
        f"by {ERRORS_IN_WORDS[error]} p = {ranking.probability:.2g}"
        for error, ranking in rankings.items()
        if ranking.probability is not None
    )
    yield Table(
        (
            Column("method", "name"),
            *(Column(f"rank by {ERRORS_IN_WORDS[error]}", "number") for error in rankings),
            Column("failed", "number", meaning="runs in which it ranks last"),
        ),
        tuple(rows),
        caption=f"{counted(first.runs, 'run')}; critical distance {first.distance:.2f}; Friedman: {tested or NO_VALUE}",
        on=("page",),
    )


def trades(found: StudySummary, measures: Measures) -> Iterator[Block]:
    """Accuracy of the methods that measure this, against their time."""
    names = [found.outcomes.methods[k].name for k in found.methods(measures)]
    for (of, error), comparison in found.comparisons.items():
        if of != measures:
            continue
        every = [
            Trade(name, _median_time(found, name), ratio.value, ratio.low, ratio.high, _whole(found, name, error))
            for name in names
            for ratio in [comparison.ratio(name)]
        ]
        drawn = [trade for trade in every if np.isfinite(trade.ratio) and trade.seconds > 0]
        if drawn:
            what, best = ERRORS_IN_WORDS[error], comparison.reference
            draw = partial(study_pareto, trades=drawn, what=what, best=best)
            yield Picture(draw, title=f"By {what}", on=("page",), folded=error != HEADLINE_ERROR)
    yield Prose(TRADE_OFF_NOTE.format(level=CONFIDENCE_LEVEL), soft=True, on=("page",))


def _whole(found: StudySummary, method: str, error: str) -> bool:
    """Whether it has an answer for every record that it took part in."""
    k = [one.name for one in found.outcomes.methods].index(method)
    taken = [scenario for scenario in found.outcomes.scenarios if scenario.taken[k]]
    return all(bool(np.isfinite(scenario.errors[error][:, k]).all()) for scenario in taken)


def _median_time(found: StudySummary, method: str) -> float:
    """Over all records that it took part in [s]."""
    k = [one.name for one in found.outcomes.methods].index(method)
    seconds = np.concatenate([scenario.seconds[:, k] for scenario in found.outcomes.scenarios])
    return median(seconds[~np.isnan(seconds)]).value
