"""Bias and spread of every base parameter in one scenario: one small panel per method, all on the same axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures.colors import BAR, CURVES, INK, MIDDLE_COLOR
from crosscheck.report.pictures.svg import picture
from crosscheck.study.statistics.summary import MethodSummary
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
    drawn = [part / scale for one in methods for part in (one.parameters.bias, one.parameters.spread)]
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

    panel.set_facecolor("none")
    panel.spines[["top", "right", "bottom"]].set_visible(False)
    panel.spines["left"].set_color(MIDDLE_COLOR)
    panel.set_yscale("symlog", linthresh=MAX_LINEAR_VALUE, linscale=1.0)
    panel.set(xlim=(0, count + 1), ylim=(-reach, reach))
    title = f"{one.method.name}: {one.parameters.biased} biased"
    panel.set_title(title, fontsize=8, color=INK, loc="left", pad=3)
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
    spread = found.spread / scale
    panel.plot(*_strokes(x, -spread, spread), color=BAR, linewidth=2.4, alpha=0.45, solid_capstyle="butt")
    biased = (found.bias_low > 0) | (found.bias_high < 0)
    for which, color in ((~biased, INK), (biased, CURVES[1])):
        at, low, high = x[which], found.bias_low[which] / scale[which], found.bias_high[which] / scale[which]
        panel.plot(*_strokes(at, np.maximum(low, -reach), np.minimum(high, reach)), color=color, linewidth=0.9)
        panel.plot(at, found.bias[which] / scale[which], linestyle="", marker="o", markersize=1.8, mew=0, color=color)


def _strokes(x: Any, low: Any, high: Any) -> tuple[Array, Array]:
    """Upright lines as one curve with gaps, which keeps the page small."""
    gap = np.full(len(x), np.nan)
    return np.column_stack([x, x, gap]).ravel(), np.column_stack([low, high, gap]).ravel()
