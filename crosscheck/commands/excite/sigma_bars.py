"""Standard deviations that a motion promises, parameter by parameter, beside those of other motions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.exciting.excited import Excited
from crosscheck.report.pictures.parameter_rows import put_key, put_rows, size
from crosscheck.report.pictures.svg import BAR, CURVES, FAINT_COLOR, INK, picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_AXIS_PERCENT = 1e4
"""[%] Largest end of the axis: beyond, nothing is determined."""


def sigma_bars(key: str, found: Excited) -> Markup:
    count = len(found.plan.sigma)
    label = f"Standard deviations of {count} base parameters, in percent of their size, beside other motions"
    return picture(key, label, size(count), lambda axes: _draw(axes, found))


def _draw(axes: Axes, found: Excited) -> None:
    plan = found.plan
    scale = np.maximum(np.abs(plan.prior), plan.spread)
    own = 100 * plan.relative
    others = [
        (words, 100 * other.sigma / scale, marker, color)
        for words, other, marker, color in (
            (f"best of {found.random} random", found.best_random, "o", CURVES[1]),
            ("median random", found.median_random, "x", CURVES[2]),
            ("recorded", found.recorded, "s", CURVES[3]),
        )
        if other is not None
    ]
    there = np.concatenate([own, *(values for _, values, _, _ in others)])
    there = there[np.isfinite(there)]
    reach = (there.min() / 2, min(2 * there.max(), MAX_AXIS_PERCENT)) if there.size else (1.0, MAX_AXIS_PERCENT)
    axes.set(xscale="log", xlim=reach)
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    put_rows(axes, plan.names)
    axes.tick_params(labelsize=8)
    axes.grid(axis="x", color=FAINT_COLOR, linewidth=0.5)
    axes.set_axisbelow(True)
    y = np.arange(len(plan.sigma)) + 0.5
    left = reach[0]
    axes.barh(y, np.minimum(own, reach[1]) - left, left=left, height=0.6, color=BAR, label="this motion")
    for words, values, marker, color in others:
        hollow = "none" if marker != "x" else color
        axes.plot(values, y, linestyle="", marker=marker, markersize=4.5, mfc=hollow, mec=color, mew=1.1, label=words)
    axes.set_xlabel("σ [% of the parameter's size]", fontsize=9, color=INK)
    put_key(axes, 4)
