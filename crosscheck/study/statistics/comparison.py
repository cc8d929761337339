"""Methods compared two by two: which is better, by how much, and how sure that is.

The run is the unit: its records share their random numbers, and differ from those of other runs in motion, CAD model,
start and noise. Of two methods each run has one number, the mean over its scenarios of the logarithm of their errors'
ratio. Wilcoxon's signed ranks with Holm's correction decide whether one is better; the ratio has Student's interval,
simultaneous over all pairs by Bonferroni's inequality. Which other methods take part changes only the number of pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from crosscheck.study.settings.design import DEFAULT_REFERENCE, StudyDesign
from crosscheck.study.statistics.intervals import CONFIDENCE_LEVEL, Interval
from crosscheck.study.statistics.signed_ranks import (
    detectable_shift,
    fewest_runs,
    holm,
    needed_runs,
    probabilities,
    tendency,
)
from graphdyn.layout import Array

SAME_METHOD_TOLERANCE = 1e-3
"""Methods whose errors differ by less than this part in every record are one: nobody could tell their models apart."""

Verdict = Literal["better", "worse", "equivalent", "undecided"]


@dataclass(frozen=True)
class MethodPair:
    """One method against another.

    ratio: geometric mean of error / error of the other over the runs in which both have all answers, with the ends of
        its simultaneous interval; an end is infinite, or zero, where one alone has failed in some run
    probability: of signed ranks as uneven if the two were alike, with Holm's correction
    runs: that enter the ratio
    failed, other_failed: runs with a scenario in which it has no error where the other has one, and the reverse
    verdict: of the method; equivalent where the whole interval is within the region
    detectable: ratio that this study can show; None where nothing is known of the scatter
    more_runs: that would show the ratio of the region, about; None where nothing is known, or nothing is needed
    """

    method: str
    other: str
    ratio: Interval
    probability: float
    runs: int
    failed: int
    other_failed: int
    verdict: Verdict
    detectable: float | None
    more_runs: int | None


@dataclass(frozen=True, eq=False)
class PairedComparison:
    """Methods that measure the same, compared by one error.

    reference: with which all others are compared, if not all are with all
    pairs: all that are compared
    same: groups of methods that are one; the first of each takes part in the pairs
    runs: that every scenario has, R
    scenarios: over which each run is averaged, S
    fewest: runs below which nothing can be decided
    """

    reference: str
    pairs: tuple[MethodPair, ...]
    same: tuple[tuple[str, ...], ...]
    runs: int
    scenarios: int
    fewest: int

    def of(self, verdict: Verdict) -> tuple[MethodPair, ...]:
        """Pairs with the reference that have this verdict, the smallest ratio first."""
        found = [pair for pair in self.with_reference.values() if pair.verdict == verdict]
        return tuple(sorted(found, key=lambda pair: pair.ratio.value))

    def first(self, method: str) -> str:
        """The method that is compared in place of this one."""
        return next((group[0] for group in self.same if method in group), method)

    def ratio(self, method: str) -> Interval:
        """Ratio of any method's error to that of the reference, for those that are one with another too."""
        first = self.first(method)
        if first == self.reference:
            return Interval(1.0, 1.0, 1.0)
        return self.with_reference[first].ratio

    @property
    def with_reference(self) -> dict[str, MethodPair]:
        """Comparisons with the reference, by the name of the method."""
        return {pair.method: pair for pair in self.pairs if pair.other == self.reference}


def compared(
    errors: Array, names: Sequence[str], design: StudyDesign, level: float = CONFIDENCE_LEVEL
) -> PairedComparison:
    """Compare M methods by their errors (R, S, M), which are infinite where there is none."""
    reference = reference_of(names, design)
    order = sorted(range(len(names)), key=lambda k: names[k] != reference)
    names, errors = [names[k] for k in order], errors[:, :, order]
    first = same_methods(errors).tolist()
    distinct = list(dict.fromkeys(first))
    groups = [tuple(name for name, of in zip(names, first, strict=True) if of == one) for one in distinct]
    pairs = [(one, 0) for one in distinct[1:]]
    if design.pairs == "all":
        pairs += [(one, other) for k, one in enumerate(distinct[1:], start=1) for other in distinct[1:k]]
    every = [(errors[:, :, one], errors[:, :, other]) for one, other in pairs]
    differences = [run_differences(*both) for both in every]
    adjusted = holm(probabilities(np.reshape(differences, (len(pairs), len(errors))).T))
    found = [
        _compared(names[one], names[other], values, failed_alone(*both), float(p), len(pairs), design.region, level)
        for (one, other), both, values, p in zip(pairs, every, differences, adjusted, strict=True)
    ]
    fewest = fewest_runs(max(1, len(pairs)), level)
    same = tuple(group for group in groups if len(group) > 1)
    return PairedComparison(reference, tuple(found), same, len(errors), errors.shape[1], fewest)


def reference_of(names: Sequence[str], design: StudyDesign) -> str:
    """The method that the design names, if it is among these; else the usual one, else the first."""
    return next(name for name in (design.reference, DEFAULT_REFERENCE, *names) if name is not None and name in names)


def pair_count(methods: int, design: StudyDesign) -> int:
    """Pairs that are compared of so many methods, if none are one."""
    return methods - 1 if design.pairs == "reference" else methods * (methods - 1) // 2


def same_methods(errors: Array) -> NDArray[np.int64]:
    """The number of the first method that each of M is one with (M,), from errors (R, S, M).

    Methods that have always failed are each their own.
    """
    records = errors.reshape(-1, errors.shape[-1])
    first = np.arange(records.shape[1])
    for k in range(1, len(first)):
        for j in np.unique(first[:k]):
            one, other = records[:, j], records[:, k]
            with np.errstate(invalid="ignore"):
                close = np.abs(one - other) <= SAME_METHOD_TOLERANCE * np.minimum(one, other)
            if np.isfinite(one).any() and np.all(close | (one == other)):
                first[k] = j
                break
    return first


def run_differences(one: Array, other: Array) -> Array:
    """Mean over the scenarios of log(error / error of the other) (R,), from errors (R, S), infinite for failures.

    Scenarios in which both have failed are left out of the mean. Infinite where one alone has failed in any; NaN where
    each has failed alone in some scenario, or both in all.

    >>> run_differences(np.array([[2.0, 2.0], [1.0, np.inf]]), np.array([[1.0, np.inf], [1.0, 3.0]])).tolist()
    [-inf, inf]
    """
    both = np.isinf(one) & np.isinf(other)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.where(both, 0.0, np.log(one) - np.log(other))
        mean: Array = logs.sum(axis=1) / (~both).sum(axis=1)
    return mean


def failed_alone(one: Array, other: Array) -> tuple[int, int]:
    """Runs with a scenario in which one has failed alone, and the same of the other, from errors (R, S)."""
    lost, other_lost = np.isinf(one), np.isinf(other)
    return int((lost & ~other_lost).any(axis=1).sum()), int((other_lost & ~lost).any(axis=1).sum())


def _compared(
    method: str,
    other: str,
    values: Array,
    failures: tuple[int, int],
    adjusted: float,
    pairs: int,
    region: float,
    level: float,
) -> MethodPair:
    """values: differences of the runs (R,); failures: as failed_alone"""
    finite = values[np.isfinite(values)]
    failed, other_failed = failures
    uneven = len(finite) < len(values)
    ratio = _ratio(finite, failed, other_failed, pairs, level)
    spread = float(finite.std(ddof=1)) if len(finite) > 1 else 0.0
    detectable = more = None
    if spread > 0:
        detectable = float(np.exp(spread * detectable_shift(len(values), pairs, level)))
        more = max(0, needed_runs(float(np.log1p(region)) / spread, pairs, level) - len(values)) or None
    if not uneven and ratio.low * (1 + region) >= 1 and ratio.high <= 1 + region:
        verdict: Verdict = "equivalent"
    elif adjusted <= 1 - level:
        verdict = "better" if tendency(values) < 0 else "worse"
    else:
        verdict = "undecided"
    return MethodPair(method, other, ratio, adjusted, len(finite), failed, other_failed, verdict, detectable, more)


def _ratio(finite: Array, failed: int, other_failed: int, pairs: int, level: float) -> Interval:
    """exp of mean and Student's interval, which failures of one alone leave open."""
    from scipy.stats import t

    if len(finite) < 2:
        value = float(np.exp(finite[0])) if len(finite) else np.nan
        return Interval(value, np.nan, np.nan)
    quantile = float(t.ppf(1 - (1 - level) / (2 * pairs), len(finite) - 1))
    half = quantile * float(finite.std(ddof=1)) / np.sqrt(len(finite))
    center = float(finite.mean())
    return Interval(
        float(np.exp(center)),
        0.0 if other_failed else float(np.exp(center - half)),
        np.inf if failed else float(np.exp(center + half)),
    )
