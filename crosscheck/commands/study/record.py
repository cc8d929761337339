"""The format `graphdyn study 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, get_args

from crosscheck.commands.study.comparison_report import headline
from crosscheck.commands.study.recordings import RecordedResult, RecordedResults, recordings_headline
from crosscheck.report.records.record import CommandRecord, Count, Keywords, Number, Numbers, Record, attribute, written
from crosscheck.study.inputs import StudyInputs
from crosscheck.study.statistics.comparison import MethodPair, PairedComparison, Verdict
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, Interval
from crosscheck.study.statistics.outcomes import ERRORS, Measures, Method
from crosscheck.study.statistics.ranking import Ranking
from crosscheck.study.statistics.summary import MethodSummary, ScenarioSummary, StudySummary


class StudyPairRecord(Record, of=MethodPair, only=("verdict",)):
    """A method compared with another.

    method: its name
    other: that of the other
    ratio: geometric mean of its error over that of the other, with its interval, simultaneous over all pairs; an end
        is null where one alone has failed in some run
    probability: of signed ranks as uneven if the two were alike, with Holm's correction
    runs: that enter the ratio
    failed: runs in which it has no error where the other has one
    other_failed: the reverse
    detectable: ratio that the study can show
    more_runs: runs that are missing to show the ratio of the region, about
    """

    method: str
    other: str
    ratio: Interval
    probability: float
    runs: Count
    failed: Count
    other_failed: Count
    verdict: Annotated[str, Keywords(enum=list(get_args(Verdict)))]
    detectable: Number
    more_runs: Count | None


class StudyComparisonRecord(Record, of=PairedComparison, only=("reference",)):
    """Methods of one class compared by one error.

    measures: the class of the methods
    error: by which they are compared
    same: groups of methods that are one; the first of each is compared
    runs: that all scenarios have
    fewest: runs below which nothing can be decided
    """

    measures: Measures
    error: Annotated[str, Keywords(enum=list(ERRORS))]
    reference: str
    runs: Count
    fewest: Count
    same: Sequence[Sequence[str]]
    pairs: Sequence[StudyPairRecord]


class StudyRankRecord(Record):
    """A method in a ranking.

    method: its name
    rank: mean rank over the runs, 1 is best, with Student's interval
    failures: runs in which it failed, where it ranks last
    """

    method: str
    rank: Interval
    failures: Count


class StudyRankingRecord(Record, of=Ranking, only=("runs", "methods")):
    """Methods of one class ranked by one error.

    measures: the class of the methods
    error: by which they are ranked
    """

    measures: Measures
    error: Annotated[str, Keywords(enum=list(ERRORS))]
    runs: Count
    friedman: Number = attribute("probability")
    critical_distance: Number = attribute("distance")
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
    z: root mean square of (found - true) / standard deviation as stated; 1 is honest
    held_bias: root mean square over the runs of the bias for one motion and one CAD model
    shares: part of the variance of each parameter that is drawn anew with each source
    distances: means of d_beta, d_tau and d_q (Leboutet et al. 2021) over the answers that have not diverged, and how
        many have; null where the study does not ask for them
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
    z: Numbers = attribute("parameters.z")
    held_bias: Numbers = attribute("parameters.held_bias")
    shares: Mapping[str, Numbers] = attribute("parameters.shares")
    distances: Mapping[str, Number]


class StudyScenarioRecord(Record, of=ScenarioSummary, only=()):
    """A point of the grid.

    name: as in the tables
    runs: records that were simulated
    results: of all methods that take part: those that need wrenches do where they are measured
    comparisons: of every class that has two methods or more, by every error
    """

    name: str = attribute("outcomes.name")
    axes: Mapping[str, float | str | None] = attribute("outcomes.axes")
    runs: Count
    base_names = attribute("outcomes.base_names")
    base_units = attribute("outcomes.base_units")
    truth: Numbers = attribute("outcomes.truth")
    results: Sequence[StudyResultRecord]
    comparisons: Sequence[StudyComparisonRecord]


class StudyRecordedRecord(Record, of=RecordedResult):
    """A method on a real recording."""


class StudyRecord(CommandRecord, format="graphdyn study 1"):
    """A study of identification methods, summarized; every run is in results.parquet.

    confidence: of all intervals and tests
    software: versions with which the study was computed
    files: SHA-256 of what it has read and of its tables, by name
    facts: what all scenarios share, in words
    headline: which methods are best, by how much, how sure that is, and for what it holds
    vary: what every run draws anew
    repeats: draws of each of these in a run
    pairs: which methods are compared: each with the reference, or all with all
    region: relative differences of errors up to this are equivalent
    methods: all of them
    comparisons: over all scenarios
    rankings: over all scenarios
    scenarios: all of them
    recordings: what every method has reached on real recordings, by their label
    """

    confidence: float
    software: Mapping[str, str]
    files: Mapping[str, str]
    facts: Mapping[str, str]
    headline: str
    vary: Sequence[str]
    repeats: Count
    pairs: str
    region: float
    methods: Sequence[Method]
    comparisons: Sequence[StudyComparisonRecord]
    rankings: Sequence[StudyRankingRecord]
    scenarios: Sequence[StudyScenarioRecord]
    recordings: Mapping[str, Sequence[StudyRecordedRecord]]


def study_record(
    found: StudySummary,
    facts: Sequence[tuple[str, str]],
    inputs: StudyInputs,
    recorded: RecordedResults,
    command: Sequence[str],
) -> dict[str, Any]:
    verdict = headline(found) if found.scenarios else recordings_headline(recorded)
    return written(
        StudyRecord,
        command=command,
        confidence=CONFIDENCE_LEVEL,
        software=inputs.software,
        files=inputs.files,
        facts=dict(facts),
        headline=verdict.reason or verdict.sentence,
        vary=found.design.vary,
        repeats=found.design.repeats,
        pairs=found.design.pairs,
        region=found.design.region,
        methods=found.outcomes.methods,
        comparisons=_comparisons(found.comparisons),
        rankings=_rankings(found.rankings),
        scenarios=[_scenario(scenario) for scenario in found.scenarios],
        recordings={label: [written(StudyRecordedRecord, one) for one in of] for label, of in recorded.items()},
    )


def _comparisons(found: Mapping[tuple[Measures, str], PairedComparison]) -> list[dict[str, Any]]:
    return [
        written(
            StudyComparisonRecord,
            comparison,
            measures=measures,
            error=error,
            pairs=[written(StudyPairRecord, pair) for pair in comparison.pairs],
        )
        for (measures, error), comparison in found.items()
    ]


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
        failures=ranking.failures[k],
    )


def _scenario(found: ScenarioSummary) -> dict[str, Any]:
    return written(
        StudyScenarioRecord,
        found,
        runs=len(found.outcomes.runs),
        results=[_result(method) for method in found.methods if method.runs],
        comparisons=_comparisons(found.comparisons),
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
