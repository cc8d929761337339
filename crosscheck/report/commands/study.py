"""`graphdyn study`: which methods are better, by how much, and how sure that is, as a report."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from crosscheck.report.commands.study_errors import errors_section
from crosscheck.report.commands.study_record import study_record
from crosscheck.report.commands.study_scenarios import ShownRuns, scenario_sections, shown_runs
from crosscheck.report.commands.study_words import CLASSES, ERRORS_IN_WORDS, HEADLINE, interval_text, percent_text
from crosscheck.report.durations import time_text
from crosscheck.report.pictures.study_pareto import Trade, study_pareto
from crosscheck.report.pictures.study_ranks import study_ranks
from crosscheck.report.report import (
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
from crosscheck.studies.identification.statistics.grid import Grid, grid_of
from crosscheck.studies.identification.statistics.intervals import LEVEL, median, order_of_median, share
from crosscheck.studies.identification.statistics.outcomes import Measures, read_outcomes
from crosscheck.studies.identification.statistics.ranking import Ranking
from crosscheck.studies.identification.statistics.summary import StudySummary, summarised

NUMBER = re.compile(r"\d[\d.e+-]*")
"""In a reason."""

Repeat = Callable[[str, int], Sequence[str]]
"""The arguments that repeat one run with all methods, from the names of scenario and run."""

HOW_RANKED = (
    "On every record the method with the smallest error has rank 1; errors that are equal up to rounding share a rank, "
    "and methods that failed, or whose error is not finite, share the last one; records on which all did are left out. "
    "Bars: {level:.0%} intervals of the mean rank by bootstrap over runs. Thick lines join methods that are not told "
    "apart: their mean ranks are closer than Nemenyi's critical distance, or Friedman's test finds no difference at "
    "all. Blue: none is better than these. Every scenario weighs the same, and failures count, so that the order by "
    "ranks can differ from that by mean errors, which are those of records that both methods have an answer for."
)
HOW_TRADED = (
    "Geometric mean of the error relative to the first of the ranking, over the records that both have an answer for, "
    "with its {level:.0%} interval; median processor time of all runs. Hollow: failed on some records, which are "
    "not in this mean. The line joins methods than which no other is faster and more accurate."
)


def study_report(folder: Path, facts: Sequence[tuple[str, str]], repeat: Repeat) -> Report:
    """The report of a finished study.

    folder: with results.parquet, scenarios.parquet and times.parquet
    facts: names and words of what all scenarios share

    Raises as read_outcomes.
    """
    found = summarised(read_outcomes(folder))
    grid = grid_of(found.outcomes.scenarios)
    on_page = shown_runs(found)
    sections = (
        Section("study", "", (*_overview(found, grid, facts), *_leaders(found))),
        *(section for measures in CLASSES for section in _class_sections(found, grid, measures, on_page)),
        *_failures(found, grid, on_page),
        *scenario_sections(found, grid, on_page, repeat),
    )
    return Report(
        "Identification methods compared", _verdict(found), sections, record=partial(study_record, found, facts)
    )


def _verdict(found: StudySummary) -> Verdict:
    records = sum(len(scenario.runs) for scenario in found.outcomes.scenarios)
    words = f"{len(found.outcomes.methods)} methods on {records} records"
    ranking = found.rankings.get(("torques", HEADLINE))
    if ranking is None:
        return Verdict("plain", words)
    what = f"by {ERRORS_IN_WORDS[HEADLINE]}, of methods that measure torques"
    leaders = ", ".join(ranking.leaders)
    if len(ranking.leaders) == len(ranking.methods):
        return Verdict("plain", words, f"None is better than the first, {ranking.methods[0]}, or worse: {what}.")
    alone = "is better than all others" if len(ranking.leaders) == 1 else "lead and are not told apart"
    return Verdict("plain", words, f"{leaders} {alone}, {what}, over all scenarios.")


def _overview(found: StudySummary, grid: Grid, facts: Sequence[tuple[str, str]]) -> Iterator[Block]:
    scenarios = found.outcomes.scenarios
    runs = sorted({len(scenario.runs) for scenario in scenarios})
    count = f"{len(scenarios)} scenario{'' if len(scenarios) == 1 else 's'}"
    differing = ", ".join(axis.replace("_", " ") for axis in grid.varying)
    seconds = sum(float(np.nansum(scenario.seconds)) for scenario in scenarios)
    items = [
        *facts,
        ("grid", f"{count}{f' of {differing}' if differing else ''}; {_range(runs)} runs of each"),
        *([("usual setting", grid.usual)] if grid.usual else []),
        ("confidence", f"{LEVEL:.0%} intervals and tests"),
        ("methods' time", f"{time_text(seconds)} of processor time"),
    ]
    yield Facts(tuple(items))
    few, reached = min(runs), order_of_median(min(runs))[1]
    if reached < LEVEL:
        said = f"intervals of medians reach from the smallest to the largest of {few} runs, which has {reached:.1%}"
        yield Notes((Note(said),))


def _range(numbers: Sequence[int]) -> str:
    return str(numbers[0]) if len(numbers) == 1 else f"{numbers[0]} to {numbers[-1]}"


def _leaders(found: StudySummary) -> Iterator[Block]:
    """Who is ahead by each error."""
    rows = [
        Row((ERRORS_IN_WORDS[error], CLASSES[measures][1], ", ".join(ranking.leaders), len(ranking.methods),
             ranking.records, ranking.probability, ranking.distance))
        for (measures, error), ranking in found.rankings.items()
    ]  # fmt: skip
    yield Table(
        (
            Column("by", "name"),
            Column("measured"),
            Column("none is better than", "text"),
            Column("of", "number", "methods"),
            Column("records", "number"),
            Column("Friedman p", "number", form=".2g", meaning="probability of such ranks if all methods were alike"),
            Column("critical distance", "number", form=".2f", meaning="of mean ranks, Nemenyi"),
        ),
        tuple(rows),
        title="Over all scenarios",
        failures_first=False,
    )


def _class_sections(found: StudySummary, grid: Grid, measures: Measures, on_page: ShownRuns) -> Iterator[Section]:
    """Sections of the methods that measure this."""
    columns = found.methods(measures)
    if not columns:
        return
    measured = f"({CLASSES[measures][1]} measured)"
    rankings = {error: ranking for (of, error), ranking in found.rankings.items() if of == measures}
    if rankings:
        yield Section(f"ranks-{measures}", f"Ranks {measured}", tuple(_ranks(rankings)))
    yield errors_section(found, grid, measures, on_page)
    if rankings:
        yield Section(f"time-{measures}", f"Accuracy and time {measured}", tuple(_trades(found, rankings)))
    yield Section(f"answers-{measures}", f"Answers {measured}", (_answers(found, columns),))


def _ranks(rankings: dict[str, Ranking]) -> Iterator[Block]:
    for error, ranking in rankings.items():
        what = ERRORS_IN_WORDS[error]
        yield Picture(partial(study_ranks, ranking=ranking, what=what), title=f"By {what}", wide=False, on=("page",))
    yield Prose(HOW_RANKED.format(level=LEVEL), soft=True, on=("page",))
    first = next(iter(rankings.values()))
    of = {error: {name: k for k, name in enumerate(ranking.methods)} for error, ranking in rankings.items()}
    rows = []
    for name in first.methods:
        cells: list[object] = [name]
        for error, ranking in rankings.items():
            k = of[error][name]
            cells += [
                interval_text(ranking.mean[k], ranking.low[k], ranking.high[k], ".2f"),
                interval_text(ranking.ratio[k], ranking.ratio_low[k], ranking.ratio_high[k], ".3g") if k else "1",
            ]
        rows.append(Row((*cells, first.failures[first.methods.index(name)] or None)))
    columns = [
        column
        for error in rankings
        for column in (
            Column(f"rank by {ERRORS_IN_WORDS[error]}", "number"),
            Column("error / that of the first", "number", meaning="geometric mean where both have an answer"),
        )
    ]
    yield Table(
        (Column("method", "name"), *columns, Column("failed", "number", meaning="records on which it ranks last")),
        tuple(rows),
        caption=f"Over all scenarios, with {LEVEL:.0%} intervals by bootstrap over runs",
        failures_first=False,
    )


def _trades(found: StudySummary, rankings: dict[str, Ranking]) -> Iterator[Block]:
    seconds = {
        method.name: np.concatenate([scenario.seconds[:, k] for scenario in found.outcomes.scenarios])
        for k, method in enumerate(found.outcomes.methods)
    }
    for error, ranking in rankings.items():
        trades = [
            Trade(
                name, median(seconds[name][~np.isnan(seconds[name])]).value, float(ranking.ratio[k]),
                float(ranking.ratio_low[k]), float(ranking.ratio_high[k]), ranking.failures[k] == 0,
            )
            for k, name in enumerate(ranking.methods)
        ]  # fmt: skip
        drawn = [trade for trade in trades if np.isfinite(trade.ratio) and trade.seconds > 0]
        if drawn:
            what, best = ERRORS_IN_WORDS[error], ranking.methods[0]
            draw = partial(study_pareto, trades=drawn, what=what, best=best)
            yield Picture(draw, title=f"By {what}", on=("page",), folded=error != HEADLINE)
    yield Prose(HOW_TRADED.format(level=LEVEL), soft=True, on=("page",))


def _answers(found: StudySummary, columns: Sequence[int]) -> Table:
    """Shares, iterations and times of the methods over all scenarios."""
    rows = []
    for k in columns:
        of = [scenario.methods[k] for scenario in found.scenarios]
        runs, answers = sum(one.runs for one in of), sum(one.found for one in of)
        known = [scenario.consistent[scenario.found[:, k], k] for scenario in found.outcomes.scenarios]
        real = np.concatenate(known)
        real = real[~np.isnan(real)]
        failed, consistent = share(runs - answers, runs), share(int(real.sum()), len(real))
        iterations, simulations = (
            np.concatenate([getattr(one, what)[:, k] for one in found.outcomes.scenarios])
            for what in ("iterations", "simulations")
        )
        times = np.concatenate([one.seconds[:, k] for one in found.outcomes.scenarios])
        time = median(times[~np.isnan(times)])
        rows.append(
            Row(
                (
                    found.outcomes.methods[k].name,
                    percent_text(failed),
                    percent_text(consistent),
                    *(float(np.nanmedian(x)) if np.isfinite(x).any() else None for x in (iterations, simulations)),
                    float(np.nanmax(iterations)) if np.isfinite(iterations).any() else None,
                    time.value,
                    time.high,
                )
            )
        )
    return Table(
        (
            Column("method", "name"),
            Column("failed", "number", "%", meaning="share of the records, Wilson's interval"),
            Column("real bodies", "number", "%", meaning="share of the answers, Wilson's interval"),
            Column("iterations", "number", form=".3g", meaning="median"),
            Column("simulations", "number", form=".3g", meaning="median"),
            Column("most iterations", "number", form=".3g", from_width=100),
            Column("time", "number", form=time_text, meaning="median of the processor time"),
            Column("upper end", "number", form=time_text, meaning=f"of the {LEVEL:.0%} interval", from_width=100),
        ),
        tuple(rows),
        caption=f"Over all scenarios; shares with {LEVEL:.0%} intervals. Real bodies: all links physically consistent.",
        failures_first=False,
    )


def _failures(found: StudySummary, grid: Grid, on_page: ShownRuns) -> Iterator[Section]:
    """Who failed where, and why; one click from it to the first such run."""
    rows = []
    for number in grid.order():
        outcomes = found.outcomes.scenarios[number]
        alike: dict[str, list[tuple[int, int]]] = defaultdict(list)
        for place, reason in sorted(outcomes.reasons.items()):
            alike[NUMBER.sub("0", reason)].append(place)
        for places in alike.values():
            times = Counter(found.outcomes.methods[k].name for _, k in places)
            methods = ", ".join(f"{name} {count}" for name, count in times.items())
            if len(times) == outcomes.taken.sum() and len(set(times.values())) == 1:
                methods = f"all methods {len(places) // len(times)}"
            row, k = places[0]
            cells = (f"run {outcomes.runs[row]}", grid.words(outcomes), methods, outcomes.reasons[row, k])
            rows.append(Row(cells, link=on_page.key(number, row)))
    if rows:
        table = Table(
            (Column("first", "name"), Column("scenario"), Column("runs"), Column("reason")),
            tuple(rows),
            caption="Methods with the number of their runs; reasons that differ in numbers alone are one.",
            failures_first=False,
        )
        yield Section("failures", "Failures", (table,))
