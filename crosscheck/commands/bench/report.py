"""`graphdyn bench`: graphdyn beside other libraries, as a report. Ratios first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from markupsafe import Markup

from crosscheck.bench.benchmark import Benchmark
from crosscheck.bench.contender import MeasuredWork, SpeedRatio
from crosscheck.bench.identification import GRAPHDYN_STREAMED, PINOCCHIO_LSTSQ, IdentificationRun, Identifications
from crosscheck.bench.machine.clocks import clock_of
from crosscheck.bench.machine.disturbance import MAX_COPY_SLOWDOWN, Load
from crosscheck.bench.machine.floor import Floor
from crosscheck.bench.machine.timing import MAX_QUARTILE_RATIO, Times
from crosscheck.commands.bench.curves import curve_section
from crosscheck.commands.bench.record import record
from crosscheck.report.pictures.svg import BAR, FAINT_COLOR, INK, picture
from crosscheck.report.plain_text import ratio_span_text, ratio_text, span_text, threads_text, time_text
from crosscheck.report.report import (
    WIDE_LINE_CHARACTERS,
    Block,
    Column,
    Facts,
    Note,
    Notes,
    Picture,
    Prose,
    Report,
    Row,
    Section,
    Table,
    Verdict,
)
from graphdyn.errors import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, ROW, AXIS = 7.6, 0.24, 0.45
"""Sizes of the picture, of one bar, of the axis with its title [inches]."""


def ratio_bars(key: str, comparisons: Sequence[SpeedRatio]) -> Markup:
    """One bar per comparison, with the quartiles as a line."""
    label = "Times as long as graphdyn: " + "; ".join(f"{_name(c)}: {ratio_text(c.ratio.median)}" for c in comparisons)
    return picture(key, label, (WIDTH, AXIS + ROW * len(comparisons)), lambda axes: _draw(axes, comparisons))


def _name(comparison: SpeedRatio) -> str:
    return f"{comparison.theirs} / {comparison.ours}, {threads_text(comparison.threads)}"


def _draw(axes: Axes, comparisons: Sequence[SpeedRatio]) -> None:
    axes.set_axis_off()
    height = AXIS + ROW * len(comparisons)
    inner = axes.inset_axes((0.56, AXIS / height, 0.4, 1 - AXIS / height))
    inner.spines[["top", "right"]].set_visible(False)
    inner.tick_params(labelsize=7.5, length=2, color=INK)
    inner.grid(color=FAINT_COLOR, linewidth=0.5)
    inner.set_axisbelow(True)
    places = range(len(comparisons))
    inner.barh(places, [c.ratio.median for c in comparisons], color=BAR, height=0.62, left=0)
    for place, c in zip(places, comparisons, strict=True):
        inner.plot(c.ratio.quartiles, (place, place), color=INK, linewidth=1)
        inner.annotate(
            ratio_text(c.ratio.median),
            (max(c.ratio.median, c.ratio.quartiles[1]), place),
            xytext=(3, 0),
            textcoords="offset points",
            fontsize=7.5,
            va="center",
        )
    inner.set_yticks(places, [_name(c) for c in comparisons])
    medians = [c.ratio.median for c in comparisons]
    inner.set(xscale="log", xlim=(min(0.5, *medians) / 2, 10 * max(medians)))
    inner.invert_yaxis()
    inner.axvline(1, color=INK, linewidth=0.8)
    inner.xaxis.set_major_formatter(lambda value, _: f"{value:g}×")
    inner.xaxis.set_minor_formatter(lambda value, _: "")
    inner.set_xlabel("times as long as graphdyn; right of the line graphdyn is faster", fontsize=8, color=INK)


ALL_COLUMNS_CHARACTERS = 100
"""Characters of a line from which times have all their columns."""

RATIO_NOTE = (
    "How many times as long others take as graphdyn's form of the same number of threads. Above 1× graphdyn is faster, "
    "as in {faster} of {all} comparisons."
)
ORDER_NOTE = (
    "All contenders of a work took turns in one run. Median and quartiles are those of the quotients of repeats that "
    "followed each other. Times of one thread are processor time, which does not pass while other programs have "
    "the core; those of several threads are wall time."
)


def bench_report(found: Benchmark) -> Report:
    return Report(
        f"Benchmark on {Path(found.robot).name}",
        _verdict(found),
        (
            Section("ratios", "Times as long as graphdyn", _ratios(found)),
            Section("run", "Robot, libraries and machine", (Facts(tuple(facts(found))),)),
            *(_work(measured, found.floors.get(measured.name)) for measured in found.works),
            _identification(found.identification),
            Section("once", "Once per process", (_once(found),)),
            *map(curve_section, found.curves),
        ),
        record=partial(record, found),
    )


def _verdict(found: Benchmark) -> Verdict:
    """A disagreement; or that ratios are not to be trusted; or that all is well."""
    if found.agrees:
        agrees = "Every answer of graphdyn is within its bound of Pinocchio's."
        every = [c for _, comparisons in _groups(found) for c in comparisons]
        doubtful = sum(not c.trusted for c in every)
        if doubtful:
            words = f"not to be trusted: {doubtful} of {len(every)} ratios"
            sentence = f"{doubtful} of {len(every)} ratios are not to be trusted."
            return Verdict("undecided", words, f"Measure on a quiet machine. {agrees}", sentence)
        return Verdict("agrees", "agrees", "All ratios can be trusted.", agrees)
    wrong = ", ".join(measured.title for measured in found.works if not measured.agrees)
    return Verdict(
        "disagrees",
        "DISAGREES",
        f"An answer is further from Pinocchio's than its bound: {wrong}.",
        "graphdyn and Pinocchio disagree.",
    )


def _groups(found: Benchmark) -> list[tuple[str, tuple[SpeedRatio, ...]]]:
    """Titles of works, and their ratios."""
    identification = found.identification
    return [
        *((measured.title, measured.comparisons) for measured in found.works),
        (f"identification, {counted(identification.samples, 'sample')}", _comparisons(identification)),
    ]


def facts(found: Benchmark) -> Iterator[tuple[str, str]]:
    """What a reader must know before the numbers."""
    yield (
        "robot",
        f"{found.robot}: {counted(found.model.n_bodies, 'body', 'bodies')}, {found.samples} random states, "
        f"seed {found.seed}",
    )
    yield "repeats", f"{found.effort.repeats}, in turns"
    yield (
        "load",
        " ".join(f"{_load_text(load)} {when}" for load, when in zip(found.load, ("before,", "after"), strict=True)),
    )
    slowdown = sorted(found.copy_slowdown.values())
    yield (
        "caches",
        f"a copy of 4 MB within them, in turns with the works, took {ratio_span_text((slowdown[0], slowdown[-1]))} as "
        "long as at best (medians of the works)",
    )
    yield "cores", f"{found.cores}, compared with {' and '.join(map(threads_text, found.threads))}"
    yield from found.peers.items()
    for library, reason in found.left_out.items():
        yield library, f"left out: {reason}"
    if found.backend != "llvm":
        yield "graphdyn", "runs on NumPy arrays here: nothing is compiled"
    for machine in found.machine:
        yield (
            f"machine, {threads_text(machine.threads)}",
            f"{machine.operations / 1e9:.3g} GFlop/s and {machine.instructions / 1e9:.3g} G instructions/s in vectors "
            f"of {machine.lanes}, "
            f"{machine.bandwidth / 1e9:.3g} GB/s at best",
        )


def _load_text(load: Load) -> str:
    if load.programs is None:
        return "not known"
    return f"{load.programs:.2g} programs on {load.cores} cores"


def _distrust(found: Benchmark, every: Sequence[SpeedRatio]) -> Iterator[Block]:
    """Why ratios are not to be trusted, and where other programs used the caches."""
    doubtful = sum(not c.trusted for c in every)
    if doubtful:
        yield Notes(
            tuple(map(Note, _reasons(found, every))),
            title=f"Not to be trusted: {doubtful} of {len(every)} ratios (marked ?); measure on a quiet machine",
        )
    titles = {measured.name: measured.title for measured in found.works}
    shared = [
        f"{titles[name]}: a copy within the caches took {ratio_text(slowdown)} as long as at best"
        for name, slowdown in found.copy_slowdown.items()
        if slowdown > MAX_COPY_SLOWDOWN
    ]
    if shared:
        yield Notes(tuple(map(Note, shared)), title="Other programs used the caches, at the cost of the fastest forms")


def _reasons(found: Benchmark, every: Sequence[SpeedRatio]) -> Iterator[str]:
    """Reasons of ratios that are not to be trusted; a busy machine spoils those of wall times."""
    wall = any(c.clock == "wall" and not c.undisturbed for c in every)
    if wall and found.load[0].busy:
        yield f"the machine was busy before the benchmark began: {_load_text(found.load[0])}"
    for x in found.works:
        if not x.undisturbed and any(c.clock == "wall" for c in x.comparisons):
            yield (
                f"{x.title}: runs on one thread had a core for {x.core_share:.0%} of the time, so that wall times are "
                "too long"
            )
    scattered = sum(not c.ratio.steady for c in every)
    if scattered:
        yield f"{scattered} ratios have an upper quartile of more than {MAX_QUARTILE_RATIO} times the lower one"


def _ratios(found: Benchmark) -> tuple[Block, ...]:
    groups = _groups(found)
    every = [c for _, comparisons in groups for c in comparisons]
    faster = sum(c.ratio.median > 1 for c in every)
    table = Table(
        (
            Column("work"),
            Column("graphdyn", form=lambda name: name.removeprefix("graphdyn").strip()),
            Column("against"),
            Column("threads", "number"),
            Column("median", "number", meaning="times as long as graphdyn; ?: not to be trusted"),
            Column("quartiles", "number", form=ratio_span_text, meaning="of repeats that followed each other"),
            Column(
                "fastest", "number", form=ratio_text, meaning="of the fastest repeats", from_width=WIDE_LINE_CHARACTERS
            ),
        ),
        tuple(row for title, comparisons in groups for row in _ratio_rows(title, comparisons)),
        caption="Times as long as graphdyn: median and quartiles over the repeats, and of the fastest repeats",
        compact=True,
    )
    which_way = Prose(RATIO_NOTE.format(faster=faster, all=len(every)))
    return which_way, *_distrust(found, every), table, Prose(ORDER_NOTE, soft=True)


def _ratio_rows(title: str, comparisons: Sequence[SpeedRatio]) -> Iterator[Row]:
    """Names of work and form where they change."""
    before = None
    for k, c in enumerate(comparisons):
        names = "" if k else title, c.ours if c.ours != before else "", c.theirs
        median = f"{'' if c.trusted else '? '}{ratio_text(c.ratio.median)}"
        yield Row((*names, c.threads, median, c.ratio.quartiles, c.ratio.fastest), rule=not k)
        before = c.ours


def _comparisons(found: Identifications) -> tuple[SpeedRatio, ...]:
    return tuple(
        SpeedRatio(GRAPHDYN_STREAMED, PINOCCHIO_LSTSQ, threads, clock_of(threads), ratio)
        for threads, ratio in found.comparisons
    )


def _work(measured: MeasuredWork, floor: Floor | None) -> Section:
    state = Verdict("agrees", "agrees") if measured.agrees else Verdict("disagrees", "DISAGREES")
    times = Table(
        (
            Column("", "name"),
            Column("threads", "number"),
            Column("median", "number", form=time_text),
            Column("quartiles", "number", form=span_text),
            Column("fastest", "number", form=time_text, from_width=ALL_COLUMNS_CHARACTERS),
            Column("samples", "number", from_width=ALL_COLUMNS_CHARACTERS),
            Column("error", "number", form=".1e"),
        ),
        tuple(
            Row((e.name, e.threads, e.times.median, e.times.quartiles, e.times.fastest, e.samples, e.error))
            for e in measured.entries
        ),
        caption="Time per sample, and largest error against Pinocchio",
    )
    title = f"{measured.title[:1].upper()}{measured.title[1:]}"
    return Section(measured.name, title, (*_bars(measured.comparisons), times, _notes(measured, floor)), state)


def _bars(comparisons: tuple[SpeedRatio, ...]) -> tuple[Block, ...]:
    if not comparisons:
        return ()
    return (Picture(partial(ratio_bars, comparisons=comparisons), "Bars: medians, black: quartiles.", on=("page",)),)


def _notes(measured: MeasuredWork, floor: Floor | None) -> Facts:
    """What the times of each contender are of, what errors are relative to, what the machine could do."""
    items = {entry.name: entry.included for entry in measured.entries}
    items["errors"] = (
        f"largest of all samples judged, against Pinocchio, relative to: {measured.scale}; "
        f"graphdyn agrees up to {measured.bound:.0e}"
    )
    above = measured.above_limit
    if floor is not None and above is not None:
        items["at best"] = (
            f"{floor.operations} floating-point operations in {floor.instructions} instructions, and {floor.bytes} "
            f"bytes, per sample take at least {time_text(floor.seconds)}; measured {ratio_text(above.median)} as much "
            f"(quartiles {ratio_span_text(above.quartiles)}), at best {ratio_text(above.fastest)}"
        )
    return Facts(tuple(items.items()), title="What the times include, and what errors are relative to", folded=True)


def _identification(found: Identifications) -> Section:
    words = Prose(
        f"From {found.samples} samples to the inertial parameters, each in a fresh process; the clock starts when "
        "libraries are imported and the recording is in memory, so compiling is included."
    )
    table = Table(
        (
            Column("", "name"),
            Column("threads", "number"),
            Column("median", "number"),
            Column("memory", "number", form=lambda extra: f"{extra / 1e6:.0f} MB", meaning="beside the recording"),
            Column("error", "number", form=".1e", meaning="of torques predicted at other states"),
        ),
        tuple(Row((e.name, e.threads, _whole_time(e, found.samples), e.extra_bytes, e.error)) for e in found.entries),
        caption="Time of the whole recording, peak of the memory beside it, largest error of predicted torques",
    )
    fewer = {entry.name: entry.samples for entry in found.entries if entry.samples < found.samples}
    notes = [
        (
            name,
            f"measured on {count} samples and extrapolated in proportion to {found.samples}; its memory is that of "
            f"{counted(count, 'sample')}",
        )
        for name, count in fewer.items()
    ]
    blocks = words, *_bars(_comparisons(found)), table, Facts(tuple(notes))
    return Section("identification", "Identification", blocks)


def _whole_time(entry: IdentificationRun, samples: int) -> str:
    """Time of the whole recording; extrapolated where fewer samples were worked on."""
    prefix = "" if entry.samples == samples else "≈ "
    return prefix + time_text(entry.times.median * samples)


def _once(found: Benchmark) -> Table:
    once: dict[str, Times] = {f"import {name}": times for name, times in found.imports.items()}
    return Table(
        (
            Column("", "name"),
            Column("median", "number", form=time_text),
            Column("quartiles", "number", form=span_text),
            Column("fastest", "number", form=time_text),
        ),
        tuple(Row((n, t.median, t.quartiles, t.fastest)) for n, t in {**once, **found.first_calls}.items()),
        caption="Imports, and the first call of each verb, which records and compiles",
    )
