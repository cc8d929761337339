"""`graphdyn study`: which methods are better, by how much, and how sure that is, as a report; one run as text."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from functools import partial

import numpy as np

from crosscheck.commands.study.comparison_report import comparison_section, headline, overview
from crosscheck.commands.study.distances_report import distances_section
from crosscheck.commands.study.errors_report import errors_section
from crosscheck.commands.study.ranking_report import ranks, trades
from crosscheck.commands.study.record import study_record
from crosscheck.commands.study.recordings import RecordedResults, recordings_headline, recordings_section
from crosscheck.commands.study.scenarios_report import ShownRuns, scenario_sections, shown_runs
from crosscheck.commands.study.words import METHOD_CLASSES, SOURCES_IN_WORDS, listed, percent_text
from crosscheck.report.plain_text import time_text
from crosscheck.report.report import Block, Column, Facts, Note, Notes, Report, Row, Section, Table, Verdict
from crosscheck.study.inputs import NO_INPUTS, StudyInputs
from crosscheck.study.settings.design import DEFAULT_DESIGN, StudyDesign
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.statistics.grid import Grid, grid_of
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, median, order_of_median, share
from crosscheck.study.statistics.outcomes import Measures, StudyOutcomes
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
            result.method if result.redrawn is None else f"{result.method}, other {result.redrawn} {result.repeat}",
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


def study_report(
    outcomes: StudyOutcomes,
    facts: Sequence[tuple[str, str]],
    repeat: Repeat,
    design: StudyDesign = DEFAULT_DESIGN,
    inputs: StudyInputs = NO_INPUTS,
    recorded: RecordedResults | None = None,
) -> Report:
    """The report of what is there of a study.

    facts: names and words of what all scenarios share; inputs: for the numbers in JSON; recorded: results on real
        recordings, besides or alone
    """
    found, recorded = summarized(outcomes, design), recorded or {}
    record = partial(study_record, found, facts, inputs, recorded)
    if not outcomes.scenarios:
        verdict = recordings_headline(recorded)
        sections = Section("study", "", (Facts(tuple(facts)),)), *recordings_section(recorded)
        return Report("Identification methods compared", verdict, sections, record=record)
    grid = grid_of(found.outcomes.scenarios)
    on_page = shown_runs(found)
    sections = (
        Section("study", "", (*_overview(found, grid, facts), *overview(found))),
        *(section for measures in METHOD_CLASSES for section in _class_sections(found, grid, measures, on_page)),
        *recordings_section(recorded),
        *_failures(found, grid, on_page),
        *scenario_sections(found, grid, on_page, repeat),
    )
    return Report(
        "Identification methods compared",
        headline(found),
        sections,
        record=record,
    )


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
        ("drawn anew in every run", listed(SOURCES_IN_WORDS[source] for source in found.design.vary)),
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


def _class_sections(found: StudySummary, grid: Grid, measures: Measures, on_page: ShownRuns) -> Iterator[Section]:
    """Sections of the methods that measure this."""
    columns = found.methods(measures)
    if not columns:
        return
    measured = f"({METHOD_CLASSES[measures][1]} measured)"
    rankings = {error: ranking for (of, error), ranking in found.rankings.items() if of == measures}
    compared = comparison_section(found, measures)
    if compared is not None:
        yield compared
    if rankings:
        yield Section(f"ranks-{measures}", f"Ranks {measured}", tuple(ranks(rankings)))
    yield errors_section(found, grid, measures, on_page)
    if rankings:
        yield Section(f"time-{measures}", f"Accuracy and time {measured}", tuple(trades(found, measures)))
    yield from distances_section(found, measures)
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
