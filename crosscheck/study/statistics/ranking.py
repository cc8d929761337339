"""Ranks of methods, as a picture: mean ranks over the runs, and which of them differ by Friedman's test and Nemenyi's.

In every run the method with the smallest error, the geometric mean over its scenarios, has rank 1; methods that are
equally good share the mean of their ranks, and those that failed share the last ones. Two methods differ where their
mean ranks over N runs are further apart than

    q sqrt(k (k + 1) / (6 N)),

q the quantile of the studentized range of k methods divided by sqrt 2, and only if Friedman's test says that not all
methods are alike. Demšar, Journal of Machine Learning Research 7, 2006. Whether A is better than B depends here on
which C take part: what is concluded comes from comparisons of two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, Intervals, means
from graphdyn.layout import Array

EQUAL_ERROR_TOLERANCE = 1e-6
"""Errors closer than this part of them are equal: what solvers of the same equations differ by is rounding."""

MAX_EXACT_RANKS, N_PERMUTATIONS = 30, 2000
"""Runs from which the χ² distribution holds for Friedman's statistic; permutations that are drawn below."""


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

    Friedman's χ² with correction for ties; of few runs its distribution over permuted ranks.
    """
    from scipy.stats import chi2

    count, methods = ranks.shape
    if count < 2 or methods < 2:
        return None
    statistic = float(friedman_statistic(ranks))
    if count >= MAX_EXACT_RANKS:
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
    """Critical distance of mean ranks over so many runs; NaN for fewer than two methods."""
    from scipy.stats import studentized_range

    if methods < 2:
        return np.nan
    q = float(studentized_range.ppf(level, methods, np.inf)) / np.sqrt(2)
    return float(q * np.sqrt(methods * (methods + 1) / (6 * count)))


@dataclass(frozen=True, eq=False)
class Ranking:
    """k methods over N runs.

    methods: best first
    rank: mean ranks, rising, with Student's intervals                      (k,)
    runs: in which they were ranked: those in which some method has all its answers, N
    probability: of ranks as different as these if all methods were alike, by Friedman; None where nothing is compared
    distance: Nemenyi's critical distance of mean ranks
    failures: runs in which each failed in some scenario, ranked last       (k,)
    """

    methods: tuple[str, ...]
    rank: Intervals
    runs: int
    probability: float | None
    distance: float
    failures: Sequence[int]

    @property
    def differ(self) -> bool:
        """Whether the methods are not all alike."""
        return self.probability is not None and self.probability <= 1 - CONFIDENCE_LEVEL

    def apart(self, one: int, other: int) -> bool:
        """Whether one ranks before the other by more than the critical distance. Numbers from 0 in order of rank."""
        return self.differ and bool(self.rank.value[other] - self.rank.value[one] > self.distance)

    @property
    def alike(self) -> list[tuple[int, int]]:
        """First and last of the groups of two or more within which no methods are apart."""
        count = len(self.methods)
        groups: list[tuple[int, int]] = []
        for first in range(count):
            last = max(k for k in range(first, count) if not self.apart(first, k))
            if last > first and (not groups or last > groups[-1][1]):
                groups.append((first, last))
        return groups


def ranked(names: Sequence[str], errors: Array) -> Ranking | None:
    """The ranking of M methods by their errors (R, S, M), infinite for failures; None where no run has a whole answer.

    Records on which no method has an answer, of which nothing can be learned, are left out.
    """
    known = np.isfinite(errors).any(axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        of_runs = np.exp(np.where(known, np.log(errors), 0.0).sum(axis=1) / known.sum(axis=1))
    of_runs = of_runs[np.isfinite(of_runs).any(axis=1)]
    if not len(of_runs):
        return None
    ranks = record_ranks(of_runs)
    order = np.argsort(ranks.mean(axis=0), kind="stable")
    ranks, failed = ranks[:, order], np.isinf(of_runs).sum(axis=0)[order]
    return Ranking(
        methods=tuple(names[k] for k in order),
        rank=means(ranks),
        runs=len(ranks),
        probability=friedman(ranks),
        distance=critical_distance(len(order), len(ranks)),
        failures=failed.tolist(),
    )
