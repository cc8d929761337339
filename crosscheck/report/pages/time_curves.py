"""Five multipliers, torque and moments of one joint over time, with marks where Pinocchio was asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures.colors import FAINT, INK
from crosscheck.report.pictures.svg import picture
from crosscheck.studies.paper.as_printed import INSTANT
from crosscheck.studies.paper.over_time import OverTime
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT = 3.7, 5.0
"""Of the picture of one joint [inches]."""

MARKED = 10
"""Every so manieth time of rnea is marked."""

STYLES = (("#14507f", "-"), ("#a3161a", (0, (4, 1.6))), ("#2f7d32", (0, (1, 1.2))))

KILO = 1e-3


@dataclass(frozen=True, eq=False)
class Panel:
    """Up to three curves over the same time: ours (N, k), rnea's (N, k), in N or N m."""

    title: str
    names: tuple[str, ...]
    ours: Array
    rnea: Array


def joint_curves(key: str, motion: OverTime, joint: int) -> Markup:
    """Three panels: forces λ_1 … λ_3; λ_4, λ_5 and the torque; the whole moment in world axes."""
    panels = _panels(motion, joint)
    reach = "; ".join(
        f"{panel.title}: {KILO * panel.ours.min():.3g} to {KILO * panel.ours.max():.3g}" for panel in panels
    )
    label = f"Joint {joint} from 0 to 2 s. {reach}"
    return picture(key, label, (WIDTH, HEIGHT), lambda axes: _draw(axes, motion.recording.time, panels))


def _panels(motion: OverTime, joint: int) -> tuple[Panel, ...]:
    j, recording = joint - 1, motion.recording
    ours, rnea = motion.multipliers[:, j], motion.rnea[:, j]
    names = tuple(f"λ_{joint}{k}" for k in range(1, 6))
    return (
        Panel(f"force on body {joint}, world axes [kN]", names[:3], ours[:, :3], rnea[:, :3]),
        Panel(
            "moments about t_1, t_2; torque [kN m]",
            (*names[3:], f"τ_{joint}"),
            np.column_stack([ours[:, 3:], recording.tau[:, j]]),
            np.column_stack([rnea[:, 3:], motion.rnea_tau[:, j]]),
        ),
        Panel(
            f"moment on body {joint} at O{joint}, world axes [kN m]",
            ("M_x", "M_y", "M_z"),
            recording.joint_moments[:, j],
            motion.rnea_moments[:, j],
        ),
    )


def _draw(axes: Axes, time: Array, panels: Sequence[Panel]) -> None:
    axes.set_axis_off()
    part = 1 / len(panels)
    for k, panel in enumerate(panels):
        inner = axes.inset_axes((0.135, 1 - (k + 1) * part + 0.085, 0.845, part - 0.165))
        _draw_panel(inner, time, panel, last=k == len(panels) - 1)


def _draw_panel(axes: Axes, time: Array, panel: Panel, *, last: bool) -> None:
    axes.set_facecolor("none")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=7.5, length=2, color=INK)
    axes.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
    axes.axvline(INSTANT, color=FAINT, linewidth=1, zorder=0)
    for column, (name, (color, style)) in enumerate(zip(panel.names, STYLES, strict=True)):
        axes.plot(time, KILO * panel.ours[:, column], color=color, linestyle=style, linewidth=1.3, label=name)
        there = KILO * panel.rnea[::MARKED, column]
        axes.plot(time[::MARKED], there, linestyle="", marker="o", markersize=3, mec=color, mfc="white", mew=0.8)
    axes.set_xlim(0, time[-1] * 1.02)
    axes.set_xticks(np.arange(0, time[-1] + 0.25, 0.5))
    axes.set_title(panel.title, fontsize=8, color=INK, loc="left", pad=13)
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(-0.02, 0.96),
        ncols=3,
        fontsize=7.5,
        frameon=False,
        borderpad=0,
        handlelength=2,
    )
    if last:
        axes.set_xlabel("t [s]", fontsize=8, color=INK, labelpad=1)
