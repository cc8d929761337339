"""Held-out errors of all methods, joint by joint; and the singular values that tell how well the motion excites."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures.colors import CURVES, FAINT_COLOR, INK, MIDDLE_COLOR
from crosscheck.report.pictures.svg import picture
from crosscheck.report.plain_text import superscript
from graphdyn.errors import counted
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, AXIS = 7.6, 0.3, 0.85
"""Sizes of the picture, of one row, of axis and key [inches]."""

METHOD_MARKERS = "os^Dv*Px<>ph"
MEAN_COLOR, JOINT_COLOR = CURVES[0], MIDDLE_COLOR

SINGULAR_VALUES_HEIGHT = 2.6
"""[inches]"""


def method_errors(key: str, methods: Sequence[str], joints: Sequence[str], errors: Array) -> Markup:
    """errors: relative, methods by joints (m, n)."""
    of = f"{counted(len(methods), 'method')} for {counted(len(joints), 'joint')}"
    label = f"Held-out error of {of}, on a logarithmic axis in percent"
    height = ROW * len(methods) + AXIS
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, methods, joints, 100 * errors, height))


def _draw(axes: Axes, methods: Sequence[str], joints: Sequence[str], errors: Array, height: float) -> None:
    axes.set_position((0.27, 0.45 / height, 0.71, ROW * len(methods) / height))
    axes.set_xscale("log")
    axes.set(ylim=(len(methods), 0), xlim=(0.8 * np.nanmin(errors), 1.25 * np.nanmax(errors)))
    axes.set_facecolor("none")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_yticks(np.arange(len(methods)) + 0.5, methods, fontsize=9, color=INK)
    axes.tick_params(axis="y", length=0)
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else "")
    axes.tick_params(axis="x", which="both", labelsize=8.5, length=2, color=INK)
    axes.set_xlabel("‖e‖ / ‖τ‖ [%] over rows that were not fitted", fontsize=9, color=INK)
    y = np.arange(len(methods)) + 0.5
    axes.hlines(y, *axes.get_xlim(), color=FAINT_COLOR, linewidth=0.6, zorder=0)
    for j, name in enumerate(joints):
        marker = METHOD_MARKERS[j % len(METHOD_MARKERS)]
        axes.plot(
            errors[:, j], y, linestyle="", marker=marker, markersize=4.5, color=JOINT_COLOR, alpha=0.8, label=name
        )
    axes.plot(
        np.nanmean(errors, axis=1), y, linestyle="", marker="|", markersize=13, color=MEAN_COLOR, mew=2.2, label="mean"
    )
    axes.legend(
        loc="lower left", bbox_to_anchor=(-0.37, 1.0), ncols=min(len(joints) + 1, 7), fontsize=7.5, frameon=False,
        handletextpad=0.1, columnspacing=0.8,
    )  # fmt: skip


def singular_values(key: str, values: Array) -> Markup:
    """values: of the regressor with columns at unit length, falling (r,)."""
    label = f"{len(values)} singular values from {values[0]:.3g} to {values[-1]:.3g}"
    return picture(key, label, (WIDTH, SINGULAR_VALUES_HEIGHT), lambda axes: _draw_singular(axes, values))


def _draw_singular(axes: Axes, values: Array) -> None:
    axes.set_position((0.09, 0.17, 0.89, 0.78))
    axes.set_yscale("log")
    axes.set_facecolor("none")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5, length=2, color=INK)
    axes.yaxis.set_major_formatter(lambda x, _: superscript(round(np.log10(x))))
    axes.plot(np.arange(1, len(values) + 1), values, color=MEAN_COLOR, marker="o", markersize=3, linewidth=0.8)
    axes.set_xlabel("number of the singular value", fontsize=9, color=INK)
