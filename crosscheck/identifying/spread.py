"""By how much the mean errors of two results differ, and how certain that is.

The predicted rows are cut into pieces; each is left out once, and the scatter of the differences gives its deviation:

    deviation² = (K - 1) / K Σ_k (d_k - mean d)²,  d_k the difference of the mean errors without piece k

A delete-one-group jackknife of a paired difference: pieces that are hard to predict for both results do not count.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crosscheck.identifying.identified_model import Candidate
from crosscheck.identifying.result_errors import LEAST_ROWS
from graphdyn.layout import Array

PIECES = 10
"""At least so many pieces in all: each fold, each recording, or as many parts of one."""


class Difference(NamedTuple):
    """Of the mean errors of two results. deviation: standard deviation of the difference"""

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
    parts = [trial.squares(-(-PIECES // len(trials))) for trial in trials]
    moving = [part.moving[candidate.result.name] for part in parts]
    everything = [part.everything[candidate.result.name] for part in parts]
    enough = sum(part.moving_rows for part in parts) >= LEAST_ROWS
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
