"""What a study found, in numbers: every scenario and method summarized, the methods of each class ranked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.study.statistics.intervals import Interval, Intervals, deviations, means, median, share
from crosscheck.study.statistics.outcomes import ERRORS, Measures, Method, ScenarioOutcomes, StudyOutcomes
from crosscheck.study.statistics.ranking import Ranking, ranked
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class ParameterSpread:
    """What the runs of one scenario that a method did not fail say of every base parameter, each (b,).

    bias: mean of found minus true; spread: standard deviation
    stated: root mean square of the standard deviations that the method states; NaN where it states none
    """

    bias: Intervals
    spread: Intervals
    stated: Array

    @property
    def biased(self) -> int:
        """Parameters whose interval of the bias does not have zero in it."""
        return int(((self.bias.low > 0) | (self.bias.high < 0)).sum())


@dataclass(frozen=True, eq=False)
class MethodSummary:
    """One method in one scenario; no runs where it takes no part.

    method: which one
    runs: how many there were; found: runs in which it has an answer
    errors: median by the names of ERRORS, with failures as infinite
    failed: share of the runs in which it has no answer; Wilson's interval
    consistent: share of the answers with real bodies in all links; Wilson's interval
    iterations, simulations: median and largest over the answers; NaN where unknown
    seconds: median of the processor time of all runs                          [s]
    reasons: why it failed, and how often
    """

    method: Method
    runs: int
    found: int
    errors: Mapping[str, Interval]
    failed: Interval
    consistent: Interval
    iterations: tuple[float, float]
    simulations: tuple[float, float]
    seconds: Interval
    parameters: ParameterSpread
    reasons: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class ScenarioSummary:
    """rankings: of every class that has two methods or more, by what it measures and the name of the error"""

    outcomes: ScenarioOutcomes
    methods: tuple[MethodSummary, ...]
    rankings: Mapping[tuple[Measures, str], Ranking]


@dataclass(frozen=True, eq=False)
class StudySummary:
    """rankings: over all scenarios"""

    outcomes: StudyOutcomes
    scenarios: tuple[ScenarioSummary, ...]
    rankings: Mapping[tuple[Measures, str], Ranking]

    def methods(self, measures: Measures) -> list[int]:
        """Numbers of the methods that measure this, the best by torque error first."""
        columns = self.outcomes.columns(measures)
        ranking = self.rankings.get((measures, "torque_error"))
        if ranking is None:
            return columns
        return sorted(columns, key=lambda k: ranking.methods.index(self.outcomes.methods[k].name))


def summarized(found: StudyOutcomes) -> StudySummary:
    """All statistics of a study."""
    scenarios = []
    for scenario in found.scenarios:
        methods = tuple(_method(scenario, method, k) for k, method in enumerate(found.methods))
        scenarios.append(ScenarioSummary(scenario, methods, _rankings(found, (scenario,))))
    return StudySummary(found, tuple(scenarios), _rankings(found, found.scenarios))


def _rankings(found: StudyOutcomes, scenarios: Sequence[ScenarioOutcomes]) -> dict[tuple[Measures, str], Ranking]:
    """Rankings of the scenarios in which all methods of a class take part."""
    rankings: dict[tuple[Measures, str], Ranking] = {}
    classes: tuple[Measures, Measures] = ("torques", "wrenches")
    for measures in classes:
        columns = found.columns(measures)
        names = [found.methods[k].name for k in columns]
        complete = [one for one in scenarios if one.taken[columns].all()]
        for error in ERRORS:
            if len(columns) > 1 and any(np.isfinite(one.errors[error][:, columns]).any() for one in complete):
                rankings[measures, error] = ranked(names, columns, complete, error)
    return rankings


def _method(scenario: ScenarioOutcomes, method: Method, k: int) -> MethodSummary:
    rows = slice(None if scenario.taken[k] else 0)
    answered = np.flatnonzero(scenario.found[rows, k])
    known = scenario.consistent[answered, k]
    known = known[~np.isnan(known)]
    times = scenario.seconds[rows, k]
    runs, found = len(times), len(answered)
    return MethodSummary(
        method,
        runs,
        found,
        {error: median(scenario.errors[error][rows, k]) for error in ERRORS},
        share(runs - found, runs),
        share(int(known.sum()), len(known)),
        _middle_and_largest(scenario.iterations[answered, k]),
        _middle_and_largest(scenario.simulations[answered, k]),
        median(times[~np.isnan(times)]),
        _spread(scenario.base[answered, k], scenario.sigma[answered, k], scenario.truth),
        dict(Counter(reason for (_, j), reason in sorted(scenario.reasons.items()) if j == k).most_common()),
    )


def _spread(base: Array, sigma: Array, truth: Array) -> ParameterSpread:
    stated = sigma[~np.isnan(sigma).any(axis=1)]
    usual = np.sqrt((stated**2).mean(axis=0)) if len(stated) else np.full(len(truth), np.nan)
    return ParameterSpread(means(base - truth), deviations(base), usual)


def _middle_and_largest(values: Array) -> tuple[float, float]:
    values = values[~np.isnan(values)]
    return (float(np.median(values)), float(values.max())) if len(values) else (np.nan, np.nan)
