"""Recommendation of one of several results for simulation and control, with its reason.

The error of a result is taken per joint, over the rows in which it moves, and as the mean over the joints. The mean
errors of two results are compared with the standard deviation of their difference. For this the predicted rows are cut
into pieces, each of which is left out once:

    deviation² = (K - 1) / K Σ_k (d_k - mean d)²,  d_k the difference of the mean errors without piece k

This is a delete-one-group jackknife of a paired difference: pieces that are hard to predict for both results cancel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crosscheck.identifying.results.identified_model import Candidate
from graphdyn.display import short_repr
from graphdyn.identification import MethodResult, ResidualStatistics
from graphdyn.layout import Array

MIN_MOVING_ROWS = 50
"""Smallest number of moving rows of a joint; with fewer, its error is taken over all rows."""


def joint_errors(statistics: ResidualStatistics) -> Array:
    """‖e‖ / ‖τ‖ per joint (n,): over the rows in which it moves, or over all rows if these are too few."""
    enough = statistics.moving.count >= MIN_MOVING_ROWS
    return np.where(enough, statistics.moving.relative, statistics.everything.relative)


def mean_error(result: MethodResult) -> float:
    """Mean over the joints of the held-out error, or of the training error if nothing was held out."""
    statistics = result.held_out or result.training
    return float(np.nanmean(joint_errors(statistics))) if statistics is not None else float("nan")


MIN_PIECES = 10
"""Smallest total number of pieces: each fold, each recording, or this many parts of one."""


class Difference(NamedTuple):
    """Difference of the mean errors of two results. deviation: its standard deviation."""

    value: float
    deviation: float


def difference(first: Candidate, second: Candidate) -> Difference:
    """Mean error of the first result minus that of the second; both with an estimate, on the same rows."""
    without = [_mean_errors(candidate) for candidate in (first, second)]
    whole, left_out = (np.subtract(*parts) for parts in zip(*without, strict=True))
    pieces = len(left_out)
    variance = (pieces - 1) / pieces * np.sum((left_out - left_out.mean()) ** 2)
    return Difference(float(whole), float(np.sqrt(variance)))


def _mean_errors(candidate: Candidate) -> tuple[Array, Array]:
    """Mean error over the joints on all predicted rows (), and on all but one piece (K,)."""
    trials = candidate.model.trials
    parts = [trial.squares(-(-MIN_PIECES // len(trials))) for trial in trials]
    moving = [part.moving[candidate.result.name] for part in parts]
    everything = [part.everything[candidate.result.name] for part in parts]
    enough = sum(part.moving_rows for part in parts) >= MIN_MOVING_ROWS
    errors = np.where(enough, np.concatenate(moving), np.concatenate(everything))
    measured = np.where(
        enough,
        np.concatenate([part.measured_moving for part in parts]),
        np.concatenate([part.measured for part in parts]),
    )
    whole = _mean(errors.sum(axis=0), measured.sum(axis=0))
    return whole, _mean(errors.sum(axis=0) - errors, measured.sum(axis=0) - measured)


def _mean(errors: Array, measured: Array) -> Array:
    """Mean over the joints of ‖e‖ / ‖τ‖ from their squares (…, n)."""
    ratio = np.divide(errors, measured, out=np.full(errors.shape, np.nan), where=measured > 0)
    return np.asarray(np.nanmean(np.sqrt(np.maximum(ratio, 0.0)), axis=-1))


ZERO_TORQUE_ERROR = 1.0
"""Relative error of a model that predicts zero torque."""

TIE_TOLERANCE = 1e-6
"""Relative difference of errors that counts as rounding; of methods so close, the first is taken."""


@dataclass(frozen=True)
@short_repr
class Recommendation:
    """The recommended result.

    name: of the method to trust; None where there is none
    reason: why this one, or why none, in one sentence
    best: method that would be recommended without the rejection reasons; None where no result is consistent
    rejection_reasons: reasons for the rejection, joint by joint
    """

    name: str | None
    reason: str
    best: str | None = None
    rejection_reasons: tuple[str, ...] = ()


def real(result: MethodResult) -> bool:
    """Whether every link is physically consistent, and the mass matrix positive definite in every tested pose."""
    plausible = result.plausibility
    return plausible is not None and plausible.consistent and plausible.positive_definite == plausible.poses


def recommendation(candidates: Sequence[Candidate]) -> Recommendation:
    """The physically consistent result with the smallest mean held-out error, or a simpler one that is as good.

    Of results that differ by less than one standard deviation of their difference, the simplest is taken: the rule of
    one standard error of Breiman, Friedman, Olshen and Stone, Classification and Regression Trees, 1984, section 3.4.3.
    """
    answered = [candidate for candidate in candidates if candidate.result.failure is None]
    if not answered:
        return Recommendation(None, "no method has a result")
    consistent = [candidate for candidate in answered if real(candidate.result)]
    if not consistent:
        failed = [candidate for candidate in candidates if candidate.result.failure is not None]
        remedy = (
            f"{', '.join(candidate.name for candidate in failed)} failed: {failed[0].result.failure}"
            if failed
            else "add the methods consistent, entropic or log-cholesky"
        )
        return Recommendation(
            None,
            "no result is physically consistent: each has a link that cannot be a real body, or a mass matrix that is "
            f"not positive definite in some pose; {remedy}",
        )
    smallest = min(mean_error(candidate.result) for candidate in consistent)
    best = next(c for c in consistent if not mean_error(c.result) > smallest * (1 + TIE_TOLERANCE))
    error = mean_error(best.result)
    if not error < ZERO_TORQUE_ERROR:
        return Recommendation(
            None,
            f"the best consistent result, {best.name}, predicts with a mean error of {100 * error:.0f} %, no better "
            "than a torque of zero; the torque model or the recording is wrong, or the robot stands still in all "
            "held-out rows",
        )
    simplest = min((c for c in consistent if c is best or _as_good(c, best)), key=simplicity)
    words = "physically consistent in every link and pose, and its held-out error, averaged over the joints, is "
    if simplest is not best:
        apart = difference(simplest, best)
        advantage = "more parameters" if numbers_of(best) > numbers_of(simplest) else "the weaker prior"
        return Recommendation(
            simplest.name,
            f"{words}{100 * mean_error(simplest.result):.1f} %; {best.name} has {100 * error:.1f} % and "
            f"{advantage}, and the difference is less than its standard deviation over the pieces of the "
            f"held-out rows, {100 * apart.deviation:.1f} %",
            best=simplest.name,
        )
    others = f"the smallest of {len(consistent)} such results" if len(consistent) > 1 else "the only such result"
    return Recommendation(best.name, f"{words}{100 * error:.1f} %, {others}", best=best.name)


def simplicity(candidate: Candidate) -> tuple[int, float, float]:
    """Sort key, small for a simple result: few base parameters and settings, strong prior of the links, small error.

    Methods without a prior have one of strength zero.
    """
    assert candidate.result.estimate is not None
    strength = float(candidate.result.estimate.settings.get("strength", 0.0))
    return (numbers_of(candidate), -strength, mean_error(candidate.result))


def numbers_of(candidate: Candidate) -> int:
    """Number of base parameters and settings that were found."""
    return candidate.model.problem.base.rank + sum(len(setting.values) for setting in candidate.model.settings)


def _as_good(candidate: Candidate, best: Candidate) -> bool:
    """Whether a result is simpler, and predicts worse by less than the uncertainty of the difference."""
    if not simplicity(candidate)[:2] < simplicity(best)[:2]:
        return False
    apart = difference(candidate, best)
    return apart.value <= apart.deviation


def rejected(found: Recommendation, rejection_reasons: tuple[str, ...]) -> Recommendation:
    """The recommendation, withdrawn if there are rejection reasons."""
    if not rejection_reasons:
        return found
    count = "one reason speaks" if len(rejection_reasons) == 1 else f"{len(rejection_reasons)} reasons speak"
    reason = found.reason if found.best is None else f"{found.best} is the best result, but {count} against it"
    return Recommendation(None, f"{reason}: {'; '.join(rejection_reasons)}", found.best, rejection_reasons)
