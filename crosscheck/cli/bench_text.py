"""A benchmark as tables for the terminal: ratios first."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from crosscheck.studies.bench.benchmark import Benchmark
from crosscheck.studies.bench.contender import Measured
from crosscheck.studies.bench.curves import ScalingCurve
from crosscheck.studies.bench.identification import OURS, THEIRS, Identifications
from crosscheck.studies.bench.texts import (
    error_text,
    extrapolated,
    facts,
    floor_text,
    included,
    memory_text,
    ratio_span_text,
    ratio_text,
    span_text,
    threads_text,
    time_text,
    whole_time_text,
)


def text(found: Benchmark) -> Iterator[RenderableType]:
    """Ratios, then times and errors, then curves."""
    for sentence in facts(found):
        yield Text(sentence)
    yield _ratios(found)
    for measured in found.works:
        yield _times(measured)
        for sentence in included(measured):
            yield Text(sentence)
        if measured.name in found.floors:
            yield Text(floor_text(measured, found.floors[measured.name]))
    yield _identification(found.identification)
    for sentence in extrapolated(found.identification):
        yield Text(sentence)
    yield _once(found)
    for curve in found.curves:
        yield _curve(curve)
        for note in curve.notes:
            yield Text(note)


def _ratios(found: Benchmark) -> Table:
    table = _table("How many times as long others take: medians, quartiles of the repeats, fastest repeats")
    _columns(table, "work", "graphdyn's form", "against", right=("threads", "ratio", "quartiles", "fastest"))
    for measured in found.works:
        for k, c in enumerate(measured.comparisons):
            table.add_row(
                measured.title if k == 0 else "",
                c.ours,
                c.theirs,
                str(c.threads),
                ratio_text(c.ratio.median),
                ratio_span_text(c.ratio),
                ratio_text(c.ratio.fastest),
            )
        table.add_section()
    for k, (threads, ratio) in enumerate(found.identification.comparisons):
        title = f"identification, {found.identification.samples} samples" if k == 0 else ""
        row = (ratio_text(ratio.median), ratio_span_text(ratio), ratio_text(ratio.fastest))
        table.add_row(title, OURS, THEIRS, str(threads), *row)
    return table


def _times(measured: Measured) -> Table:
    table = _table(f"{measured.title}: time per sample")
    _columns(table, "", right=("threads", "median", "quartiles", "fastest", "samples", "error"))
    for entry in measured.entries:
        table.add_row(
            entry.name,
            str(entry.threads),
            time_text(entry.times.median),
            span_text(entry.times.spread),
            time_text(entry.times.fastest),
            str(entry.samples),
            error_text(entry),
        )
    return table


def _identification(found: Identifications) -> Table:
    table = _table(f"identification from {found.samples} samples in a fresh process, compiling included, imports not")
    _columns(table, "", right=("threads", "median", "memory beside the recording", "error of predicted torques"))
    for entry in found.entries:
        row = (whole_time_text(entry, found.samples), memory_text(entry.extra_bytes), f"{entry.error:.1e}")
        table.add_row(entry.name, str(entry.threads), *row)
    return table


def _once(found: Benchmark) -> Table:
    table = _table("once per process: imports, and the first call of each verb, which records and compiles")
    _columns(table, "", right=("median", "quartiles", "fastest"))
    once = {f"import {name}": times for name, times in found.imports.items()}
    for name, times in {**once, **found.first_calls}.items():
        table.add_row(name, time_text(times.median), span_text(times.spread), time_text(times.fastest))
    return table


def _curve(curve: ScalingCurve) -> Table:
    table = _table(f"{curve.title}; time per {curve.seconds} (median)")
    _columns(table, curve.x)
    lines = curve.lines
    several = len({line.name for line in lines}) < len(lines)
    for line in lines:
        heading = f"{line.name}, {threads_text(line.threads)}" if several and line.threads else line.name
        table.add_column(heading, justify="right")
    for x in sorted({x for line in lines for x in line.x}):
        cells = [time_text(line.times[line.x.index(x)].median) if x in line.x else "–" for line in lines]
        table.add_row(str(x), *cells)
    if curve.x == "bodies":
        table.add_section()
        growth = ["–" if line.exponent is None else f"n^{line.exponent:.1f}" for line in lines]
        table.add_row("growth", *growth)
    return table


def _table(title: str) -> Table:
    return Table(title=title, title_justify="left")


def _columns(table: Table, *left: str, right: tuple[str, ...] = ()) -> None:
    for column in left:
        table.add_column(column)
    for column in right:
        table.add_column(column, justify="right")
