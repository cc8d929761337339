"""Accuracy against time: methods than which no other is both faster and more accurate are joined by a line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from crosscheck.report.pictures.colors import CURVES, FAINT_COLOR, INK, MIDDLE_COLOR
from crosscheck.report.pictures.svg import picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT = 7.6, 4.2
"""[inches]"""

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
    """what: error; best: the method that all are compared with."""
    label = f"{what} relative to {best} against processor time; efficient: " + ", ".join(
        trade.name for trade in efficient(trades)
    )
    return picture(key, label, (WIDTH, HEIGHT), lambda axes: _draw(axes, trades, what, best))


def _draw(axes: Axes, trades: Sequence[Trade], what: str, best: str) -> None:
    axes.set_position((0.08, 0.11, 0.78, 0.83))
    axes.set_facecolor("none")
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
        axes.vlines(trade.seconds, trade.low, trade.high, color=color, linewidth=1.2)
        fill = color if trade.whole else "none"
        axes.plot(trade.seconds, trade.ratio, marker="o", markersize=5, mfc=fill, mec=color, linestyle="")
    axes.set_xlabel("processor time, median [s]", fontsize=8.5, color=INK)
    axes.set_ylabel(f"{what} / that of {best}", fontsize=8.5, color=INK)
    ends = [value for trade in trades for value in (trade.low, trade.ratio, trade.high) if value > 0]
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
