"""Block bootstrap over runs: a run is drawn with the results of all methods, which had the same record.

Runs are independent, the results of one run are not. A percentile interval of few runs is too narrow: by the factor
sqrt((R - 1) / R) of the deviation, and because it has the quantiles of a normal distribution instead of Student's. The
percentiles are moved outwards by both, as in Hesterberg, The American Statistician 69(4), 2015, section 5.3.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from crosscheck.studies.identification.statistics.intervals import LEVEL
from graphdyn.layout import Array

DRAWS = 10_000
"""Resamples: those beyond an end of an interval of five runs are then about ten."""


def drawn_means(values: Array, name: str, draws: int = DRAWS) -> Array:
    """Means (draws, k) of the rows of values (R, k), drawn with replacement; a column's NaN are left out.

    name: of the scenario, from which the draws follow: other scenarios change nothing
    """
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    times = rng.multinomial(len(values), np.full(len(values), 1 / len(values)), size=draws).astype(float)
    there = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        mean: Array = (times @ np.where(there, values, 0.0)) / (times @ there)
    return mean


def ends(draws: Array, runs: Sequence[int], level: float = LEVEL) -> Array:
    """Low and high ends (2, k) of the interval of means over scenarios, from draws (B, k).

    runs: of each scenario; NaN where one scenario has fewer than two
    """
    if min(runs) < 2:
        return np.full((2, draws.shape[1]), np.nan)
    from scipy.stats import t

    free = sum(runs) - len(runs)
    wider = np.sqrt(sum(runs) / free)
    beyond = NormalDist().cdf(-wider * float(t.ppf((1 + level) / 2, free)))
    found = np.full((2, draws.shape[1]), np.nan)
    there = ~np.isnan(draws).all(axis=0)
    found[:, there] = np.nanquantile(draws[:, there], [beyond, 1 - beyond], axis=0)
    return found
