"""A plot in its two forms: data for the script of the page, and a static picture for print or without script."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, MIDDLE_COLOR, picture
from crosscheck.report.plain_text import printable, superscript
from crosscheck.report.report import Panel, Plot, Series
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT = 7.6, 2.3
"""Sizes of the static picture, and of a panel of height 1 [inches]."""

TITLES, LEFT, RIGHT = 0.55, 0.09, 0.66
"""Room above a panel and below it [inches]; edges of the axes, as parts of the width: the names stand on the right."""

MAX_TICKS = 9
"""Largest number of ticks of a logarithmic axis of x, which are at its values."""

MAX_MARKED_POINTS = 60
"""Points up to which those of a line are marked, as in page/plots.js."""

MAX_STATIC_POINTS = 350
"""Largest number of points of a static curve, each with the smallest and the largest of the values it stands for."""


MAX_ZOOM_POINTS = 6000
"""Largest number of points of a curve that can be zoomed, thinned in the same way."""

PAGE, AXES = 4_400_000, 13_500
"""Characters that the plots of a page have in all, and of the axes of a static panel."""

SCRIPT_SHARE = 0.6
"""Part of what the axes leave that goes to the data for the script; the rest goes to the static curves."""

NUMBER, POINT = 16 / 3, 45
"""Characters of a number of single precision as base64, and of a point of a curve in an <svg>."""


def samples_per_curve(plots: Sequence[Plot]) -> int:
    """How many samples each curve of a page can have for the script."""
    numbers = _curves(plots) + 2 * len(plots)  # x has double precision
    return min(MAX_ZOOM_POINTS, int(SCRIPT_SHARE * _characters(plots) / (NUMBER * max(1, numbers))))


def points_per_curve(plots: Sequence[Plot]) -> int:
    """The same of the static pictures; two values are drawn for each of these points."""
    return min(MAX_STATIC_POINTS, int((1 - SCRIPT_SHARE) * _characters(plots) / (2 * POINT * max(1, _curves(plots)))))


def _characters(plots: Sequence[Plot]) -> int:
    """Characters of all curves of a page; a quarter of PAGE at least."""
    return max(PAGE // 4, PAGE - AXES * sum(len(plot.panels) for plot in plots))


def _curves(plots: Sequence[Plot]) -> int:
    return sum(len(panel.series) for plot in plots for panel in plot.panels)


def plot_data(plot: Plot, samples: int = MAX_ZOOM_POINTS) -> Markup:
    """JSON for page/plots.js; numbers as base64, those of x of double precision, the others of single precision.

    samples: of a curve, at most; longer ones are thinned, all of a plot to the same rows
    """
    rows = _rows(plot, samples)
    data = {
        "x": b64encode(np.asarray(plot.x[rows], dtype="<f8").tobytes()).decode(),
        "x_title": printable(plot.x_title),
        "log_x": plot.log_x,
        "upright": plot.upright,
        "panels": _data(plot.panels, rows),
    }
    return Markup(json.dumps(data).replace("<", "\\u003c"))


def _data(value: Any, rows: NDArray[np.intp]) -> Any:
    """Panels and series as JSON has them, by the names of their fields; of curves (N,) these rows."""
    if isinstance(value, Panel | Series):
        return {field.name: _data(getattr(value, field.name), rows) for field in fields(value)}
    if isinstance(value, tuple):
        return [_data(item, rows) for item in value]
    if isinstance(value, np.ndarray):
        return _numbers(value[rows])
    return printable(value) if isinstance(value, str) else value


def plot_picture(key: str, plot: Plot, points: int = MAX_STATIC_POINTS) -> Markup:
    """The same curves, thinned to the smallest and largest value of so many parts, as an <svg>."""
    height = sum(HEIGHT * panel.height + TITLES for panel in plot.panels)
    return picture(key, plot.label, (WIDTH, height), lambda axes: _draw(axes, plot, height, points))


def thinned(y: Array, points: int = MAX_STATIC_POINTS) -> NDArray[np.intp]:
    """Rows at which a curve (N,) takes the smallest and the largest value of every part, in order; gaps are kept."""
    if len(y) <= 2 * points:
        return np.arange(len(y))
    rows: list[int] = []
    for part in np.array_split(np.arange(len(y)), points):
        values = y[part]
        if np.isnan(values).all():
            rows.append(int(part[0]))
            continue
        rows += sorted({int(part[np.nanargmin(values)]), int(part[np.nanargmax(values)])})
        gaps = part[np.isnan(values)]
        rows += [int(gaps[0])] if gaps.size else []
    return np.unique(rows)


def _rows(plot: Plot, samples: int) -> NDArray[np.intp]:
    """All of x, or those at which some curve is smallest or largest among its neighbors."""
    if len(plot.x) <= samples:
        return np.arange(len(plot.x))
    curves = [one.y for panel in plot.panels for one in panel.series]
    points = max(1, samples // (2 * len(curves)))
    return np.unique(np.concatenate([thinned(y, points) for y in curves]))


def _numbers(values: Array) -> str:
    with np.errstate(over="ignore"):
        return b64encode(np.asarray(values, dtype="<f4").tobytes()).decode()


def _draw(axes: Axes, plot: Plot, height: float, points: int) -> None:
    axes.set_axis_off()
    top = height
    for k, panel in enumerate(plot.panels):
        bottom = top - HEIGHT * panel.height - TITLES
        place = (LEFT, (bottom + 0.6 * TITLES) / height, RIGHT - LEFT, HEIGHT * panel.height / height)
        _draw_panel(axes.inset_axes(place), plot, panel, points, last=k == len(plot.panels) - 1)
        top = bottom


def _draw_panel(axes: Axes, plot: Plot, panel: Panel, points: int, *, last: bool) -> None:
    axes.set_facecolor("none")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8, length=2, color=INK)
    axes.set(xscale="log" if plot.log_x else "linear", yscale="log" if panel.log else "linear")
    axes.grid(color=FAINT_COLOR, linewidth=0.5)
    _label_ticks(axes, plot, panel)
    if panel.level is not None:
        axes.axhline(panel.level, color=INK, linewidth=0.8, linestyle=(0, (3, 2)))
    if plot.upright is not None:
        axes.axvline(plot.upright, color=MIDDLE_COLOR, linewidth=1)
    for one in panel.series:
        if not one.hidden:
            _draw_series(axes, plot, one, panel.log, points)
    axes.set_title(panel.heading, fontsize=8.5, color=INK, loc="left", y=1.0)  # given, it is not looked for
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), fontsize=8, frameon=False, borderpad=0)
    if last:
        axes.set_xlabel(plot.x_title, fontsize=8.5, color=INK, labelpad=1)


def _label_ticks(axes: Axes, plot: Plot, panel: Panel) -> None:
    """Numbers as on the interactive plot: matplotlib would write powers of ten as formulas."""
    from matplotlib.ticker import EngFormatter, FuncFormatter, NullFormatter

    if panel.prefixes:
        axes.yaxis.set_major_formatter(EngFormatter(panel.unit))
    elif panel.log:
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: superscript(round(np.log10(y)))))
    if panel.log:
        axes.yaxis.set_minor_formatter(NullFormatter())
    if plot.log_x:
        values = np.unique(plot.x)
        axes.set_xticks(values[:: 1 + len(values) // MAX_TICKS], minor=False)
        axes.set_xticks([], minor=True)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))


def _draw_series(axes: Axes, plot: Plot, one: Series, log: bool, points: int) -> None:
    y = np.where(one.y > 0, one.y, np.nan) if log else one.y
    rows = thinned(y, points)
    if plot.log_x and one.style != "marks":
        rows = rows[~np.isnan(y[rows])]
    x, color = plot.x[rows], CURVES[one.color % len(CURVES)]
    if one.style == "marks":
        axes.plot(x, y[rows], linestyle="", marker="o", markersize=3, color=color, label=one.name)
    else:
        dash = (0, (4, 1.4)) if one.style == "dashed" else "-"
        marker = "o" if len(plot.x) <= MAX_MARKED_POINTS else ""
        axes.plot(x, y[rows], linestyle=dash, linewidth=1.3, marker=marker, markersize=3, color=color, label=one.name)
    if one.low is not None and one.high is not None:
        axes.vlines(x, one.low[rows], one.high[rows], color=color, linewidth=0.8)
