"""Tables 3 and 4 of the paper beside graphdyn's identifications, as a section of the report.

The absolute error of every identified parameter, the paper's and ours from other data, is on a logarithmic axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.paper.printed import PARAMETERS, TABLE_3, TABLE_4, Printed
from crosscheck.paper.tables import WHY_TABLE_3, PaperIdentification
from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, picture
from crosscheck.report.plain_text import superscript
from crosscheck.report.report import NO_VALUE, WIDE_LINE_CHARACTERS, Column, Picture, Prose, Row, Section, Table
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


BODY_TABLE_COLUMNS = tuple(Column(f"B_{i}", "number") for i in range(1, 7))


def printed_text(number: Printed) -> str:
    """The number as printed, with the number of its erratum."""
    if number.text is None:
        return NO_VALUE
    return f"{number.text} {number.erratum or ''}".strip()


def misprints(numbers: Iterable[Printed]) -> str:
    """What every misprint among these should read, as sentences."""
    return " ".join(
        f"{number.text} is a misprint for {number.reading} ({number.erratum})." for number in numbers if number.erratum
    )


def value_text(value: float) -> str:
    """The value with the four decimal places of the paper; no minus before a zero."""
    return NO_VALUE if math.isnan(value) else f"{round(value, 4) + 0.0:.4f}"


def error_text(error: float) -> str:
    """An error far below the places of the paper."""
    if math.isnan(error):
        return NO_VALUE
    return f"{error:.0e}" if error else "0"


WIDTH, ROW, AXIS = 7.6, 0.165, 0.95
"""Sizes of the picture, of one row, of axis and key [inches]."""

MIN_EXPONENT, MAX_EXPONENT = -14.5, -1.0
"""Decades of the axis [kg, kg m²]."""

AXIS_BREAK, COMPRESSION = -8.0, 0.3
"""Below this decade, where only exact data come, a decade has this part of its width."""

MAX_HIDDEN_NUMBER = 5e-5
"""A printed 0.0000 is smaller than this."""

GRAPHDYN_COLOR, PRINTED_COLOR = CURVES[0], CURVES[1]


def identification_errors(key: str, found: PaperIdentification) -> Markup:
    """One row per parameter and body."""
    label = (
        "Absolute errors of the identified parameters on a logarithmic axis. Largest: "
        f"paper {found.printed_largest:.4f}, 7-digit data {found.rounded_largest:.4f}, "
        f"exact data {found.exact.largest(found.compared):.0e}"
    )
    rows = found.true.size
    return picture(key, label, (WIDTH, ROW * rows + AXIS), lambda axes: _draw(axes, found))


def _draw(axes: Axes, found: PaperIdentification) -> None:
    n, k = found.true.shape[1], len(PARAMETERS)
    height = ROW * n * k + AXIS
    axes.set_position((0.125, 0.5 / height, 0.845, ROW * n * k / height))
    axes.set(xlim=(_place(10.0**MIN_EXPONENT), MAX_EXPONENT), ylim=(n * k, 0))
    axes.spines[:].set_visible(False)
    decades = [-14, -11, *range(-7, 0)]
    places = [_place(10.0**decade) for decade in decades]
    axes.set_xticks(places, [superscript(decade) for decade in decades], fontsize=9, color=INK)
    axes.set_yticks(
        np.arange(n * k) + 0.5,
        [f"B_{i} {name}" for i in range(1, n + 1) for name in PARAMETERS],
        fontsize=8,
        color=INK,
    )
    axes.tick_params(length=0)
    axes.vlines(places, 0, n * k, color=FAINT_COLOR, linewidth=0.5, zorder=0)
    axes.vlines([AXIS_BREAK], 0, n * k, color=INK, linewidth=0.8, linestyle=(0, (4, 3)), zorder=0)
    axes.hlines(
        np.arange(0, n * k + 1, k), _place(10.0**MIN_EXPONENT), MAX_EXPONENT, color=FAINT_COLOR, linewidth=1, zorder=0
    )
    axes.set_xlabel("absolute error [kg, kg m²]", fontsize=9, color=INK)
    trials = np.abs([trial.errors for trial in found.rounded])
    for body in range(n):
        for row in range(k):
            _draw_row(axes, found, trials[:, row, body], (row, body), body * k + row + 0.5)
    _draw_key(axes)


def _draw_row(axes: Axes, found: PaperIdentification, trials: Array, entry: tuple[int, int], y: float) -> None:
    exact, printed = abs(found.exact.errors[entry]), abs(found.printed_errors[entry])
    if np.isnan(exact):
        axes.text(
            _place(10.0**MIN_EXPONENT) + 0.1, y, "not determined by the motion", fontsize=7.5, color=INK, va="center"
        )
    else:
        low, high = (_place(x) for x in (trials.min(), trials.max()))
        axes.plot([low, high], [y, y], color=GRAPHDYN_COLOR, linewidth=3.2, alpha=0.35, solid_capstyle="round")
        axes.plot([_place(trials[0])], [y], marker="o", markersize=4, color=GRAPHDYN_COLOR)
        axes.plot(
            [_place(exact)], [y], marker="s", markersize=3.5, mfc="none", mec=GRAPHDYN_COLOR, mew=0.9, clip_on=False
        )
    if np.isfinite(printed):
        marker, size = ("x", 5) if printed else ("<", 4)
        axes.plot(
            [_place(printed or MAX_HIDDEN_NUMBER)],
            [y],
            marker=marker,
            markersize=size,
            mfc="none",
            mec=PRINTED_COLOR,
            mew=1.2,
        )


def _place(error: float) -> float:
    """On the axis, in decades; an error of zero at its left end."""
    decade = float(np.log10(max(error, 10.0**MIN_EXPONENT)))
    return decade if decade > AXIS_BREAK else AXIS_BREAK + COMPRESSION * (decade - AXIS_BREAK)


def _draw_key(axes: Axes) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D(
            [], [], linestyle="", marker="x", markersize=5, color=PRINTED_COLOR, mew=1.3, label="Table 4 (◁: 0.0000)"
        ),
        Line2D([], [], linestyle="", marker="o", markersize=4, color=GRAPHDYN_COLOR, label="7 digits, to the nearest"),
        Line2D([], [], color=GRAPHDYN_COLOR, linewidth=3.2, alpha=0.35, label="all 7-digit trials"),
        Line2D([], [], linestyle="", marker="s", markersize=3.5, mfc="none", mec=GRAPHDYN_COLOR, label="exact data"),
    ]
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(-0.12, 1.0), ncols=4, fontsize=8.5, frameon=False,
        handletextpad=0.4, columnspacing=1.4,
    )  # fmt: skip


PARAMETER = (Column("parameter", "name"), Column("source", "name"), *BODY_TABLE_COLUMNS)


def identification_section(found: PaperIdentification) -> Section:
    blocks = Prose(WHY_TABLE_3), _values(found), _errors(found), _picture(found), _trials(found)
    return Section("identification", "Tables 3 and 4: identification", blocks)


def _values(found: PaperIdentification) -> Table:
    rows = []
    for k, (name, printed) in enumerate(TABLE_3.rows.items()):
        rows += [
            Row((name, "printed", *map(printed_text, printed)), rule=True),
            Row(("", "exact data", *map(value_text, found.exact.values[k]))),
            Row(("", "7 digits", *map(value_text, found.rounded[0].values[k]))),
        ]
    caption = (
        "Table 3 [kg, kg m²]; 7 digits: data rounded to the nearest; –: not determined by the data, or not printed. "
    )
    caption += misprints(number for row in TABLE_3.rows.values() for number in row)
    return Table(PARAMETER, tuple(rows), title="Identified parameters", caption=caption, repeated=2, compact=True)


def _errors(found: PaperIdentification) -> Table:
    rows = []
    for k, (name, printed) in enumerate(TABLE_4.rows.items()):
        rows += [
            Row((name, "printed", *map(printed_text, printed)), rule=True),
            Row(("", "exact data", *map(error_text, found.exact.errors[k]))),
            Row(("", "7 digits", *map(value_text, found.rounded[0].errors[k]))),
        ]
    caption = "Table 4 [kg, kg m²], columns in the order of Table 3"
    return Table(PARAMETER, tuple(rows), title="Absolute errors", caption=caption, repeated=2, compact=True)


def _picture(found: PaperIdentification) -> Picture:
    seeds = len(found.rounded) - 2
    caption = (
        "The paper had seven digits of every measurement; how they fell is not known. The band holds two roundings of "
        f"the exact data and {seeds} seeds of noise of one ten-millionth of a channel before the rounding, the dot is "
        "the first of them. Left of the dashed line the axis is compressed."
    )
    return Picture(partial(identification_errors, found=found), caption, title="Error of every parameter")


def _trials(found: PaperIdentification) -> Table:
    """Largest and root mean square error over the entries that the data determine and the paper prints."""
    paper = Row(("Table 4", f"{found.printed_largest:.4f}", f"{found.printed_rms:.4f}", None, None, None))
    exact = [(trial, ".1e") for trial in (found.exact, found.together)]
    rounded = [(trial, ".4f") for trial in found.rounded]
    rows = (
        Row(
            (
                trial.data,
                format(trial.largest(found.compared), form),
                format(trial.rms(found.compared), form),
                trial.rank,
                trial.condition_number,
                ", ".join(trial.undetermined),
            )
        )
        for trial, form in (*exact, *rounded)
    )
    return Table(
        (
            Column("data", "name"),
            Column("largest error", "number"),
            Column("rms", "number"),
            Column("rank of 36", "number"),
            Column("condition number", "number", form=".3g", from_width=WIDE_LINE_CHARACTERS),
            Column("not determined", from_width=WIDE_LINE_CHARACTERS),
        ),
        (paper, *rows),
        title="All trials",
        caption=f"Over the {found.compared.sum()} entries that the data determine and the paper prints [kg, kg m²]",
        compact=True,
        folded=True,
    )
