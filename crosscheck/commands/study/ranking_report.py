"""Ranks of methods, and their accuracy against their time, as parts of the report of a study."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from crosscheck.commands.study.pareto_picture import Trade, study_pareto
from crosscheck.commands.study.rank_picture import study_ranks
from crosscheck.commands.study.words import ERRORS_IN_WORDS, HEADLINE_ERROR, interval_text
from crosscheck.report.report import Block, Column, Picture, Prose, Row, Table
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, median
from crosscheck.study.statistics.ranking import Ranking
from crosscheck.study.statistics.summary import StudySummary

RANKING_NOTE = (
    "On every record the method with the smallest error has rank 1; errors that are equal up to rounding share a rank, "
    "and methods that failed, or whose error is not finite, share the last one; records on which all did are left out. "
    "Bars: {level:.0%} intervals of the mean rank by bootstrap over runs. Thick lines join methods that are not told "
    "apart: their mean ranks are closer than Nemenyi's critical distance, or Friedman's test finds no difference at "
    "all. Blue: none is better than these. Every scenario weighs the same, and failures count, so that the order by "
    "ranks can differ from that by mean errors, which are those of records that both methods have an answer for."
)
TRADE_OFF_NOTE = (
    "Geometric mean of the error relative to the first of the ranking, over the records that both have an answer for, "
    "with its {level:.0%} interval; median processor time of all runs. Hollow: failed on some records, which are "
    "not in this mean. The line joins methods than which no other is faster and more accurate."
)


def ranks(rankings: dict[str, Ranking]) -> Iterator[Block]:
    """Ranks of the methods of one class by every error, with the errors relative to the first."""
    for error, ranking in rankings.items():
        what = ERRORS_IN_WORDS[error]
        yield Picture(partial(study_ranks, ranking=ranking, what=what), title=f"By {what}", wide=False, on=("page",))
    yield Prose(RANKING_NOTE.format(level=CONFIDENCE_LEVEL), soft=True, on=("page",))
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
        caption=f"Over all scenarios, with {CONFIDENCE_LEVEL:.0%} intervals by bootstrap over runs",
        failures_first=False,
    )


def trades(found: StudySummary, rankings: dict[str, Ranking]) -> Iterator[Block]:
    """Accuracy of the same methods against their time."""
    seconds = {
        method.name: np.concatenate([scenario.seconds[:, k] for scenario in found.outcomes.scenarios])
        for k, method in enumerate(found.outcomes.methods)
    }
    for error, ranking in rankings.items():
        every = [
            Trade(
                name, median(seconds[name][~np.isnan(seconds[name])]).value, float(ranking.ratio[k]),
                float(ranking.ratio_low[k]), float(ranking.ratio_high[k]), ranking.failures[k] == 0,
            )
            for k, name in enumerate(ranking.methods)
        ]  # fmt: skip
        drawn = [trade for trade in every if np.isfinite(trade.ratio) and trade.seconds > 0]
        if drawn:
            what, best = ERRORS_IN_WORDS[error], ranking.methods[0]
            draw = partial(study_pareto, trades=drawn, what=what, best=best)
            yield Picture(draw, title=f"By {what}", on=("page",), folded=error != HEADLINE_ERROR)
    yield Prose(TRADE_OFF_NOTE.format(level=CONFIDENCE_LEVEL), soft=True, on=("page",))
