"""What signed ranks can decide: paired differences of one pair, and of many at once, and how many runs it takes.

Wilcoxon's test asks whether differences lie about zero; Holm's correction keeps the probability that any of several
true hypotheses is rejected. Wilcoxon, Biometrics Bulletin 1, 1945; Holm, Scandinavian Journal of Statistics 6, 1979;
for methods over data sets Benavoli, Corani and Mangili, Journal of Machine Learning Research 17, 2016.
"""

from __future__ import annotations

from functools import lru_cache
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL
from graphdyn.layout import Array

POWER = 0.9
"""Probability with which a difference that a study can show is shown."""

MAX_EXACT_RUNS = 100
"""Runs up to which sums of ranks have their exact distribution; beyond, a normal one."""

MAX_SHIFT = 20.0
"""Largest mean in standard deviations: beyond it no run has the other sign."""

MAX_NEEDED_RUNS = 1 << 30
"""More are never proposed."""


def probabilities(differences: Array) -> Array:
    """Probabilities (m,) of signed ranks as uneven as those of each column of (R, m), if all were even about zero.

    Infinite differences rank last; those of the rarer sign rank last of all, which is the cautious order. Zeros and NaN
    say nothing, and are left out; 1 where nothing is left.

    >>> probabilities(np.array([[0.1, 0.1], [0.2, 0.2], [0.3, 0.3], [0.4, 0.4], [0.5, np.inf]])).tolist()
    [0.0625, 0.0625]
    """
    from scipy.stats import wilcoxon

    columns = [_ranked_alike(column) for column in differences.T]
    found = np.ones(len(columns))
    for count in {len(column) for column in columns if len(column)}:
        alike = [k for k, column in enumerate(columns) if len(column) == count]
        found[alike] = wilcoxon(np.array([columns[k] for k in alike]), axis=1).pvalue
    return found


def tendency(differences: ArrayLike) -> float:
    """The sum of their signed ranks: below zero where most are, by their ranks.

    >>> tendency([-0.1, -0.2, 0.05])
    -4.0
    """
    from scipy.stats import rankdata

    values = _ranked_alike(np.asarray(differences, dtype=float))
    return float((np.sign(values) * rankdata(np.abs(values))).sum())


def _ranked_alike(differences: Array) -> Array:
    """Numbers of the same ranks, in place of what is infinite too, without zeros and NaN."""
    values: Array = differences[(differences != 0) & ~np.isnan(differences)]
    infinite = np.isinf(values)
    largest = float(np.abs(values[~infinite]).max(initial=1.0))
    signs = np.sign(values[infinite])
    rarer = -1.0 if signs.sum() >= 0 else 1.0
    order = np.argsort(signs == rarer, kind="stable")
    values[np.flatnonzero(infinite)[order]] = signs[order] * largest * (2.0 + np.arange(len(signs)))
    return values


def holm(probabilities: ArrayLike) -> Array:
    """Probabilities (m,) of m hypotheses, each as large as the level at which Holm's procedure would reject it.

    >>> holm([0.01, 0.04, 0.03]).tolist()
    [0.03, 0.06, 0.06]
    """
    values = np.asarray(probabilities, dtype=float)
    order = np.argsort(values, kind="stable")
    adjusted = np.empty(len(values))
    factors = np.arange(len(values), 0, -1)
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(factors * values[order]))
    return adjusted


def fewest_runs(pairs: int, level: float = CONFIDENCE_LEVEL) -> int:
    """Runs below which no difference of so many pairs can be decided, however clear it is: 2 / 2^R of all signs.

    >>> fewest_runs(1), fewest_runs(19), fewest_runs(190)
    (6, 10, 13)
    """
    runs = 1
    while 2.0 ** (1 - runs) > (1 - level) / pairs:
        runs += 1
    return runs


@lru_cache(maxsize=1024)
def detectable_shift(runs: int, pairs: int, level: float = CONFIDENCE_LEVEL) -> float:
    """The mean of normal differences, in their standard deviations, that is shown with the probability POWER.

    Beside so many pairs, of which it is the only one that differs: the first step of Holm's correction. Infinite where
    there are too few runs.
    """
    from scipy.optimize import brentq

    critical = _critical_sum(runs, (1 - level) / pairs)
    if critical < 0:
        return np.inf
    if critical == 0:  # all have one sign
        return NormalDist().inv_cdf(POWER ** (1 / runs))
    return float(brentq(lambda shift: _power(shift, runs, critical) - POWER, 0.0, MAX_SHIFT))


def needed_runs(shift: float, pairs: int, level: float = CONFIDENCE_LEVEL) -> int:
    """The smallest number of runs with which this shift is shown; as in detectable_shift.

    >>> needed_runs(1.0, 1) < needed_runs(1.0, 19) < needed_runs(0.5, 19)
    True
    """
    low = fewest_runs(pairs, level) - 1
    high = low + 1
    while high < MAX_NEEDED_RUNS and detectable_shift(high, pairs, level) > shift:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if detectable_shift(middle, pairs, level) <= shift else (middle, high)
    return high


def _critical_sum(runs: int, level: float) -> int:
    """The largest sum of ranks of one sign that both signs together have with a probability of at most level.

    -1 where even zero is more probable.
    """
    if runs > MAX_EXACT_RUNS:
        spread = np.sqrt(runs * (runs + 1) * (2 * runs + 1) / 24)
        return int(runs * (runs + 1) / 4 - NormalDist().inv_cdf(1 - level / 2) * spread - 0.5)
    counts = np.ones(1)
    for rank in range(1, runs + 1):
        counts = np.append(counts, np.zeros(rank)) + np.append(np.zeros(rank), counts)
    return int(np.count_nonzero(2 * np.cumsum(counts) / 2.0**runs <= level)) - 1


def _power(shift: float, runs: int, critical: int) -> float:
    """Probability that the ranks of the negative ones of normal differences about a mean sum up to no more.

    By mean and variance of the sum: Lehmann, Nonparametrics, 1975, section 4.2.
    """
    from scipy.special import ndtr, owens_t

    one = float(ndtr(shift))
    two = float(ndtr(np.sqrt(2) * shift))
    three = two - 2 * float(owens_t(np.sqrt(2) * shift, 1 / np.sqrt(3)))
    pairs = runs * (runs - 1)
    negative = runs * (runs + 1) / 2 - (pairs / 2 * two + runs * one)
    variance = pairs * (runs - 2) * (three - two**2) + pairs / 2 * (2 * (one - two) ** 2 + 3 * two * (1 - two))
    spread = np.sqrt(variance + runs * one * (1 - one))
    return float(ndtr((critical + 0.5 - negative) / spread)) if spread > 0 else float(negative <= critical)
