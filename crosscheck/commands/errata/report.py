"""`graphdyn errata`: what the printed errors of the paper do, as a report, and as distributions over random states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.commands.errata.record import record
from crosscheck.paper.errata import COSINES, ERRATA, Effect
from crosscheck.paper.reproduction import CORRECTED_FORM_BOUND
from crosscheck.report.pictures.spread import SpreadRow, spread
from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, picture
from crosscheck.report.plain_text import superscript
from crosscheck.report.report import Column, Facts, Report, Row, Section, Table
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, HEIGHT = 7.6, 3.6
RANK_HEIGHT = 1.7
"""Height of the picture of A2 [inches]."""

MIN_DRAWN_ERROR = 1e-17
"""Value at which an error of zero is drawn."""

PRINTED_COLOR, CORRECT_COLOR = CURVES[1], CURVES[0]
ROBOT_MARKERS = {"kr500": "o", "ur5": "^"}


def distributions(key: str, effects: Sequence[Effect]) -> Markup:
    """A1, A4, A5, A6: histograms of the printed and the corrected form, arm by arm."""
    rows = [
        SpreadRow(f"{effect.erratum} {effect.robot}, {form}", errors, CORRECTED_FORM_BOUND)
        for effect in sorted(effects, key=lambda effect: effect.erratum)
        if effect.erratum not in ("A2", "A3")
        for form, errors in (("printed", effect.errors), ("corrected", effect.corrected_errors))
    ]
    return spread(key, rows)


def towards_lock(key: str, effects: Sequence[Effect]) -> Markup:
    """A3: error against |cos β|, both axes logarithmic."""
    chosen = [effect for effect in effects if effect.cosine is not None]
    worst = max(effect.largest for effect in chosen)
    right = max(effect.corrected for effect in chosen)
    label = (
        f"A3: error of the accelerations against |cos β| on logarithmic axes; up to {worst:.1g} in Cardano angles, "
        f"never above {right:.0e} in the twist form"
    )
    return picture(key, label, (WIDTH, HEIGHT), lambda axes: _draw_lock(axes, chosen))


def missing_rank(key: str, effects: Sequence[Effect]) -> Markup:
    """A2: how many states miss how many of the 30 rows."""
    chosen = [effect for effect in effects if effect.erratum == "A2"]
    label = "A2: missing rank of the printed rows: " + "; ".join(
        f"{effect.robot} {effect.errors.min():.0f} to {effect.largest:.0f}" for effect in chosen
    )
    return picture(key, label, (WIDTH, RANK_HEIGHT), lambda axes: _draw_rank(axes, chosen))


def _draw_lock(axes: Axes, effects: Sequence[Effect]) -> None:
    axes.set_position((0.085, 0.135, 0.67, 0.84))
    _bare(axes)
    axes.set(xlim=(-6.45, -1.55), ylim=(-17, 3))
    ticks = range(-16, 4, 4)
    axes.set_xticks(range(-6, -1), [superscript(k) for k in range(-6, -1)], fontsize=9, color=INK)
    axes.set_yticks(list(ticks), [superscript(k) for k in ticks], fontsize=9, color=INK)
    axes.hlines(list(ticks), -6.45, -1.55, color=FAINT_COLOR, linewidth=0.5, zorder=0)
    axes.set_xlabel("|cos β|", fontsize=9, color=INK)
    axes.set_ylabel("relative error of a", fontsize=9, color=INK)
    for k, robot in enumerate(ROBOT_MARKERS):
        near = [effect for effect in effects if effect.robot == robot]
        _draw_form(
            axes, k, f"{robot}, printed (Cardano)", [effect.errors for effect in near], PRINTED_COLOR, filled=True
        )
        right = [effect.corrected_errors for effect in near]
        _draw_form(axes, k, f"{robot}, corrected (twist)", right, CORRECT_COLOR, filled=False)
    axes.legend(
        loc="center left",
        bbox_to_anchor=(1.0, 0.5),
        fontsize=8,
        frameon=False,
        title="lines: medians",
        title_fontsize=8,
    )


def _draw_form(axes: Axes, k: int, name: str, errors: Sequence[Array], color: str, *, filled: bool) -> None:
    """The errors (N,) at each |cos β| side by side around it, those of arm k beside those of the other; medians."""
    medians = [np.log10(max(float(np.quantile(at, 0.5)), MIN_DRAWN_ERROR)) for at in errors]
    axes.plot(np.log10(COSINES), medians, color=color, linewidth=1, linestyle=("-", "--")[k], zorder=1)
    places = [
        np.log10(cosine) + 0.16 * (k - 0.5) + np.linspace(-0.07, 0.07, len(at))
        for cosine, at in zip(COSINES, errors, strict=True)
    ]
    axes.plot(
        np.concatenate(places), np.log10(np.maximum(np.concatenate(errors), MIN_DRAWN_ERROR)), label=name,
        linestyle="", marker=list(ROBOT_MARKERS.values())[k], markersize=3,
        mfc=color if filled else "none", mec=color, mew=0.6, alpha=0.8,
    )  # fmt: skip


def _draw_rank(axes: Axes, effects: Sequence[Effect]) -> None:
    axes.set_position((0.2, 0.3, 0.6, 0.66))
    _bare(axes)
    rows = [(effect, form) for effect in effects for form in ("printed", "corrected")]
    axes.set(xlim=(-0.5, 5.5), ylim=(len(rows), 0))
    axes.set_xticks(range(6), [str(k) for k in range(6)], fontsize=9, color=INK)
    axes.set_yticks(
        np.arange(len(rows)) + 0.5, [f"A2 {effect.robot}, {form}" for effect, form in rows], fontsize=9, color=INK
    )
    axes.set_xlabel("missing rank of the 30 rows", fontsize=9, color=INK)
    axes.vlines(range(6), 0, len(rows), color=FAINT_COLOR, linewidth=0.5, zorder=0)
    for y, (effect, form) in enumerate(rows):
        values = effect.errors if form == "printed" else effect.corrected_errors
        for missing, count in zip(*np.unique(values, return_counts=True), strict=True):
            color = PRINTED_COLOR if form == "printed" else CORRECT_COLOR
            axes.plot([missing], [y + 0.5], marker="o", markersize=9 * np.sqrt(count / len(values)), color=color)
            share = f"{count / len(values):.0%} of {len(values)} states"
            axes.annotate(share, (missing, y + 0.5), xytext=(9, -3), textcoords="offset points", fontsize=8, color=INK)


def _bare(axes: Axes) -> None:
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)


MEANINGS = Facts(tuple(ERRATA.items()))
"""What each erratum is."""


def errata_report(effects: Sequence[Effect], samples: int, seed: int) -> Report:
    title = "The printed errors, measured"
    blocks = effects_table(effects, samples, seed), MEANINGS
    return Report(title, None, (Section("errata", title, blocks),), record=lambda _: record(effects))


def effects_table(effects: Sequence[Effect], samples: int, seed: int) -> Table:
    """One row per erratum, robot and, for A3, distance from gimbal lock."""
    columns = (
        Column("erratum", "name"),
        Column("robot", "name"),
        Column("measured"),
        Column("median", "number", form=".2g"),
        Column("90 %", "number", form=".2g"),
        Column("largest", "number", form=".2g"),
        Column("corrected", "number", form=".2g", meaning="largest error of the corrected form"),
    )
    rows = tuple(
        Row((e.erratum, e.robot, e.measure, e.median, e.upper, e.largest, e.corrected), rule=k > 0 and new_robot)
        for k, e in enumerate(effects)
        for new_robot in [e.robot != effects[k - 1].robot]
    )
    caption = (
        f"Quantiles of the printed form ({samples} random states, seed {seed}), and the largest error of the corrected "
        "one"
    )
    return Table(columns, rows, caption=caption)
