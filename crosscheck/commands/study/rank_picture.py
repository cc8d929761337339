"""Mean ranks with their intervals, and the groups within which no method is better than another.

The diagram of Demšar, Journal of Machine Learning Research 7, 2006, upright, so that names stand beside their ranks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures.colors import BAR, CURVES, FAINT_COLOR, INK
from crosscheck.report.pictures.svg import picture
from crosscheck.study.statistics.ranking import Ranking

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, AXIS = 4.1, 0.175, 0.75
"""Sizes of the picture, of one row, of axis and distance [inches]."""

GROUP_DISTANCE = 0.07
"""Distance of the bars of two groups [inches]."""


def study_ranks(key: str, ranking: Ranking, what: str) -> Markup:
    """what: by which error."""
    label = f"Mean ranks by {what}: " + ", ".join(
        f"{name} {mean:.2f}" for name, mean in zip(ranking.methods, ranking.mean, strict=True)
    )
    height = AXIS + ROW * len(ranking.methods)
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, ranking, height))


def _draw(axes: Axes, ranking: Ranking, height: float) -> None:
    count = len(ranking.methods)
    columns = bar_columns(ranking.alike)
    right = 0.12 + GROUP_DISTANCE * (1 + max(columns, default=0))
    axes.set_position((0.34, 0.36 / height, 1 - 0.34 - right / WIDTH, ROW * count / height))
    axes.set_facecolor("none")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set(xlim=(0.5, count + 0.5), ylim=(count, 0))
    y = np.arange(count) + 0.5
    axes.set_yticks(y, ranking.methods, fontsize=8, color=INK)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=7.5, length=2, color=INK)
    axes.hlines(y, 0.5, count + 0.5, color=FAINT_COLOR, linewidth=0.5, zorder=0)
    axes.hlines(y, ranking.low, ranking.high, color=BAR, linewidth=3.5)
    colors = [CURVES[0] if name in ranking.leaders else INK for name in ranking.methods]
    axes.scatter(ranking.mean, y, s=16, color=colors, zorder=3, linewidths=0)
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
