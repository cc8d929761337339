"""What a study found, in numbers: every scenario and method summarized, the methods of each class ranked.

Ranks are those of the methods on common records, and which of them differ: Friedman's test, then Nemenyi's.

On every record the best method has rank 1; methods that are equally good share the mean of their ranks, and those that
failed share the last ones. Two methods differ where their mean ranks over N records are further apart than

    q sqrt(k (k + 1) / (6 N)),

q the quantile of the studentized range of k methods divided by sqrt 2, and only if Friedman's test says that not all
methods are alike. Demšar, Journal of Machine Learning Research 7, 2006.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.study.statistics.intervals import (
    CONFIDENCE_LEVEL,
    Interval,
    Intervals,
    deviations,
    drawn_means,
    ends,
    means,
    median,
    share,
)
from crosscheck.study.statistics.outcomes import ERRORS, Measures, Method, ScenarioOutcomes, StudyOutcomes
from graphdyn.layout import Array

EQUAL_ERROR_TOLERANCE = 1e-6
"""Errors closer than this part of them are equal: what solvers of the same equations differ by is rounding."""

MAX_EXACT_SCENARIOS, N_PERMUTATIONS = 30, 2000
"""Records from which the χ² distribution holds for Friedman's statistic; permutations that are drawn below."""


def record_ranks(errors: Array) -> Array:
    """Ranks (N, k) from 1, of errors (N, k) in which failures are infinite."""
    from scipy.stats import rankdata

    ranks: Array = rankdata(np.array([_steps(row) for row in errors]), axis=1)
    return ranks


def _steps(errors: Array) -> Array:
    """Whole numbers in the order of the errors, one for those that are equal."""
    order = np.argsort(errors, kind="stable")
    ordered = errors[order]
    with np.errstate(invalid="ignore"):
        further = np.diff(ordered) > EQUAL_ERROR_TOLERANCE * np.abs(ordered[1:])  # ∞ - ∞ is no step
    further |= np.isinf(ordered[1:]) & np.isfinite(ordered[:-1])
    steps = np.empty(len(errors))
    steps[order] = np.concatenate([[0], np.cumsum(further)])
    return steps


def friedman(ranks: Array) -> float | None:
    """Probability of ranks (N, k) as different as these if all methods were alike; None below two of either.

    Friedman's χ² with correction for ties; of few records its distribution over permuted ranks.
    """
    from scipy.stats import chi2

    count, methods = ranks.shape
    if count < 2 or methods < 2:
        return None
    statistic = float(friedman_statistic(ranks))
    if count >= MAX_EXACT_SCENARIOS:
        return float(chi2.sf(statistic, methods - 1))
    rng = np.random.default_rng(0)
    permuted = rng.permuted(np.broadcast_to(ranks, (N_PERMUTATIONS, count, methods)), axis=2)
    as_large = (friedman_statistic(permuted) >= statistic * (1 - EQUAL_ERROR_TOLERANCE)).sum()
    return float((1 + as_large) / (1 + N_PERMUTATIONS))


def friedman_statistic(ranks: Array) -> Array:
    """Friedman statistic of ranks (…, N, k); 0 where all methods share all ranks."""
    count, methods = ranks.shape[-2:]
    between = ((ranks.sum(axis=-2) - count * (methods + 1) / 2) ** 2).sum(axis=-1)
    within = (ranks**2).sum(axis=(-2, -1)) - count * methods * (methods + 1) ** 2 / 4
    statistic: Array = (methods - 1) * between / np.maximum(within, EQUAL_ERROR_TOLERANCE)
    return statistic


def critical_distance(methods: int, count: int, level: float = CONFIDENCE_LEVEL) -> float:
    """Critical distance of mean ranks over so many records; NaN for fewer than two methods."""
    from scipy.stats import studentized_range

    if methods < 2:
        return np.nan
    q = float(studentized_range.ppf(level, methods, np.inf)) / np.sqrt(2)
    return float(q * np.sqrt(methods * (methods + 1) / (6 * count)))


@dataclass(frozen=True, eq=False)
class Ranking:
    """k methods over N records.

    methods: best first
    rank: mean ranks, rising                                            (k,)
    ratio: geometric mean of error / error of the first, over records that both have; no ends where both have one
        record alone of a scenario                                      (k,)
    records: common ones on which they were ranked: those for which some method has an answer, N
    probability: of ranks as different as these if all methods were alike, by Friedman; None where nothing is compared
    distance: Nemenyi's critical distance of mean ranks
    failures: records on which each failed, ranked last                 (k,)
    """

    methods: tuple[str, ...]
    rank: Intervals
    ratio: Intervals
    records: int
    probability: float | None
    distance: float
    failures: Sequence[int]

    @property
    def differ(self) -> bool:
        """Whether the methods are not all alike."""
        return self.probability is not None and self.probability <= 1 - CONFIDENCE_LEVEL

    def better(self, one: int, other: int) -> bool:
        """Whether one is better than the other, beyond the critical distance. Numbers from 0 in the order of rank."""
        return self.differ and bool(self.rank.value[other] - self.rank.value[one] > self.distance)

    @property
    def leaders(self) -> tuple[str, ...]:
        """The first, and those than which it is not better."""
        return tuple(name for k, name in enumerate(self.methods) if not self.better(0, k))

    @property
    def alike(self) -> list[tuple[int, int]]:
        """First and last of the groups of two or more within which no method is better than another."""
        count = len(self.methods)
        groups: list[tuple[int, int]] = []
        for first in range(count):
            last = max(k for k in range(first, count) if not self.better(first, k))
            if last > first and (not groups or last > groups[-1][1]):
                groups.append((first, last))
        return groups


def ranked(names: Sequence[str], columns: Sequence[int], scenarios: Sequence[ScenarioOutcomes], error: str) -> Ranking:
    """The ranking of methods over one scenario or several, all of the same weight.

    names: of the methods; columns: where they are in the outcomes; error: one of ERRORS, of which one is finite
    """
    errors, scenarios = _with_answers([(one.errors[error][:, columns], one) for one in scenarios])
    failures = sum(np.isinf(of_scenario).sum(axis=0) for of_scenario in errors)
    ranks = [record_ranks(of_scenario) for of_scenario in errors]
    mean = np.mean([of_scenario.mean(axis=0) for of_scenario in ranks], axis=0)
    order = np.argsort(mean, kind="stable")
    mean, runs = mean[order], [len(of_scenario) for of_scenario in ranks]
    together = np.concatenate(ranks)
    low, high = ends(_drawn([of_scenario[:, order] for of_scenario in ranks], scenarios), runs)
    logs = [_log_ratios(of_scenario[:, order]) for of_scenario in errors]
    shared = [part for part in logs if not np.isnan(part).all()]
    alone = np.any([(~np.isnan(part)).sum(axis=0) == 1 for part in logs], axis=0)
    ratio_ends = np.where(alone, np.nan, np.exp(ends(_drawn(logs, scenarios), runs)))
    ratio = np.exp(_mean_over([_mean_over(part) for part in shared])) if shared else np.full(len(order), np.nan)
    return Ranking(
        methods=tuple(names[k] for k in order),
        rank=Intervals(mean, np.minimum(low, mean), np.maximum(high, mean)),
        ratio=Intervals(ratio, *ratio_ends),
        records=len(together),
        probability=friedman(together),
        distance=critical_distance(len(order), len(together)),
        failures=[int(failures[k]) for k in order],
    )


def _with_answers(
    found: Sequence[tuple[Array, ScenarioOutcomes]],
) -> tuple[list[Array], list[ScenarioOutcomes]]:
    """The ranks without the records on which no method has an answer, of which nothing can be learned.

    Scenarios where one record is left, which says nothing of its scatter, go too, unless all are like that.
    """
    answered = [(errors[np.isfinite(errors).any(axis=1)], scenario) for errors, scenario in found]
    several = [both for both in answered if len(both[0]) > 1]
    kept = several or [both for both in answered if len(both[0])]
    return [errors for errors, _ in kept], [scenario for _, scenario in kept]


def _drawn(values: Sequence[Array], scenarios: Sequence[ScenarioOutcomes]) -> Array:
    """Resampled means over all scenarios (B, k)."""
    drawn = [drawn_means(part, scenario.name) for part, scenario in zip(values, scenarios, strict=True)]
    return _mean_over(drawn)


def _mean_over(values: Sequence[Array] | Array) -> Array:
    """Mean over the first axis of those that are not NaN; NaN where all are."""
    stacked = np.asarray(values)
    there = ~np.isnan(stacked)
    with np.errstate(invalid="ignore"):
        mean: Array = np.where(there, stacked, 0.0).sum(axis=0) / there.sum(axis=0)
    return mean


def _log_ratios(errors: Array) -> Array:
    """log(error / error of the first), NaN where one of the two is missing or zero (R, k)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(errors) - np.log(errors[:, :1])
    return np.where(np.isfinite(logs), logs, np.nan)


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
