"""Standard deviations that a motion promises, parameter by parameter, beside those of other motions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.exciting.excited import Excited
from crosscheck.report.pictures.colors import BAR, CURVES, FAINT, INK
from crosscheck.report.pictures.svg import picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, AXIS = 7.6, 0.165, 0.95
"""Of the picture, of one row, of axis and key [inches]."""

LONGEST = 30
"""Characters of a name; the table has the whole one."""

FARTHEST = 1e4
"""[%] Where the axis ends at most: beyond, nothing is determined."""


def sigma_bars(key: str, found: Excited) -> Markup:
    count = len(found.plan.sigma)
    label = f"Standard deviations of {count} base parameters, in percent of their size, beside other motions"
    height = ROW * count + AXIS
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, found, height))


def _draw(axes: Axes, found: Excited, height: float) -> None:
    plan = found.plan
    count = len(plan.sigma)
    size = np.maximum(np.abs(plan.prior), plan.spread)
    own = 100 * plan.relative
    others = [
        (words, 100 * other.sigma / size, marker, color)
        for words, other, marker, color in (
            (f"best of {found.random} random", found.best_random, "o", CURVES[1]),
            ("median random", found.median_random, "x", CURVES[2]),
            ("recorded", found.recorded, "s", CURVES[3]),
        )
        if other is not None
    ]
    there = np.concatenate([own, *(values for _, values, _, _ in others)])
    there = there[np.isfinite(there)]
    reach = (there.min() / 2, min(2 * there.max(), FARTHEST)) if there.size else (1.0, FARTHEST)
    y = np.arange(count) + 0.5
    axes.set_position((0.3, 0.48 / height, 0.68, ROW * count / height))
    axes.set_facecolor("none")
    axes.spines[:].set_visible(False)
    axes.set(xscale="log", xlim=reach, ylim=(count, 0))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_yticks(y, [_short(name) for name in plan.names], fontsize=8, color=INK)
    axes.tick_params(length=0, labelsize=8)
    axes.grid(axis="x", color=FAINT, linewidth=0.5)
    axes.set_axisbelow(True)
    left = reach[0]
    axes.barh(y, np.minimum(own, reach[1]) - left, left=left, height=0.6, color=BAR, label="this motion")
    for words, values, marker, color in others:
        hollow = "none" if marker != "x" else color
        axes.plot(values, y, linestyle="", marker=marker, markersize=4.5, mfc=hollow, mec=color, mew=1.1, label=words)
    axes.set_xlabel("σ [% of the parameter's size]", fontsize=9, color=INK)
    axes.legend(
        loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, fontsize=8.5, frameon=False, handletextpad=0.4,
        columnspacing=1.4,
    )  # fmt: skip


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
