"""Errors of several codes as points beside the bound: one row per quantity, on a common logarithmic axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, inf, isfinite, log10
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, picture
from crosscheck.report.plain_text import superscript

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SMALLEST_DRAWN = 1e-4
"""Errors below this [eps], and those that are zero, stand here."""

CODE_MARKERS = ("o", "s", "D", "^", "v", "P")
"""One shape for each code: no reader depends on color."""

WIDTH, ROW, AXIS, KEY = 7.6, 0.26, 0.5, 0.32
"""Sizes of the picture, of one row, of what the axis and what the key need [inches]."""

LEFT, PART = 0.385, 0.585
"""Edge and width of the axes, as parts of the width: the names stand on the left."""


@dataclass(frozen=True)
class ErrorRow:
    """errors: usual and largest error of each code, by its name [eps]; bound: what they must not exceed [eps]"""

    name: str
    errors: Mapping[str, tuple[float, float]]
    bound: float

    @property
    def agrees(self) -> bool:
        return all(largest <= self.bound for _, largest in self.errors.values())


def error_points(key: str, rows: Sequence[ErrorRow], usual: str) -> Markup:
    """The picture of all rows, the first on top. usual: what the point of a code is, in words"""
    codes = list(dict.fromkeys(code for row in rows for code in row.errors))
    label = f"{usual} of {', '.join(codes)} for {', '.join(row.name for row in rows)}, beside the bounds, in eps"
    height = ROW * len(rows) + AXIS + KEY
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, rows, codes, height))


def _draw(axes: Axes, rows: Sequence[ErrorRow], codes: Sequence[str], height: float) -> None:
    drawn = [_drawn(x) for row in rows for x in (row.bound, *(e for pair in row.errors.values() for e in pair))]
    low, high = floor(log10(min(drawn)) - 0.05), ceil(log10(max(drawn)) + 0.05)
    axes.set_position((LEFT, AXIS / height, PART, ROW * len(rows) / height))
    axes.set(xlim=(low, high), ylim=(len(rows), 0), facecolor="none", yticks=[])
    axes.spines[:].set_visible(False)
    ticks = range(low, high + 1)
    axes.set_xticks(ticks, list(map(superscript, ticks)), fontsize=9, color=INK)
    axes.tick_params(length=0)
    axes.set_xlabel("error [eps of the scale]", fontsize=9, color=INK)
    axes.vlines(ticks, 0, len(rows), color=FAINT_COLOR, linewidth=0.5, zorder=0)
    for k, row in enumerate(rows):
        title = row.name if row.agrees else f"✗ {row.name}"
        weight = "normal" if row.agrees else "bold"
        beside = axes.get_yaxis_transform()
        axes.text(
            -0.01, k + 0.5, title, transform=beside, va="center", ha="right", fontsize=9, color=INK, weight=weight
        )
        axes.hlines(k + 1, low, high, color=FAINT_COLOR, linewidth=0.5, zorder=0)
        axes.vlines(log10(_drawn(row.bound)), k + 0.12, k + 0.88, color=INK, linewidth=1.6, zorder=1)
    for number, code in enumerate(codes):
        places = [(k, row.errors[code]) for k, row in enumerate(rows) if code in row.errors]
        color, offset = CURVES[number % len(CURVES)], (number + 1) / (len(codes) + 1)
        feet = [k + offset for k, _ in places]
        ends = [tuple(log10(_drawn(x)) for x in pair) for _, pair in places]
        axes.hlines(feet, [a for a, _ in ends], [b for _, b in ends], color=color, linewidth=0.9, zorder=2)
        style: dict[str, Any] = {
            "marker": CODE_MARKERS[number % len(CODE_MARKERS)],
            "markersize": 3.4,
            "linewidth": 0,
            "color": color,
        }
        axes.plot([a for a, _ in ends], feet, zorder=3, label=code, clip_on=False, **style)
    anchor = (0.0, 1 + 0.05 / (ROW * len(rows)))
    axes.legend(loc="lower left", bbox_to_anchor=anchor, ncols=len(codes), fontsize=9, frameon=False, labelcolor=INK,
                borderpad=0, handletextpad=0.1, columnspacing=1.2)  # fmt: skip


def _drawn(error: float) -> float:
    """The error at whose place one is drawn: infinite ones at the right edge."""
    return max(error, SMALLEST_DRAWN) if isfinite(error) else 1e6 if error == inf else SMALLEST_DRAWN
