"""The record of a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields

import numpy as np

from crosscheck.commands.study.record import (
    StudyIntervalRecord,
    StudyMethodRecord,
    StudyRankingRecord,
    StudyRankRecord,
    StudyRecord,
    StudyResultRecord,
    StudyScenarioRecord,
)
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, Interval
from crosscheck.study.statistics.outcomes import Measures
from crosscheck.study.statistics.ranking import Ranking
from crosscheck.study.statistics.summary import MethodSummary, ParameterSpread, ScenarioSummary, StudySummary


def study_record(found: StudySummary, facts: Sequence[tuple[str, str]], command: Sequence[str]) -> StudyRecord:
    return StudyRecord(
        command=command,
        confidence=CONFIDENCE_LEVEL,
        facts=dict(facts),
        methods=[StudyMethodRecord(name=one.name, measures=one.measures) for one in found.outcomes.methods],
        rankings=_rankings(found.rankings),
        scenarios=[_scenario(scenario) for scenario in found.scenarios],
    )


def _interval(found: Interval) -> StudyIntervalRecord:
    return StudyIntervalRecord(value=found.value, low=found.low, high=found.high)


def _rankings(found: Mapping[tuple[Measures, str], Ranking]) -> list[StudyRankingRecord]:
    return [
        StudyRankingRecord(
            measures=measures,
            error=error,  # type: ignore[arg-type]
            records=ranking.records,
            friedman=ranking.probability,
            critical_distance=ranking.distance,
            leaders=ranking.leaders,
            methods=[_rank(ranking, k) for k in range(len(ranking.methods))],
        )
        for (measures, error), ranking in found.items()
    ]


def _rank(ranking: Ranking, k: int) -> StudyRankRecord:
    return StudyRankRecord(
        method=ranking.methods[k],
        rank=_interval(Interval(ranking.mean[k], ranking.low[k], ranking.high[k])),
        ratio=_interval(Interval(ranking.ratio[k], ranking.ratio_low[k], ranking.ratio_high[k])),
        failures=ranking.failures[k],
        better_than=[name for other, name in enumerate(ranking.methods) if ranking.better(k, other)],
    )


def _scenario(found: ScenarioSummary) -> StudyScenarioRecord:
    outcomes = found.outcomes
    return StudyScenarioRecord(
        name=outcomes.name,
        axes=outcomes.axes,
        runs=len(outcomes.runs),
        base_names=outcomes.base_names,
        base_units=outcomes.base_units,
        truth=list(outcomes.truth),
        results=[_result(method) for method in found.methods if method.runs],
        rankings=_rankings(found.rankings),
    )


def _result(found: MethodSummary) -> StudyResultRecord:
    vectors = {field.name: np.asarray(getattr(found.parameters, field.name)) for field in fields(ParameterSpread)}
    return StudyResultRecord(
        method=found.method.name,
        found=found.found,
        failed=_interval(found.failed),
        reasons=found.reasons,
        consistent=_interval(found.consistent),
        parameter_error=_interval(found.errors["parameter_error"]),
        torque_error=_interval(found.errors["torque_error"]),
        trajectory_error=_interval(found.errors["trajectory_error"]),
        iterations=found.iterations[0],
        most_iterations=found.iterations[1],
        simulations=found.simulations[0],
        seconds=_interval(found.seconds),
        **{name: list(values) for name, values in vectors.items()},
    )
