"""How errors are distributed over the states: one histogram per row, on a common logarithmic axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures.svg import BAR, CURVES, FAINT_COLOR, INK, picture
from crosscheck.report.plain_text import superscript
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MIN_DRAWN_SPREAD = 1e-22
"""Errors below this, and not zero, are drawn here."""

BINS_PER_DECADE = 4
MAX_TICKS = 9
MIN_TICK_DISTANCE = 0.3
"""A tick nearer to that of zero than this part of the step is left out."""

FULLEST_BIN_HEIGHT = 0.78
"""Height of the fullest bin, in rows; no occupied bin is lower than MIN_BIN_HEIGHT."""
MIN_BIN_HEIGHT = 0.06

WIDTH, ROW, AXIS = 7.6, 0.235, 0.62
"""Sizes of the picture, of one row, of what the axis needs [inches]."""

TITLE_DISTANCE = 3.5
"""Distance of the name of a row from the axes [points]."""

WITHIN_COLOR, BEYOND_COLOR = BAR, CURVES[1]


@dataclass(frozen=True, eq=False)
class SpreadRow:
    """errors: relative, of all states (N,), zero, infinite or NaN among them; bound: what they must not exceed"""

    name: str
    errors: Array
    bound: float

    @property
    def largest(self) -> float:
        """NaN counts as infinite."""
        return float(np.where(np.isnan(self.errors), np.inf, self.errors).max())

    @property
    def agrees(self) -> bool:
        return self.largest <= self.bound


@dataclass(frozen=True)
class _Scale:
    """Positions of errors on the axis: decades low … high, one place left of them for zero, one right for infinity."""

    low: int
    high: int

    @property
    def zero(self) -> float:
        return self.low - 0.75

    @property
    def infinity(self) -> float:
        return self.high + 0.75

    def place(self, x: float) -> float:
        if x == 0:
            return self.zero
        return float(np.log10(max(x, MIN_DRAWN_SPREAD))) if np.isfinite(x) else self.infinity


def spread(key: str, rows: Sequence[SpreadRow]) -> Markup:
    """The picture of all rows, the first on top."""
    worst = max(rows, key=lambda row: row.largest)
    label = (
        f"Distribution of the relative errors of {', '.join(row.name for row in rows)} on a logarithmic axis; "
        f"the largest is {worst.largest:.1e} of {worst.name}"
    )
    return picture(key, label, (WIDTH, ROW * len(rows) + AXIS), lambda axes: _draw(axes, rows))


def _draw(axes: Axes, rows: Sequence[SpreadRow]) -> None:
    scale = _scale(rows)
    height = ROW * len(rows) + AXIS
    axes.set_position((0.31, (AXIS - 0.06) / height, 0.68, ROW * len(rows) / height))
    axes.set_xlim(scale.zero - 0.5, scale.infinity + 0.5)
    axes.set_ylim(len(rows), 0)
    axes.set_facecolor("none")
    axes.spines[:].set_visible(False)
    step = -(-(scale.high - scale.low) // MAX_TICKS)
    decades = [k for k in range(scale.high, scale.low - 1, -step) if k - scale.zero > MIN_TICK_DISTANCE * step]
    axes.set_xticks([scale.zero, *decades], ["0", *map(superscript, decades)], fontsize=9, color=INK)
    if any(row.largest == np.inf for row in rows):
        axes.text(scale.infinity, len(rows) + 0.25, "∞", ha="center", va="top", fontsize=10, color=INK)
    axes.set_xlabel("relative error", fontsize=9, color=INK)
    axes.tick_params(length=0)
    axes.set_yticks([])
    _write_titles(axes, rows)
    axes.vlines(decades, 0, len(rows), color=FAINT_COLOR, linewidth=0.5, zorder=0)
    feet = np.arange(len(rows)) + 1.0
    ends = np.full((len(rows), 2), [scale.zero - 0.3, scale.infinity + 0.3])
    axes.plot(*_strokes(ends, np.stack([feet, feet], axis=1)), color=FAINT_COLOR, linewidth=0.6, zorder=1)
    bounds = np.array([_bound(scale, row) for row in rows])
    heads = np.stack([feet, feet - FULLEST_BIN_HEIGHT], axis=1)
    axes.plot(*_strokes(np.stack([bounds, bounds], axis=1), heads), color=INK, linewidth=1.3, zorder=3)
    for row, foot, bound in zip(rows, feet, bounds, strict=True):
        _draw_histogram(axes, scale, row, foot, bound)
    largest = [scale.place(row.largest) for row in rows]
    axes.plot(largest, feet, marker="^", markersize=4, color=INK, clip_on=False, linewidth=0, zorder=4)


def _write_titles(axes: Axes, rows: Sequence[SpreadRow]) -> None:
    """Write the names of rows in place of labels of ticks, which take half of the time of a picture of many rows."""
    beside, vertical, horizontal = axes.get_yaxis_text1_transform(TITLE_DISTANCE)
    for k, row in enumerate(rows):
        weight = "normal" if row.agrees else "bold"
        title = axes.text(0, k + 0.62, _title(row), transform=beside, va=vertical, ha=horizontal, fontsize=9)
        title.set(color=INK, fontweight=weight)


def _strokes(x: Array, y: Array) -> tuple[Array, Array]:
    """Lines with ends x, y (k, 2) as one curve with gaps: one path, which keeps the page small."""
    gap = np.full((len(x), 1), np.nan)
    return tuple(np.concatenate([part, gap], axis=1).ravel()[:-1] for part in (x, y))  # type: ignore[return-value]


def _bound(scale: _Scale, row: SpreadRow) -> float:
    """Position of the bound; a bound of zero beside the bar of errors that are zero."""
    return scale.zero + 1 / BINS_PER_DECADE if row.bound == 0 else scale.place(row.bound)


def _draw_histogram(axes: Axes, scale: _Scale, row: SpreadRow, foot: float, bound: float) -> None:
    """Standing on the line y = foot."""
    edges = np.arange(BINS_PER_DECADE * scale.low, BINS_PER_DECADE * scale.high + 1) / BINS_PER_DECADE
    errors = np.where(np.isnan(row.errors), np.inf, row.errors)
    inside = errors[(errors > 0) & np.isfinite(errors)]
    counts = np.histogram(np.log10(np.maximum(inside, MIN_DRAWN_SPREAD)), edges)[0]
    counts = np.concatenate([[(errors == 0).sum()], counts, [np.isinf(errors).sum()]])
    width = 1 / BINS_PER_DECADE
    places = np.concatenate([[scale.zero - width / 2], edges[:-1], [scale.infinity - width / 2]])
    occupied = counts > 0
    heights = FULLEST_BIN_HEIGHT * np.maximum(counts / counts.max(), MIN_BIN_HEIGHT)
    for beyond, color in ((False, WITHIN_COLOR), (True, BEYOND_COLOR)):
        part = occupied & ((places + width / 2 > bound) == beyond)
        if part.any():
            _draw_bars(axes, places[part], width, foot, heights[part], color)


def _draw_bars(axes: Axes, places: Array, width: float, foot: float, heights: Array, color: str) -> None:
    """Bars of one row and color, as one path, which keeps the page small."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    corners = [
        [(x, foot), (x + width, foot), (x + width, foot - height), (x, foot - height), (x, foot)]
        for x, height in zip(places, heights, strict=True)
    ]
    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY] * len(corners)
    bars = PathPatch(Path(np.concatenate(corners), codes), facecolor=color, linewidth=0, zorder=2)
    axes.add_artist(bars)  # limits are set: add_patch would look for them in every corner


def _scale(rows: Sequence[SpreadRow]) -> _Scale:
    errors = np.concatenate([[row.bound for row in rows], *(row.errors for row in rows)])
    decades = np.log10(np.maximum(errors[(errors > 0) & np.isfinite(errors)], MIN_DRAWN_SPREAD))
    low, high = (decades.min(), decades.max()) if decades.size else (-16.0, -12.0)
    return _Scale(int(np.floor(low)), int(np.floor(high)) + 1)


def _title(row: SpreadRow) -> str:
    return row.name if row.agrees else f"✗ {row.name}"
