"""The methods of one class ranked by one error: in every scenario, and over all scenarios of the study."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.studies.identification.statistics.bootstrap import drawn_means, ends
from crosscheck.studies.identification.statistics.outcomes import ScenarioOutcomes
from crosscheck.studies.identification.statistics.ranking import Ranking, critical_distance, friedman, record_ranks
from graphdyn.layout import Array


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
    ratio_low, ratio_high = np.where(alone, np.nan, np.exp(ends(_drawn(logs, scenarios), runs)))
    return Ranking(
        methods=tuple(names[k] for k in order),
        mean=mean,
        low=np.minimum(low, mean),
        high=np.maximum(high, mean),
        ratio=np.exp(_mean_over([_mean_over(part) for part in shared])) if shared else np.full(len(order), np.nan),
        ratio_low=ratio_low,
        ratio_high=ratio_high,
        records=len(together),
        probability=friedman(together),
        distance=critical_distance(len(order), len(together)),
        failures=[int(failures[k]) for k in order],
    )


def _with_answers(
    found: Sequence[tuple[Array, ScenarioOutcomes]],
) -> tuple[list[Array], list[ScenarioOutcomes]]:
    """Without the records on which no method has an answer, of which nothing can be learned.

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
