"""Ranks of the methods on common records, and which of them differ: Friedman's test, then Nemenyi's.

On every record the best method has rank 1; methods that are equally good share the mean of their ranks, and those that
failed share the last ones. Two methods differ where their mean ranks over N records are further apart than

    q sqrt(k (k + 1) / (6 N)),

q the quantile of the studentized range of k methods divided by sqrt 2, and only if Friedman's test says that not all
methods are alike. Demšar, Journal of Machine Learning Research 7, 2006.

The methods of one class ranked by one error: in every scenario, and over all scenarios of the study.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, Intervals, drawn_means, ends
from crosscheck.study.statistics.outcomes import ScenarioOutcomes
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
