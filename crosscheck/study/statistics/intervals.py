"""Confidence intervals of a share, a median, a mean and a standard deviation, from few independent runs.

Share: Wilson, Journal of the American Statistical Association 22, 1927. Median: from order statistics, so that
nothing is assumed of the distribution (Conover, Practical Nonparametric Statistics, 3.2). Mean and standard
deviation: Student's t and χ², exact for errors that are normal.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from graphdyn.layout import Array

CONFIDENCE_LEVEL = 0.95
"""Confidence level of all intervals and tests of a study."""


@dataclass(frozen=True)
class Interval:
    """An estimate and its confidence interval.

    value: the estimate; NaN where there is none, and not finite where too many runs failed
    low: lower end; NaN where there is none
    high: upper end; NaN where there is none, and not finite where too many runs failed
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Intervals:
    """Estimates (k,) and the ends of their confidence intervals; NaN where there are none."""

    value: Array
    low: Array
    high: Array

    def __getitem__(self, k: int) -> Interval:
        return Interval(float(self.value[k]), float(self.low[k]), float(self.high[k]))


UNKNOWN_INTERVAL = Interval(np.nan, np.nan, np.nan)


def share(count: int, trials: int, level: float = CONFIDENCE_LEVEL) -> Interval:
    """count of trials, with Wilson's interval, which is right near 0 and 1 too."""
    if trials == 0:
        return UNKNOWN_INTERVAL
    z = NormalDist().inv_cdf((1 + level) / 2)
    p, shrunk = count / trials, 1 + z**2 / trials
    center = (p + z**2 / (2 * trials)) / shrunk
    half = z / shrunk * float(np.sqrt(p * (1 - p) / trials + z**2 / (4 * trials**2)))
    return Interval(p, 0.0 if count == 0 else center - half, 1.0 if count == trials else center + half)


def order_of_median(count: int, level: float = CONFIDENCE_LEVEL) -> tuple[int, float]:
    """The k-th smallest and the k-th largest of so many values enclose the median with a probability of at least level.

    k from 1; where even the smallest and the largest do not reach the level, k = 1. Then: the probability.
    """
    from scipy.stats import binom

    k = max(1, int(binom.ppf((1 - level) / 2, count, 0.5)))
    return k, 1 - 2 * float(binom.cdf(k - 1, count, 0.5))


def median(values: Array) -> Interval:
    """values: (N,), infinite for failures, which count as larger than all others; no ends below two values."""
    values = np.sort(values)
    if len(values) < 2:
        return Interval(float(values[0]), np.nan, np.nan) if len(values) else UNKNOWN_INTERVAL
    k, _ = order_of_median(len(values))
    middle = values[(len(values) - 1) // 2], values[len(values) // 2]
    center = middle[0] if middle[0] == middle[1] else 0.5 * (middle[0] + middle[1])
    return Interval(float(center), float(values[k - 1]), float(values[-k]))


def means(values: Array, level: float = CONFIDENCE_LEVEL) -> Intervals:
    """Mean of every column of (N, k); NaN below one value, ends below two."""
    from scipy.stats import t

    count = len(values)
    if count < 2:
        nothing = np.full(values.shape[1:], np.nan)
        return Intervals(values[0] if count else nothing, nothing, nothing)
    center = values.mean(axis=0)
    half = t.ppf((1 + level) / 2, count - 1) * values.std(axis=0, ddof=1) / np.sqrt(count)
    return Intervals(center, center - half, center + half)


def deviations(values: Array, level: float = CONFIDENCE_LEVEL) -> Intervals:
    """Standard deviation of every column of (N, k); NaN below two values."""
    from scipy.stats import chi2

    free = len(values) - 1
    if free < 1:
        nothing = np.full(values.shape[1:], np.nan)
        return Intervals(nothing, nothing, nothing)
    spread = values.std(axis=0, ddof=1)
    low, high = (np.sqrt(free / chi2.ppf(p, free)) for p in ((1 + level) / 2, (1 - level) / 2))
    return Intervals(spread, spread * low, spread * high)
