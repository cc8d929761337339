"""Which of several results can be trusted for simulation and control, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification import MethodComparison, MethodResult, ResidualStatistics
from graphdyn.layout import Array

LEAST_ROWS = 50
"""Smallest number of moving rows of a joint; with fewer, its error is taken over all rows."""

NOTHING = 1.0
"""Relative error of a model that predicts zero torque."""

TIE = 1e-6
"""Relative difference of errors that counts as rounding; of methods so close, the first is taken."""


@dataclass(frozen=True)
class Recommendation:
    """Which result to use.

    name: of the method, None where no result can be used
    reason: one sentence
    best: of the method that would be recommended if there were no doubts; name where there are none
    doubts: why it is not, in sentences
    """

    name: str | None
    reason: str
    best: str | None = None
    doubts: tuple[str, ...] = ()


def joint_errors(statistics: ResidualStatistics) -> Array:
    """‖e‖ / ‖τ‖ per joint (n,): over the rows in which it moves, or over all rows if these are too few."""
    enough = statistics.moving.count >= LEAST_ROWS
    return np.where(enough, statistics.moving.relative, statistics.everything.relative)


def mean_error(result: MethodResult) -> float:
    """Mean over the joints of the held-out error, or of the training error where nothing was held out."""
    statistics = result.held_out or result.training
    return float(np.nanmean(joint_errors(statistics))) if statistics is not None else float("nan")


def real(result: MethodResult) -> bool:
    """Whether every link is physically consistent, and the mass matrix positive definite in every tested pose."""
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
        return Recommendation(None, "no method has a result")
    consistent = [result for result in answered if real(result)]
    if not consistent:
        failed = [result for result in comparison.results if result.failure is not None]
        remedy = (
            f"{', '.join(result.name for result in failed)} failed: {failed[0].failure}"
            if failed
            else "add the methods consistent, entropic or log-cholesky"
        )
        return Recommendation(
            None,
            "no result is physically consistent: each has a link that cannot be a real body, or a mass matrix that is "
            f"not positive definite in some pose; {remedy}",
        )
    smallest = min(map(mean_error, consistent))
    best = next(result for result in consistent if not mean_error(result) > smallest * (1 + TIE))
    error = mean_error(best)
    if not error < NOTHING:
        return Recommendation(
            None,
            f"the best consistent result, {best.name}, predicts with a mean error of {100 * error:.0f} %, no better "
            "than a torque of zero; the torque model or the recording is wrong, or the robot stands still in all "
            "held-out rows",
        )
    others = f"the smallest of {len(consistent)} such results" if len(consistent) > 1 else "the only such result"
    return Recommendation(
        best.name,
        f"physically consistent in every link and pose, and its held-out error, averaged over the joints, is "
        f"{100 * error:.1f} %, {others}",
        best=best.name,
    )


def doubted(found: Recommendation, doubts: tuple[str, ...]) -> Recommendation:
    """The recommendation, withdrawn if there are doubts."""
    if not doubts:
        return found
    count = "one reason speaks" if len(doubts) == 1 else f"{len(doubts)} reasons speak"
    reason = found.reason if found.best is None else f"{found.best} is the best result, but {count} against it"
    return Recommendation(None, f"{reason}: {'; '.join(doubts)}", found.best, doubts)
