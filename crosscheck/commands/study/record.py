"""The format `graphdyn study 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from crosscheck.report.records.record import CommandRecord, Count, Keywords, Number, Numbers, Record, attribute, written
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, Interval
from crosscheck.study.statistics.outcomes import ERRORS, Measures, Method
from crosscheck.study.statistics.summary import MethodSummary, Ranking, ScenarioSummary, StudySummary


class StudyRankRecord(Record):
    """A method in a ranking.

    method: its name
    rank: mean rank, 1 is best; interval by bootstrap over runs
    ratio: geometric mean of its error over that of the first, where both have an answer; interval by bootstrap
    failures: records on which it failed, which rank last
    better_than: methods that it is better than: beyond the critical distance
    """

    method: str
    rank: Interval
    ratio: Interval
    failures: Count
    better_than: Sequence[str]


class StudyRankingRecord(Record, of=Ranking, only=("records", "methods")):
    """Methods of one class ranked by one error.

    measures: the class of the methods
    error: by which they are ranked
    """

    measures: Measures
    error: Annotated[str, Keywords(enum=list(ERRORS))]
    records: Count
    friedman: Number = attribute("probability")
    critical_distance: Number = attribute("distance")
    leaders = attribute()
    methods: Sequence[StudyRankRecord]


class StudyResultRecord(Record, of=MethodSummary, only=("found", "failed", "reasons", "consistent", "seconds")):
    """A method in a scenario.

    parameter_error: median relative distance of the base parameters from the true ones; failures count as infinite
    torque_error: the same of the torque of another motion
    trajectory_error: the same of the simulated motion of the closed loop
    iterations: median
    most_iterations: largest number of iterations
    simulations: median number of simulated motions
    bias: mean of found minus true
    bias_low, bias_high: ends of the intervals of the bias
    spread: standard deviation
    spread_low, spread_high: ends of the intervals of the spread
    """

    method: str = attribute("method.name")
    found: Count
    reasons: Mapping[str, Count]
    parameter_error: Interval
    torque_error: Interval
    trajectory_error: Interval
    iterations: Number
    most_iterations: Number
    simulations: Number
    bias: Numbers = attribute("parameters.bias.value")
    bias_low: Numbers = attribute("parameters.bias.low")
    bias_high: Numbers = attribute("parameters.bias.high")
    spread: Numbers = attribute("parameters.spread.value")
    spread_low: Numbers = attribute("parameters.spread.low")
    spread_high: Numbers = attribute("parameters.spread.high")
    stated: Numbers = attribute("parameters.stated")


class StudyScenarioRecord(Record, of=ScenarioSummary, only=()):
    """A point of the grid.

    name: as in the tables
    runs: records that were simulated
    results: of all methods that take part: those that need wrenches do where they are measured
    rankings: of every class that has two methods or more, by every error
    """

    name: str = attribute("outcomes.name")
    axes: Mapping[str, float | str | None] = attribute("outcomes.axes")
    runs: Count
    base_names = attribute("outcomes.base_names")
    base_units = attribute("outcomes.base_units")
    truth: Numbers = attribute("outcomes.truth")
    results: Sequence[StudyResultRecord]
    rankings: Sequence[StudyRankingRecord]


class StudyRecord(CommandRecord, format="graphdyn study 1"):
    """A study of identification methods, summarized; every run is in results.parquet.

    confidence: of all intervals and tests
    facts: what all scenarios share, in words
    methods: all of them
    rankings: over all scenarios
    scenarios: all of them
    """

    confidence: float
    facts: Mapping[str, str]
    methods: Sequence[Method]
    rankings: Sequence[StudyRankingRecord]
    scenarios: Sequence[StudyScenarioRecord]


def study_record(found: StudySummary, facts: Sequence[tuple[str, str]], command: Sequence[str]) -> dict[str, Any]:
    return written(
        StudyRecord,
        command=command,
        confidence=CONFIDENCE_LEVEL,
        facts=dict(facts),
        methods=found.outcomes.methods,
        rankings=_rankings(found.rankings),
        scenarios=[_scenario(scenario) for scenario in found.scenarios],
    )


def _rankings(found: Mapping[tuple[Measures, str], Ranking]) -> list[dict[str, Any]]:
    return [
        written(
            StudyRankingRecord,
            ranking,
            measures=measures,
            error=error,
            methods=[_rank(ranking, k) for k in range(len(ranking.methods))],
        )
        for (measures, error), ranking in found.items()
    ]


def _rank(ranking: Ranking, k: int) -> dict[str, Any]:
    return written(
        StudyRankRecord,
        method=ranking.methods[k],
        rank=ranking.rank[k],
        ratio=ranking.ratio[k],
        failures=ranking.failures[k],
        better_than=[name for other, name in enumerate(ranking.methods) if ranking.better(k, other)],
    )


def _scenario(found: ScenarioSummary) -> dict[str, Any]:
    return written(
        StudyScenarioRecord,
        found,
        runs=len(found.outcomes.runs),
        results=[_result(method) for method in found.methods if method.runs],
        rankings=_rankings(found.rankings),
    )


def _result(found: MethodSummary) -> dict[str, Any]:
    iterations, most_iterations = found.iterations
    return written(
        StudyResultRecord,
        found,
        iterations=iterations,
        most_iterations=most_iterations,
        simulations=found.simulations[0],
        **found.errors,
    )
