"""Measured and predicted torque of one joint over time, fitted rows on the left, held-out rows on the right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.identifying import TorqueCurve
from crosscheck.report.pictures.colors import FAINT, INK
from crosscheck.report.pictures.svg import picture
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT = 7.6, 2.9
"""Of the picture of one joint [inches]."""

MOST_POINTS = 700
"""Per curve and side: more cannot be told apart, and a page stays small."""

PREDICTED, RESIDUAL = "#14507f", "#a3161a"

SIDES = ((0.085, 0.42), (0.57, 0.42))
"""Left edge and width of the fitted and the held-out rows."""


def torque_curves(
    key: str, joint: str, number: int, fitted: Sequence[TorqueCurve], held_out: Sequence[TorqueCurve], unit: str
) -> Markup:
    """number: of the joint, from 0; unit: of its torque or force."""
    label = f"Measured and predicted torque of {joint}; {_told('fitted', fitted, number, unit)}"
    if held_out:
        label += f"; {_told('held out', held_out, number, unit)}"
    return picture(
        key,
        label,
        (WIDTH, HEIGHT),
        lambda axes: _draw(axes, number, (("fitted", fitted), ("held out", held_out)), unit),
    )


def _told(side: str, curves: Sequence[TorqueCurve], j: int, unit: str) -> str:
    error = np.concatenate([curve.predicted[:, j] - curve.measured[:, j] for curve in curves])
    return f"{side}: root mean square error {np.sqrt(np.mean(error**2)):.3g} {unit}"


def _draw(axes: Axes, j: int, sides: Sequence[tuple[str, Sequence[TorqueCurve]]], unit: str) -> None:
    axes.set_axis_off()
    every = [curve for _, curves in sides for curve in curves]
    torque = _limits([curve.measured[:, j] for curve in every] + [curve.predicted[:, j] for curve in every])
    residual = _limits([curve.predicted[:, j] - curve.measured[:, j] for curve in every])
    for k, ((title, curves), (left, width)) in enumerate(zip(sides, SIDES, strict=True)):
        if not curves:
            continue
        upper, lower = (
            axes.inset_axes((left, bottom, width, height)) for bottom, height in ((0.44, 0.46), (0.13, 0.22))
        )
        for inner, limits in ((upper, torque), (lower, residual)):
            inner.set_facecolor("none")
            inner.spines[["top", "right"]].set_visible(False)
            inner.tick_params(labelsize=8, length=2, color=INK)
            inner.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
            inner.set_ylim(*limits)
        upper.set_xticklabels([])
        upper.set_title(f"{title}, torque [{unit}]", fontsize=8.5, color=INK, loc="left", pad=4)
        lower.set_title(f"predicted minus measured [{unit}]", fontsize=8.5, color=INK, loc="left", pad=2)
        lower.set_xlabel("t [s]", fontsize=8.5, color=INK, labelpad=1)
        points = max(2, MOST_POINTS // len(curves))
        for curve in curves:
            every_row = slice(None, None, max(1, -(-len(curve.t) // points)))
            t, measured, predicted = (x[every_row] for x in (curve.t, curve.measured[:, j], curve.predicted[:, j]))
            upper.plot(t, measured, color=INK, linewidth=1.6, alpha=0.45, label="measured")
            upper.plot(t, predicted, color=PREDICTED, linewidth=0.9, linestyle=(0, (4, 1.2)), label="predicted")
            lower.plot(t, predicted - measured, color=RESIDUAL, linewidth=0.8)
        if k == 0:
            handles, names = upper.get_legend_handles_labels()
            upper.legend(
                handles[:2], names[:2], loc="lower right", bbox_to_anchor=(1.02, 0.97), ncols=2, fontsize=8,
                frameon=False, borderpad=0, handlelength=2.2,
            )  # fmt: skip


def _limits(values: Sequence[Array]) -> tuple[float, float]:
    low, high = min(float(x.min()) for x in values), max(float(x.max()) for x in values)
    margin = 0.06 * (high - low) or 1.0
    return low - margin, high + margin
