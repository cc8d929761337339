"""Every base parameter beside CAD, in a common unit: the torque that it makes over the recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.identifying.results.parameters import BaseRow
from crosscheck.report.pictures.colors import CURVES, FAINT_COLOR, INK
from crosscheck.report.pictures.parameter_rows import put_key, put_rows, size
from crosscheck.report.pictures.svg import picture
from crosscheck.report.plain_text import superscript
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINEAR_AXIS_SHARE = 1e-4
"""Part of the largest torque below which the axis is linear."""

FOUND_COLOR, CAD_COLOR, TRUE_COLOR = CURVES[:3]


def parameter_bars(key: str, rows: Sequence[BaseRow], sizes: Array) -> Markup:
    """sizes: root mean square torque that a parameter of 1 makes, over all joints (r,)."""
    label = f"{len(rows)} base parameters with error bars of two standard deviations beside the CAD values"
    return picture(key, label, size(len(rows)), lambda axes: _draw(axes, rows, sizes))


def _draw(axes: Axes, rows: Sequence[BaseRow], sizes: Array) -> None:
    found, cad, true = (sizes * np.array([getattr(row, name) for row in rows]) for name in ("value", "cad", "truth"))
    reach = float(np.nanmax(np.abs([*found, *cad]), initial=0.0)) or 1.0
    bar = np.nan_to_num(2 * sizes * [row.block_deviation for row in rows], posinf=4 * reach)
    axes.set_xscale("symlog", linthresh=LINEAR_AXIS_SHARE * reach, linscale=0.5)
    axes.set(xlim=(-2 * reach, 2 * reach))
    decades = range(int(np.ceil(np.log10(LINEAR_AXIS_SHARE * reach))), int(np.floor(np.log10(2 * reach))) + 1, 2)
    ticks = [*(-(10.0**k) for k in reversed(decades)), 0.0, *(10.0**k for k in decades)]
    names = [*(f"−{superscript(k)}" for k in reversed(decades)), "0", *map(superscript, decades)]
    axes.set_xticks(ticks, names, fontsize=9, color=INK)
    axes.set_xticks([], minor=True)
    put_rows(axes, [row.name for row in rows])
    axes.vlines(ticks, 0, len(rows), color=FAINT_COLOR, linewidth=0.5, zorder=0)
    y = np.arange(len(rows)) + 0.5
    axes.hlines(y, -2 * reach, 2 * reach, color=FAINT_COLOR, linewidth=0.4, zorder=0)
    axes.set_xlabel("torque that the parameter makes, root mean square [N m]", fontsize=9, color=INK)
    axes.plot(cad, y, linestyle="", marker="o", markersize=5, mfc="none", mec=CAD_COLOR, mew=1.1, label="CAD")
    if np.isfinite(true).any():
        axes.plot(true, y, linestyle="", marker="x", markersize=5, mec=TRUE_COLOR, mew=1.3, label="truth")
    axes.errorbar(
        found,
        y,
        xerr=bar,
        linestyle="",
        marker="o",
        markersize=3,
        color=FOUND_COLOR,
        elinewidth=1.2,
        label="identified ± 2 σ",
    )
    put_key(axes, 3)
