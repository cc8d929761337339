"""Every base parameter beside CAD, in a common unit: the torque that it makes over the recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.identifying.parameters import BaseRow
from crosscheck.report.pictures.colors import CURVES, FAINT, INK
from crosscheck.report.pictures.svg import picture
from crosscheck.report.plain_text import superscript
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, AXIS = 7.6, 0.165, 0.95
"""Of the picture, of one row, of axis and key [inches]."""

LONGEST = 30
"""Characters of a name; the table has the whole one."""

SMALLEST = 1e-4
"""Part of the largest torque below which the axis is linear."""

FOUND, CAD, TRUE = CURVES[:3]


def parameter_bars(key: str, rows: Sequence[BaseRow], sizes: Array) -> Markup:
    """sizes: root mean square torque that a parameter of 1 makes, over all joints (r,)."""
    label = f"{len(rows)} base parameters with error bars of two standard deviations beside the CAD values"
    height = ROW * len(rows) + AXIS
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, rows, sizes, height))


def _draw(axes: Axes, rows: Sequence[BaseRow], sizes: Array, height: float) -> None:
    axes.set_position((0.3, 0.48 / height, 0.68, ROW * len(rows) / height))
    found, cad, true = (sizes * np.array([getattr(row, name) for row in rows]) for name in ("value", "cad", "truth"))
    reach = float(np.nanmax(np.abs([*found, *cad]), initial=0.0)) or 1.0
    bar = np.nan_to_num(2 * sizes * [row.block_deviation for row in rows], posinf=4 * reach)
    axes.set_xscale("symlog", linthresh=SMALLEST * reach, linscale=0.5)
    axes.set(xlim=(-2 * reach, 2 * reach), ylim=(len(rows), 0))
    axes.set_facecolor("none")
    axes.spines[:].set_visible(False)
    decades = range(int(np.ceil(np.log10(SMALLEST * reach))), int(np.floor(np.log10(2 * reach))) + 1, 2)
    ticks = [*(-(10.0**k) for k in reversed(decades)), 0.0, *(10.0**k for k in decades)]
    names = [*(f"−{superscript(k)}" for k in reversed(decades)), "0", *map(superscript, decades)]
    axes.set_xticks(ticks, names, fontsize=9, color=INK)
    axes.set_xticks([], minor=True)
    axes.set_yticks(np.arange(len(rows)) + 0.5, [_short(row.name) for row in rows], fontsize=8, color=INK)
    axes.tick_params(length=0)
    axes.vlines(ticks, 0, len(rows), color=FAINT, linewidth=0.5, zorder=0)
    axes.hlines(np.arange(len(rows)) + 0.5, -2 * reach, 2 * reach, color=FAINT, linewidth=0.4, zorder=0)
    axes.set_xlabel("torque that the parameter makes, root mean square [N m]", fontsize=9, color=INK)
    y = np.arange(len(rows)) + 0.5
    axes.plot(cad, y, linestyle="", marker="o", markersize=5, mfc="none", mec=CAD, mew=1.1, label="CAD")
    if np.isfinite(true).any():
        axes.plot(true, y, linestyle="", marker="x", markersize=5, mec=TRUE, mew=1.3, label="truth")
    axes.errorbar(
        found,
        y,
        xerr=bar,
        linestyle="",
        marker="o",
        markersize=3,
        color=FOUND,
        elinewidth=1.2,
        label="identified ± 2 σ",
    )
    axes.legend(
        loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, fontsize=8.5, frameon=False, handletextpad=0.4,
        columnspacing=1.4,
    )  # fmt: skip


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
