"""Section 3.2 of the paper, as printed and corrected, and the whole experiment, as sections of the report."""

from __future__ import annotations

import math
from itertools import groupby

import numpy as np

from crosscheck.commands.paper.identification_report import misprints, printed_text
from crosscheck.paper.multipliers import (
    INSTANT,
    WHY_PRINTED,
    CorrectedMultipliers,
    Multiplier,
    OverTime,
    printed_ratios,
)
from crosscheck.paper.reproduction import WHY_CORRECTED, Reproduction
from crosscheck.report.report import NO_VALUE, Column, Note, Notes, Panel, Plot, Prose, Row, Section, Series, Table
from graphdyn.layout import Array

COMPONENTS = (("λ_1", "N"), ("λ_2", "N"), ("λ_3", "N"), ("λ_4", "N m"), ("λ_5", "N m"))


def printed_section(found: Reproduction) -> Section:
    ranks = ", ".join(f"{rank} at {time:g} s" for time, rank in found.over_time.ranks.items())
    rank = f"Rank of the printed rows: {found.printed.rank} of {found.printed.n_rows} at 1.5 s; {ranks}."
    blocks = Prose(WHY_PRINTED), Prose(rank), _multipliers(found.numbers), _ratios(found)
    return Section("printed", "Section 3.2 as printed", blocks)


def corrected_section(found: CorrectedMultipliers) -> Section:
    reading = Notes(tuple(Note(f"{sentence}.") for sentence in found.reading), title="What each joint carries at 1.5 s")
    return Section("corrected", "Section 3.2 corrected", (Prose(WHY_CORRECTED), _corrected(found), reading))


def _multipliers(numbers: tuple[Multiplier, ...]) -> Table:
    rows = [
        Row((one.name, printed_text(one.printed), _multiplier_text(one), one.digits or "", one.meaning), rule=k == 0)
        for _, joint in groupby(numbers, lambda number: number.joint)
        for k, one in enumerate(joint)
    ]
    caption = "Eq. (113)-(118) at 1.5 s [N, N m]; digits: significant ones that agree, of seven. "
    return Table(
        (
            Column("multiplier", "name"),
            Column("printed", "number"),
            Column("graphdyn", "number"),
            Column("digits", "number"),
            Column("what it is"),
        ),
        tuple(rows),
        caption=caption + misprints(number.printed for number in numbers),
        compact=True,
    )


def _multiplier_text(number: Multiplier) -> str:
    """The multiplier with the seven digits of the paper; zero for what is rounding of zero."""
    if math.isnan(number.ours):
        return NO_VALUE
    return "0" if number.kind == "rounding" else f"{number.ours:.6e}"


def _ratios(found: Reproduction) -> Table:
    columns = (
        Column("joint", "name"),
        Column("printed", "number", form=".7f"),
        Column("null vector", "number", form=".7f", meaning="of the two rows"),
    )
    rows = (Row((str(joint), ratio, found.printed.ratios.get(joint))) for joint, ratio in printed_ratios().items())
    title = "What the undetermined multipliers have in common"
    return Table(columns, tuple(rows), title=title, caption="λ_j4 / λ_j5; tan 33.75° = 0.6681786", compact=True)


def _corrected(found: CorrectedMultipliers) -> Table:
    rows = []
    for j, (ours, there) in enumerate(zip(found.multipliers, found.rnea, strict=True), start=1):
        rows += [Row((str(j), "graphdyn", *ours), rule=True), Row(("", "rnea", *there))]
    columns = (Column(name, "number", unit, ".3f") for name, unit in COMPONENTS)
    return Table(
        (Column("joint", "name"), Column("source", "name"), *columns),
        tuple(rows),
        caption="All thirty multipliers at 1.5 s beside those of Pinocchio's rnea; largest relative difference "
        f"{found.difference:.1e}",
        repeated=2,
        compact=True,
    )


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
