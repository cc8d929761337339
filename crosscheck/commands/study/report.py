"""`graphdyn study`: which methods are better, by how much, and how sure that is, as a report; one run as text."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from functools import partial
from pathlib import Path

import numpy as np

from crosscheck.commands.study.errors_report import errors_section
from crosscheck.commands.study.ranking_report import ranks, trades
from crosscheck.commands.study.record import study_record
from crosscheck.commands.study.scenarios_report import ShownRuns, scenario_sections, shown_runs
from crosscheck.commands.study.words import ERRORS_IN_WORDS, HEADLINE_ERROR, METHOD_CLASSES, percent_text
from crosscheck.report.plain_text import time_text
from crosscheck.report.report import Block, Column, Facts, Note, Notes, Report, Row, Section, Table, Verdict
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.statistics.grid import Grid, grid_of
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, median, order_of_median, share
from crosscheck.study.statistics.outcomes import Measures, read_outcomes
from crosscheck.study.statistics.summary import StudySummary, summarized
from crosscheck.study.tasks import Result, StudyOutcome, StudyTask
from graphdyn.errors import counted


def study_run_report(task: StudyTask, outcome: StudyOutcome) -> Report:
    facts = Facts(tuple((axis.name.replace("_", " "), _text(task.scenario, axis.name)) for axis in fields(Scenario)))
    table = Table(
        (
            Column("method", "name"),
            Column("measures"),
            Column("iterations", "number"),
            Column("simulations", "number", meaning="of the control loop"),
            Column("parameters", "number", form=".2%", meaning="relative distance, by their effect on the torque"),
            Column("torque", "number", form=".2%", meaning="relative error on another motion"),
            Column("trajectory", "number", form=".2g", meaning="relative error of the simulated loop"),
            Column("consistent"),
            Column("processor time", "number", "s", form=".3g"),
            Column("failure", "text"),
        ),
        tuple(_row(*pair) for pair in zip(outcome.results, outcome.seconds, strict=True)),
        failures_first=False,
    )
    found = sum(result.reason is None for result in outcome.results)
    return Report(
        f"Scenario {task.scenario.name}, run {task.run}",
        Verdict("plain", f"{found} of {len(outcome.results)} methods have an answer"),
        (Section("scenario", "", (facts, table)),),
    )


def _text(scenario: Scenario, axis: str) -> str:
    value = getattr(scenario, axis)
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _row(result: Result, seconds: float | None) -> Row:
    yes = None if result.consistent is None else "yes" if result.consistent else "no"
    return Row(
        (
            result.method,
            result.measures,
            result.iterations,
            result.simulations,
            result.parameter_error,
            result.torque_error,
            result.trajectory_error,
            yes,
            seconds,
            result.reason or "",
        ),
        "plain" if result.reason is None else "disagrees",
    )


NUMBER_IN_REASON = re.compile(r"\d[\d.e+-]*")
"""Numbers in a reason."""

SECONDS_PER_HOUR = 3600.0
"""[s]"""

Repeat = Callable[[str, int], Sequence[str]]
"""The arguments that repeat one run with all methods, from the names of scenario and run."""


def study_report(folder: Path, facts: Sequence[tuple[str, str]], repeat: Repeat) -> Report:
    """The report of a finished study.

    folder: with results.parquet, scenarios.parquet and times.parquet
    facts: names and words of what all scenarios share

    Raises as read_outcomes.
    """
    found = summarized(read_outcomes(folder))
    grid = grid_of(found.outcomes.scenarios)
    on_page = shown_runs(found)
    sections = (
        Section("study", "", (*_overview(found, grid, facts), *_leaders(found))),
        *(section for measures in METHOD_CLASSES for section in _class_sections(found, grid, measures, on_page)),
        *_failures(found, grid, on_page),
        *scenario_sections(found, grid, on_page, repeat),
    )
    return Report(
        "Identification methods compared", _verdict(found), sections, record=partial(study_record, found, facts)
    )


def _verdict(found: StudySummary) -> Verdict:
    records = sum(len(scenario.runs) for scenario in found.outcomes.scenarios)
    words = f"{counted(len(found.outcomes.methods), 'method')} on {counted(records, 'record')}"
    ranking = found.rankings.get(("torques", HEADLINE_ERROR))
    if ranking is None:
        return Verdict("plain", words, sentence=f"{words} were compared.")
    what = f"by {ERRORS_IN_WORDS[HEADLINE_ERROR]}, of methods that measure torques"
    leaders = ", ".join(ranking.leaders)
    if len(ranking.leaders) == len(ranking.methods):
        even = f"{words}: none is better than the others."
        return Verdict("plain", words, f"None is better than the first, {ranking.methods[0]}, or worse: {what}.", even)
    alone = "is better than all others" if len(ranking.leaders) == 1 else "lead without a significant difference"
    return Verdict("plain", words, f"{leaders} {alone}, {what}, over all scenarios.", f"{leaders} {alone}.")


def _overview(found: StudySummary, grid: Grid, facts: Sequence[tuple[str, str]]) -> Iterator[Block]:
    scenarios = found.outcomes.scenarios
    runs = sorted({len(scenario.runs) for scenario in scenarios})
    count = counted(len(scenarios), "scenario")
    differing = ", ".join(axis.replace("_", " ") for axis in grid.varying)
    seconds = sum(float(np.nansum(scenario.seconds)) for scenario in scenarios)
    time = f"{seconds / SECONDS_PER_HOUR:.1f} h" if seconds > SECONDS_PER_HOUR else time_text(seconds)
    how_many = counted(runs[0], "run") if len(runs) == 1 else f"{runs[0]} to {runs[-1]} runs"
    items = [
        *facts,
        (
            "grid",
            f"{count}{f' of {differing}' if differing else ''}; {how_many} of each",
        ),
        *([("usual setting", grid.usual)] if grid.usual else []),
        ("confidence", f"{CONFIDENCE_LEVEL:.0%} intervals and tests"),
        ("methods' time", f"{time} of processor time"),
    ]
    yield Facts(tuple(items))
    few, reached = min(runs), order_of_median(min(runs))[1]
    if few == 1:
        yield Notes((Note("one run of a scenario says nothing of its scatter: there are no intervals"),))
    elif reached < CONFIDENCE_LEVEL:
        said = f"intervals of medians reach from the smallest to the largest of {few} runs, which has {reached:.1%}"
        yield Notes((Note(said),))


def _leaders(found: StudySummary) -> Iterator[Block]:
    """Who is ahead by each error."""
    rows = [
        Row((ERRORS_IN_WORDS[error], METHOD_CLASSES[measures][1], ", ".join(ranking.leaders), len(ranking.methods),
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
    )


def _class_sections(found: StudySummary, grid: Grid, measures: Measures, on_page: ShownRuns) -> Iterator[Section]:
    """Sections of the methods that measure this."""
    columns = found.methods(measures)
    if not columns:
        return
    measured = f"({METHOD_CLASSES[measures][1]} measured)"
    rankings = {error: ranking for (of, error), ranking in found.rankings.items() if of == measures}
    if rankings:
        yield Section(f"ranks-{measures}", f"Ranks {measured}", tuple(ranks(rankings)))
    yield errors_section(found, grid, measures, on_page)
    if rankings:
        yield Section(f"time-{measures}", f"Accuracy and time {measured}", tuple(trades(found, rankings)))
    yield Section(f"answers-{measures}", f"Answers {measured}", (_answers(found, columns),))


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
            Column(
                "upper end", "number", form=time_text, meaning=f"of the {CONFIDENCE_LEVEL:.0%} interval", from_width=100
            ),
        ),
        tuple(rows),
        caption=f"Over all scenarios; shares with {CONFIDENCE_LEVEL:.0%} intervals. "
        "Real bodies: all links physically consistent.",
    )


def _failures(found: StudySummary, grid: Grid, on_page: ShownRuns) -> Iterator[Section]:
    """Who failed where, and why; one click from it to the first such run."""
    rows = []
    for number in grid.order():
        outcomes = found.outcomes.scenarios[number]
        alike: dict[str, list[tuple[int, int]]] = defaultdict(list)
        for place, reason in sorted(outcomes.reasons.items()):
            alike[NUMBER_IN_REASON.sub("0", reason)].append(place)
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
        )
        yield Section("failures", "Failures", (table,))
