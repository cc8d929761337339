"""Multipliers, torque and moments of every joint over the experiment, as plots: graphdyn's and those of rnea."""

from __future__ import annotations

import numpy as np

from crosscheck.paper.as_printed import INSTANT
from crosscheck.paper.over_time import OverTime
from crosscheck.report.report import Panel, Plot, Prose, Section, Series
from graphdyn.layout import Array

MARKED_SAMPLE_INTERVAL = 10
"""Every MARKED_SAMPLE_INTERVAL-th sample of rnea is marked."""

PANEL_HEIGHT = 0.62
"""Height of a panel, relative to others."""

KILO_FACTOR = 1e-3


def over_time_section(motion: OverTime) -> Section:
    times = len(motion.recording.time)
    words = Prose(
        f"The whole motion, beside rnea at {times} times: largest relative difference {motion.difference:.1e}."
    )
    return Section("over-time", "Over the whole motion", (words, *(_plot(motion, j) for j in range(1, 7))))


def _plot(motion: OverTime, joint: int) -> Plot:
    """Forces λ_1 … λ_3; λ_4, λ_5 and the torque; the whole moment in world axes."""
    j, recording = joint - 1, motion.recording
    ours, rnea = motion.multipliers[:, j], motion.rnea[:, j]
    names = tuple(f"λ_{joint}{k}" for k in range(1, 6))
    torques = np.column_stack([ours[:, 3:], recording.tau[:, j]]), np.column_stack([rnea[:, 3:], motion.rnea_tau[:, j]])
    moments = recording.joint_moments[:, j], motion.rnea_moments[:, j]
    panels = (
        _panel(f"force on body {joint}, world axes", "kN", names[:3], ours[:, :3], rnea[:, :3]),
        _panel("moments about t_1, t_2; torque", "kN m", (*names[3:], f"τ_{joint}"), *torques),
        _panel(f"moment on body {joint} at O{joint}, world axes", "kN m", ("M_x", "M_y", "M_z"), *moments),
    )
    return Plot(
        x=recording.time,
        x_title="t [s]",
        panels=panels,
        label=f"Joint {joint} from 0 to 2 s. " + "; ".join(map(_reach, panels)),
        caption=f"Lines: graphdyn; marks: every tenth sample of Pinocchio's rnea; upright: {INSTANT:g} s.",
        upright=INSTANT,
        wide=False,
        title=f"Joint {joint}",
        on=("page",),
    )


def _panel(title: str, unit: str, names: tuple[str, ...], ours: Array, rnea: Array) -> Panel:
    """ours, rnea: curves side by side (N, 3) [N or N m]"""
    marked = np.arange(len(rnea)) % MARKED_SAMPLE_INTERVAL == 0
    lines = (Series(name, KILO_FACTOR * ours[:, k], color=k) for k, name in enumerate(names))
    marks = (
        Series(f"{name}, rnea", np.where(marked, KILO_FACTOR * rnea[:, k], np.nan), "marks", k)
        for k, name in enumerate(names)
    )
    return Panel(title, (*lines, *marks), unit, height=PANEL_HEIGHT)


def _reach(panel: Panel) -> str:
    values = np.concatenate([one.y for one in panel.series if one.style == "line"])
    return f"{panel.heading}: {values.min():.3g} to {values.max():.3g}"
