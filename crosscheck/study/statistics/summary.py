"""What a study found, in numbers: scenarios and methods summarized, methods of each class compared and ranked."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.study.settings.design import DEFAULT_DESIGN, StudyDesign
from crosscheck.study.statistics.comparison import PairedComparison, compared
from crosscheck.study.statistics.intervals import Interval, Intervals, deviations, means, median, share
from crosscheck.study.statistics.outcomes import DISTANCES, ERRORS, Measures, Method, ScenarioOutcomes, StudyOutcomes
from crosscheck.study.statistics.ranking import Ranking, ranked
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class ParameterSpread:
    """What the runs of one scenario that a method did not fail say of every base parameter, each (b,).

    Where runs differ in motion and CAD model, bias and spread are means over these: a method that pulls parameters
    towards CAD values has no bias then. What it states is measured by z instead.

    bias: mean of found minus true; spread: standard deviation
    z: root mean square of (found - true) / standard deviation that the method states; 1 is honest; NaN where it states
        none
    held_bias: root mean square over the runs of the bias for one motion and one CAD model, without what noise leaves of
        it; NaN where the noise is not drawn again
    shares: part of the variance that each source has, by its name; NaN where it is not drawn again
    """

    bias: Intervals
    spread: Intervals
    z: Array
    held_bias: Array
    shares: Mapping[str, Array]

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
    distances: means of d_beta, d_tau, d_q over the answers that have not diverged, and how many have; NaN where unknown
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
    distances: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class ScenarioSummary:
    """comparisons: of every class that has two methods or more, by what it measures and the name of the error"""

    outcomes: ScenarioOutcomes
    methods: tuple[MethodSummary, ...]
    comparisons: Mapping[tuple[Measures, str], PairedComparison]


@dataclass(frozen=True, eq=False)
class StudySummary:
    """comparisons, rankings: over all scenarios, by what the methods measure and the name of the error"""

    outcomes: StudyOutcomes
    design: StudyDesign
    scenarios: tuple[ScenarioSummary, ...]
    comparisons: Mapping[tuple[Measures, str], PairedComparison]
    rankings: Mapping[tuple[Measures, str], Ranking]

    def methods(self, measures: Measures) -> list[int]:
        """Numbers of the methods that measure this, the best by torque error first."""
        columns = self.outcomes.columns(measures)
        ranking = self.rankings.get((measures, "torque_error"))
        if ranking is None:
            return columns
        return sorted(columns, key=lambda k: ranking.methods.index(self.outcomes.methods[k].name))


def summarized(found: StudyOutcomes, design: StudyDesign = DEFAULT_DESIGN) -> StudySummary:
    """All statistics of a study."""
    scenarios = []
    for scenario in found.scenarios:
        methods = tuple(_method(scenario, method, k) for k, method in enumerate(found.methods))
        comparisons = {
            key: compared(errors, names, design) for key, (names, errors) in _tables(found, (scenario,)).items()
        }
        scenarios.append(ScenarioSummary(scenario, methods, comparisons))
    tables = _tables(found, found.scenarios)
    rankings = {key: ranked(names, errors) for key, (names, errors) in tables.items()}
    return StudySummary(
        found,
        design,
        tuple(scenarios),
        {key: compared(errors, names, design) for key, (names, errors) in tables.items()},
        {key: ranking for key, ranking in rankings.items() if ranking is not None},
    )


def _tables(
    found: StudyOutcomes, scenarios: Sequence[ScenarioOutcomes]
) -> dict[tuple[Measures, str], tuple[tuple[str, ...], Array]]:
    """Names and errors (R, S, M) of the methods of each class of two or more, by what it measures and by error.

    Over the scenarios in which all of them take part, and the runs that all of these have.
    """
    tables: dict[tuple[Measures, str], tuple[tuple[str, ...], Array]] = {}
    classes: tuple[Measures, Measures] = ("torques", "wrenches")
    for measures in classes:
        columns = found.columns(measures)
        complete = [one for one in scenarios if one.taken[columns].all()]
        if len(columns) < 2 or not complete:
            continue
        runs = sorted(set.intersection(*(set(one.runs.tolist()) for one in complete)))
        for error in ERRORS:
            parts = [one.errors[error][np.isin(one.runs, runs)][:, columns] for one in complete]
            errors = np.stack(parts, axis=1)
            if np.isfinite(errors).any():
                tables[measures, error] = tuple(found.methods[k].name for k in columns), errors
    return tables


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
        _spread(scenario, k, answered),
        dict(Counter(reason for (_, j), reason in sorted(scenario.reasons.items()) if j == k).most_common()),
        mean_distances({name: values[answered, k] for name, values in scenario.distances.items()}),
    )


def mean_distances(distances: Mapping[str, Array]) -> dict[str, float]:
    """Means of d_beta, d_tau, d_q over the answers that have not diverged, and how many have; NaN where unknown.

    distances: by the names of DISTANCES (R,)
    """
    far = distances["diverged"]
    known = {name: values[(far != 1) & np.isfinite(values)] for name, values in distances.items()}
    found = {name: float(np.mean(known[name])) if len(known[name]) else np.nan for name in DISTANCES[:-1]}
    return {**found, "diverged": float(np.nansum(far)) if np.isfinite(far).any() else np.nan}


def _spread(scenario: ScenarioOutcomes, k: int, answered: NDArray[np.int64]) -> ParameterSpread:
    base, sigma, truth = scenario.base[answered, k], scenario.sigma[answered, k], scenario.truth
    stated = ~np.isnan(sigma).any(axis=1)
    nothing = np.full(len(truth), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.sqrt((((base - truth) / sigma)[stated] ** 2).mean(axis=0)) if stated.any() else nothing
    spread = deviations(base)
    again = {source: drawn[answered, :, k] for source, drawn in scenario.redrawn.items()}
    shares = {source: _moved(base, drawn) / spread.value**2 for source, drawn in again.items()}
    held = _held_bias(base - truth, again["noise"] - truth) if "noise" in again else nothing
    return ParameterSpread(means(base - truth), spread, z, held, shares)


def _moved(base: Array, drawn: Array) -> Array:
    """Variance (b,) of base (R, b) that drawing one source once more, (R, K, b), shows: half the mean squared change.

    With its interactions: the total effect of Jansen, Computer Physics Communications 117, 1999.
    """
    with warnings.catch_warnings(action="ignore"):  # that all are missing
        return np.asarray(np.nanmean((drawn - base[:, None]) ** 2, axis=(0, 1)) / 2)


def _held_bias(off: Array, again: Array) -> Array:
    """Root mean square (b,) over the runs of the bias that noise alone does not explain.

    off, again: found minus true, and the same with other noise   (R, b), (R, K, b)
    """
    every = np.concatenate([off[:, None], again], axis=1)
    with warnings.catch_warnings(action="ignore"):  # that all are missing
        noise = np.nanvar(every, axis=1, ddof=1) / (~np.isnan(every)).sum(axis=1)
        square = np.nanmean(np.nanmean(every, axis=1) ** 2 - noise, axis=0)
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))


def _middle_and_largest(values: Array) -> tuple[float, float]:
    values = values[~np.isnan(values)]
    return (float(np.median(values)), float(values.max())) if len(values) else (np.nan, np.nan)
