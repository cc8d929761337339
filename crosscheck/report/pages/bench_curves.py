"""Times against the size of a batch, bodies or threads, on logarithmic axes; and ratios as bars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from markupsafe import Markup

from crosscheck.report.pictures.colors import FAINT, INK
from crosscheck.report.pictures.svg import picture
from crosscheck.studies.bench.contender import SpeedRatio
from crosscheck.studies.bench.curves import Line, ScalingCurve
from crosscheck.studies.bench.texts import ratio_text, threads_text, time_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT = 7.6, 4.0
BAR, AXIS = 0.24, 0.45
"""Of a picture of curves; of one bar, and of what the axis of the bars needs [inches]."""

COLORS = ("#14507f", "#a3161a", "#2f7d32", "#7a5200", "#5b2a86", "#00707a", "#8a8f96", "#b0487a", "#444444")
MARKERS = "os^Dv<>ph"


def curve_picture(key: str, curve: ScalingCurve) -> Markup:
    label = f"{curve.title}, logarithmic axes. " + "; ".join(_reach(line) for line in curve.lines)
    return picture(key, label, (WIDTH, HEIGHT), lambda axes: _draw_curve(axes, curve))


def ratio_picture(key: str, comparisons: Sequence[SpeedRatio]) -> Markup:
    """One bar per comparison, with the quartiles as a line."""
    label = "Ratios: " + "; ".join(f"{_name(c)}: {ratio_text(c.ratio.median)}" for c in comparisons)
    return picture(key, label, (WIDTH, AXIS + BAR * len(comparisons)), lambda axes: _draw_ratios(axes, comparisons))


def _reach(line: Line) -> str:
    ends = " to ".join(time_text(line.times[k].median) for k in (0, -1))
    return f"{_line_name(line)}: {ends} from {line.x[0]} to {line.x[-1]}"


def _line_name(line: Line) -> str:
    return f"{line.name}, {threads_text(line.threads)}" if line.threads else line.name


def _name(comparison: SpeedRatio) -> str:
    return f"{comparison.ours} / {comparison.theirs}, {threads_text(comparison.threads)}"


def _draw_curve(axes: Axes, curve: ScalingCurve) -> None:
    axes.set_axis_off()
    inner = axes.inset_axes((0.09, 0.12, 0.56, 0.84))
    _plain(inner)
    for k, line in enumerate(curve.lines):
        color, marker = COLORS[k % len(COLORS)], MARKERS[k % len(MARKERS)]
        middle = [times.median for times in line.times]
        low, high = ([times.spread[end] for times in line.times] for end in (0, 1))
        inner.plot(line.x, middle, color=color, marker=marker, markersize=3.5, linewidth=1.2, label=_line_name(line))
        inner.vlines(line.x, low, high, color=color, linewidth=0.8)
    inner.set(xscale="log", yscale="log")
    inner.yaxis.set_major_formatter(lambda value, _: time_text(value))
    shown = sorted({x for line in curve.lines for x in line.x})
    inner.set_xticks(shown if len(shown) < 9 else shown[:: len(shown) // 6])
    inner.set_xticks([], minor=True)
    inner.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    inner.set_xlabel(curve.x, fontsize=8, color=INK)
    inner.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), fontsize=7.5, frameon=False, borderpad=0)


def _draw_ratios(axes: Axes, comparisons: Sequence[SpeedRatio]) -> None:
    axes.set_axis_off()
    height = AXIS + BAR * len(comparisons)
    inner = axes.inset_axes((0.56, AXIS / height, 0.4, 1 - AXIS / height))
    _plain(inner)
    places = range(len(comparisons))
    inner.barh(places, [c.ratio.median for c in comparisons], color="#7d96ad", height=0.62, left=0)
    for place, c in zip(places, comparisons, strict=True):
        inner.plot(c.ratio.spread, (place, place), color=INK, linewidth=1)
        inner.annotate(
            ratio_text(c.ratio.median),
            (max(c.ratio.median, c.ratio.spread[1]), place),
            xytext=(3, 0),
            textcoords="offset points",
            fontsize=7.5,
            va="center",
        )
    inner.set_yticks(places, [_name(c) for c in comparisons])
    medians = [c.ratio.median for c in comparisons]
    inner.set(xscale="log", xlim=(min(0.5, *medians) / 2, 10 * max(medians)))
    inner.invert_yaxis()
    inner.axvline(1, color=INK, linewidth=0.8)
    inner.xaxis.set_major_formatter(lambda value, _: f"{value:g}×")


def _plain(axes: Axes) -> None:
    axes.set_facecolor("none")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=7.5, length=2, color=INK)
    axes.grid(color=FAINT, linewidth=0.5)
    axes.set_axisbelow(True)
