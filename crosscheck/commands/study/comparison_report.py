"""Methods compared two by two, as the headline and as tables of the report of a study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from crosscheck.commands.study.words import (
    ERRORS_IN_WORDS,
    HEADLINE_ERROR,
    METHOD_CLASSES,
    SOURCES_IN_WORDS,
    interval_text,
    listed,
)
from crosscheck.report.report import Block, Column, Note, Notes, Prose, Row, Section, Table
from crosscheck.report.report import Verdict as Headline
from crosscheck.study.settings.design import SOURCES, StudyDesign
from crosscheck.study.statistics.comparison import SAME_METHOD_TOLERANCE, MethodPair, PairedComparison
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL
from crosscheck.study.statistics.outcomes import Measures
from crosscheck.study.statistics.summary import StudySummary
from graphdyn.errors import counted

COMPARISON_NOTE = (
    "Each run has one number for two methods: the mean over its scenarios of the logarithm of their errors' ratio. "
    "Better and worse: by Wilcoxon's signed ranks over the runs, with Holm's correction for all {pairs}, at a level of "
    "{level:.0%}. Ratio: geometric mean with Student's interval, simultaneous over all pairs. Equivalent: the whole "
    "interval is within {region:g} %. A run in which one method alone has failed counts as the largest difference, and "
    "leaves the interval open. What a study can show is the ratio that it would find with a probability of 90 %."
)


def headline(found: StudySummary) -> Headline:
    """Which methods are best, by how much, how sure that is, and for what it holds."""
    records = sum(len(scenario.runs) for scenario in found.outcomes.scenarios)
    words = f"{counted(len(found.outcomes.methods), 'method')} on {counted(records, 'record')}"
    comparison = found.comparisons.get(("torques", HEADLINE_ERROR))
    if comparison is None or not comparison.pairs:
        return Headline("plain", words, sentence=f"{words} were compared.")
    first, *others = _sentences(comparison, found.design)
    condition = _condition(found)
    return Headline("plain", words, " ".join([first, *others, condition]), f"{first} {condition}".strip())


def _sentences(comparison: PairedComparison, design: StudyDesign) -> Iterator[str]:
    reference, pairs = comparison.reference, counted(len(comparison.pairs), "comparison")
    sure = f"{CONFIDENCE_LEVEL:.0%} sure over {pairs} in {counted(comparison.runs, 'run')}"
    what = ERRORS_IN_WORDS[HEADLINE_ERROR]
    if comparison.runs < comparison.fewest:
        yield f"Nothing is decided: {_too_few(comparison)}."
        return
    better = comparison.of("better")
    if better:
        best, *more = better
        of = f"best of the {len(better)} methods that are better" if more else "better"
        yield f"{best.method} is {of} than {reference}: {_how_much(best, what)}, {sure}."
        if more:
            yield f"The others are {listed(f'{one.method} with {ratio_text(one)}' for one in more)}."
    else:
        yield f"No method is shown to be better than {reference} by {what}, {sure}."
    equivalent, worse, undecided = (comparison.of(verdict) for verdict in ("equivalent", "worse", "undecided"))
    if equivalent:
        yield f"Equivalent to {reference} within {100 * design.region:g} %: {_names(equivalent)}."
    if worse:
        yield f"Worse: {_names(worse)}."
    if undecided:
        yield f"Undecided: {_names(undecided)}."


def _how_much(best: MethodPair, what: str) -> str:
    if np.isnan(best.ratio.value):
        return f"{best.other} failed in {counted(best.other_failed, 'run')} in which it did not"
    return f"its {what} is {ratio_text(best)} times as large"


def _names(pairs: Iterable[MethodPair]) -> str:
    return listed(pair.method for pair in pairs)


def _condition(found: StudySummary) -> str:
    """What all runs share, so that the result holds for it alone; empty where nothing is."""
    kinds = {scenario.axes.get("motion") for scenario in found.outcomes.scenarios}
    fixed = [source for source in SOURCES if source not in found.design.vary]
    if kinds == {"paper"} and "motion" not in fixed:
        fixed.append("motion")
    if fixed:
        return f"All runs share one {listed(SOURCES_IN_WORDS[source] for source in fixed)}: this holds for it alone."
    return "The motion of the paper is the same in all runs." if "paper" in kinds else ""


def _too_few(comparison: PairedComparison) -> str:
    pairs = counted(len(comparison.pairs), "comparison")
    return f"{pairs} need {comparison.fewest} runs or more, and there {'is' if comparison.runs == 1 else 'are'} " + str(
        comparison.runs
    )


def ratio_text(pair: MethodPair) -> str:
    """Such as "0.42 (0.38–0.47)"."""
    return interval_text(pair.ratio, ".3g")


def verdict_text(pair: MethodPair, comparison: PairedComparison, region: float) -> str:
    """Such as "undecided: this study can show a ratio of 1.13; about 40 more runs for 1.05"."""
    if pair.verdict == "equivalent":
        return f"equivalent within {100 * region:g} %"
    if pair.verdict != "undecided":
        return pair.verdict
    if comparison.runs < comparison.fewest:
        return f"undecided: below {comparison.fewest} runs nothing is"
    if pair.failed or pair.other_failed:
        alone = [("it", pair.failed), (pair.other, pair.other_failed)]
        said = listed(f"{who} alone failed in {counted(runs, 'run')}" for who, runs in alone if runs)
        return f"undecided: {said}"
    if pair.detectable is None:
        return "undecided"
    more = f"; about {float(f'{pair.more_runs:.2g}'):.0f} more runs for {1 + region:g}" if pair.more_runs else ""
    return f"undecided: this study can show a ratio of {pair.detectable:.3g}{more}"


def overview(found: StudySummary) -> Iterator[Block]:
    """What is decided by each error, with what is not."""
    rows = []
    for (measures, error), comparison in found.comparisons.items():
        names = [_names(comparison.of(verdict)) for verdict in ("better", "equivalent", "worse", "undecided")]
        cells = (
            ERRORS_IN_WORDS[error],
            METHOD_CLASSES[measures][1],
            comparison.reference,
            *(one or None for one in names),
        )
        rows.append(Row(cells))
    if rows:
        yield Table(
            (
                Column("by", "name"),
                Column("measured"),
                Column("reference"),
                Column("better", "text"),
                Column(f"within {100 * found.design.region:g} %", "text", meaning="equivalent to the reference"),
                Column("worse", "text"),
                Column("undecided", "text"),
            ),
            tuple(rows),
            title="Compared with the reference, over all scenarios",
        )
    yield from _notes(found)


def _notes(found: StudySummary) -> Iterator[Block]:
    said = dict.fromkeys(
        f"{listed(group)} are one: their errors differ by less than {100 * SAME_METHOD_TOLERANCE:g} % in every record"
        for (_, error), comparison in found.comparisons.items()
        if error == HEADLINE_ERROR
        for group in comparison.same
    )
    few = dict.fromkeys(
        _too_few(comparison)
        for comparison in found.comparisons.values()
        if comparison.pairs and comparison.runs < comparison.fewest
    )
    if said or few:
        yield Notes(tuple(Note(line) for line in [*few, *said]))


def comparison_section(found: StudySummary, measures: Measures) -> Section | None:
    """All pairs of the methods that measure this, by every error; None where there is none."""
    comparisons = {error: one for (of, error), one in found.comparisons.items() if of == measures and one.pairs}
    if not comparisons:
        return None
    pairs = counted(max(len(one.pairs) for one in comparisons.values()), "pair")
    note = COMPARISON_NOTE.format(pairs=pairs, level=1 - CONFIDENCE_LEVEL, region=100 * found.design.region)
    tables = [_table(comparison, error, found.design) for error, comparison in comparisons.items()]
    tables.sort(key=lambda table: table.folded)
    blocks: Sequence[Block] = [*tables, Prose(note, soft=True, on=("page",))]
    return Section(f"comparisons-{measures}", f"Comparisons ({METHOD_CLASSES[measures][1]} measured)", tuple(blocks))


def _table(comparison: PairedComparison, error: str, design: StudyDesign) -> Table:
    rows = [
        Row(
            (
                pair.method,
                *([pair.other] if design.pairs == "all" else []),
                ratio_text(pair),
                verdict_text(pair, comparison, design.region),
                pair.probability,
                f"{pair.failed}, {pair.other_failed}" if pair.failed or pair.other_failed else None,
                pair.runs,
            )
        )
        for pair in sorted(comparison.pairs, key=lambda pair: (pair.other != comparison.reference, pair.ratio.value))
    ]
    other = "the other" if design.pairs == "all" else comparison.reference
    return Table(
        (
            Column("method", "name"),
            *([Column("other", "name")] if design.pairs == "all" else []),
            Column(f"error / that of {other}", "number", meaning="geometric mean, with its simultaneous interval"),
            Column("it is", "text"),
            Column("p", "number", form=".2g", meaning="Wilcoxon's signed ranks, with Holm's correction"),
            Column("failed alone", "number", meaning=f"runs in which it has failed, and in which {other} has"),
            Column("runs", "number", meaning="that enter the ratio"),
        ),
        tuple(rows),
        title=f"By {ERRORS_IN_WORDS[error]}",
        caption=f"{counted(comparison.runs, 'run')} of {counted(comparison.scenarios, 'scenario')}",
        on=("text", "page") if error == HEADLINE_ERROR else ("page",),
        folded=error != HEADLINE_ERROR,
        failures_first=False,
    )
