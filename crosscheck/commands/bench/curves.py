"""Times against the size of a batch, the number of bodies or of threads, as a section of a report."""

from __future__ import annotations

from typing import Literal

import numpy as np

from crosscheck.bench.curves import Line, ScalingCurve
from crosscheck.bench.forms.graphdyn_forms import DENSE_NAME
from crosscheck.report.plain_text import span_text, threads_text, time_text
from crosscheck.report.report import Block, Column, Panel, Plot, Prose, Row, Section, Series, Table
from graphdyn.layout import Array

CURVE_HEIGHT = 1.7
"""Height of a plot, relative to others."""


def curve_section(curve: ScalingCurve) -> Section:
    """Lines for the page, medians on the terminal, medians with their quartiles folded on the page."""
    notes = "; ".join(curve.notes)
    words = (Prose(f"{notes[:1].upper()}{notes[1:]}."),) if notes else ()
    blocks: tuple[Block, ...] = (*words, _plot(curve), _medians(curve), _all_times(curve))
    return Section(curve.name, f"{curve.title[:1].upper()}{curve.title[1:]}", blocks)


def _xs(curve: ScalingCurve) -> list[int]:
    return sorted({x for line in curve.lines for x in line.x})


def _plot(curve: ScalingCurve) -> Plot:
    xs = _xs(curve)
    lines = tuple(_series(line, xs, k) for k, line in enumerate(curve.lines))
    caption = (
        f"Time per {curve.seconds_of} against {curve.x}, lower is faster; medians, upright bars: quartiles. Full "
        f"lines: graphdyn, dashed: others. {_growth(curve)}"
    )
    return Plot(
        x=np.array(xs, dtype=float),
        x_title=curve.x,
        panels=(Panel(f"time per {curve.seconds_of}", lines, "s", log=True, height=CURVE_HEIGHT, prefixes=True),),
        label=f"{curve.title}, logarithmic axes. " + "; ".join(map(_reach, curve.lines)),
        caption=caption.strip(),
        log_x=True,
        on=("page",),
    )


def _series(line: Line, xs: list[int], k: int) -> Series:
    """Full lines are graphdyn, dashed ones others."""

    def over_all(values: list[float]) -> Array:
        at = dict(zip(line.x, values, strict=True))
        return np.array([at.get(x, np.nan) for x in xs])

    low, high = (over_all([times.quartiles[end] for times in line.times]) for end in (0, 1))
    ours = line.name.startswith("graphdyn") or line.name == DENSE_NAME
    style: Literal["line", "dashed"] = "line" if ours else "dashed"
    return Series(_name(line), over_all([t.median for t in line.times]), style, k, low=low, high=high)


def _name(line: Line) -> str:
    return f"{line.name}, {threads_text(line.threads)}" if line.threads else line.name


def _reach(line: Line) -> str:
    ends = " to ".join(time_text(line.times[k].median) for k in (0, -1))
    return f"{_name(line)}: {ends} from {line.x[0]} to {line.x[-1]}"


def _growth(curve: ScalingCurve) -> str:
    """How the times grow with the number of bodies, in words."""
    grown = [f"{line.name} as n^{line.exponent:.1f}" for line in curve.lines if line.exponent is not None]
    return f"Growth: {', '.join(grown)}." if curve.x == "bodies" and grown else ""


def _medians(curve: ScalingCurve) -> Table:
    columns = (Column(curve.x, "name"), *(Column(_name(line), "number", form=_cell) for line in curve.lines))
    medians = [{x: times.median for x, times in zip(line.x, line.times, strict=True)} for line in curve.lines]
    rows = [Row((str(x), *(of_line.get(x) for of_line in medians))) for x in _xs(curve)]
    if curve.x == "bodies":
        growth = (None if line.exponent is None else f"n^{line.exponent:.1f}" for line in curve.lines)
        rows.append(Row(("growth", *growth), rule=True))
    return Table(columns, tuple(rows), caption=f"Time per {curve.seconds_of} (median)", on=("text",))


def _cell(value: float | str) -> str:
    return value if isinstance(value, str) else time_text(value)


def _all_times(curve: ScalingCurve) -> Table:
    return Table(
        (
            Column("", "name"),
            Column(curve.x, "number"),
            Column("median", "number", form=time_text),
            Column("quartiles", "number", form=span_text),
            Column("fastest", "number", form=time_text),
        ),
        tuple(
            Row((_name(line) if k == 0 else "", x, times.median, times.quartiles, times.fastest), rule=k == 0)
            for line in curve.lines
            for k, (x, times) in enumerate(zip(line.x, line.times, strict=True))
        ),
        title="All times",
        caption=f"Time per {curve.seconds_of}",
        on=("page",),
        folded=True,
    )
