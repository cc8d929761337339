"""Which of several results can be trusted for simulation and control, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification import MethodComparison, MethodResult, ResidualStatistics
from graphdyn.layout import Array

LEAST_ROWS = 50
"""Moving rows of a joint; with fewer, all its rows are taken."""

NOTHING = 1.0
"""Relative error of a model that predicts no torque at all."""

TIE = 1e-6
"""Errors this close, relative, are the same but for rounding; the first method of those is taken."""


@dataclass(frozen=True)
class Recommendation:
    """Which result to use.

    name: of the method, None where no result can be used
    reason: in a sentence
    """

    name: str | None
    reason: str


def joint_errors(statistics: ResidualStatistics) -> Array:
    """‖e‖ / ‖τ‖ per joint over its moving rows, over all rows where it hardly moves (n,)."""
    enough = statistics.moving.count >= LEAST_ROWS
    return np.where(enough, statistics.moving.relative, statistics.everything.relative)


def mean_error(result: MethodResult) -> float:
    """Mean over the joints of the held-out error, of the training error where nothing was held out."""
    statistics = result.held_out or result.training
    return float(np.nanmean(joint_errors(statistics))) if statistics is not None else float("nan")


def real(result: MethodResult) -> bool:
    """Every link can be real, and the mass matrix is positive definite in every pose that was tried."""
    plausible = result.plausibility
    return (
        plausible is not None
        and plausible.consistent
        and plausible.positive_definite == len(plausible.mass_matrix_eigenvalues)
    )


def recommendation(comparison: MethodComparison) -> Recommendation:
    """The physically consistent result with the smallest mean held-out error."""
    answered = [result for result in comparison.results if result.failure is None]
    if not answered:
        return Recommendation(None, "no method has an answer")
    consistent = [result for result in answered if real(result)]
    if not consistent:
        return Recommendation(
            None,
            "no result is physically consistent: every one has a link that no real body can be, or a mass matrix that "
            "is not positive definite in some pose; add the methods consistent, entropic or log-cholesky",
        )
    smallest = min(map(mean_error, consistent))
    best = next(result for result in consistent if not mean_error(result) > smallest * (1 + TIE))
    error = mean_error(best)
    if not error < NOTHING:
        return Recommendation(
            None,
            f"the best consistent result, {best.name}, predicts with a mean error of {100 * error:.0f} %, no better "
            "than a torque of zero; the torque model or the recording is wrong, or held-out rows are all standstill",
        )
    others = f"the smallest of {len(consistent)} such results" if len(consistent) > 1 else "the only such result"
    return Recommendation(
        best.name,
        f"physically consistent in every link and pose, and its held-out error is {100 * error:.1f} % on the mean over "
        f"the joints, {others}",
    )
