"""How many times as long others take, as bars on a logarithmic axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from markupsafe import Markup

from crosscheck.bench.contender import SpeedRatio
from crosscheck.report.pictures.colors import BAR, FAINT_COLOR, INK
from crosscheck.report.pictures.svg import picture
from crosscheck.report.plain_text import ratio_text, threads_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, AXIS = 7.6, 0.24, 0.45
"""Sizes of the picture, of one bar, of the axis with its title [inches]."""


def ratio_bars(key: str, comparisons: Sequence[SpeedRatio]) -> Markup:
    """One bar per comparison, with the quartiles as a line."""
    label = "Times as long as graphdyn: " + "; ".join(f"{_name(c)}: {ratio_text(c.ratio.median)}" for c in comparisons)
    return picture(key, label, (WIDTH, AXIS + ROW * len(comparisons)), lambda axes: _draw(axes, comparisons))


def _name(comparison: SpeedRatio) -> str:
    return f"{comparison.theirs} / {comparison.ours}, {threads_text(comparison.threads)}"


def _draw(axes: Axes, comparisons: Sequence[SpeedRatio]) -> None:
    axes.set_axis_off()
    height = AXIS + ROW * len(comparisons)
    inner = axes.inset_axes((0.56, AXIS / height, 0.4, 1 - AXIS / height))
    inner.set_facecolor("none")
    inner.spines[["top", "right"]].set_visible(False)
    inner.tick_params(labelsize=7.5, length=2, color=INK)
    inner.grid(color=FAINT_COLOR, linewidth=0.5)
    inner.set_axisbelow(True)
    places = range(len(comparisons))
    inner.barh(places, [c.ratio.median for c in comparisons], color=BAR, height=0.62, left=0)
    for place, c in zip(places, comparisons, strict=True):
        inner.plot(c.ratio.quartiles, (place, place), color=INK, linewidth=1)
        inner.annotate(
            ratio_text(c.ratio.median),
            (max(c.ratio.median, c.ratio.quartiles[1]), place),
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
    inner.xaxis.set_minor_formatter(lambda value, _: "")
    inner.set_xlabel("times as long as graphdyn; right of the line graphdyn is faster", fontsize=8, color=INK)
