"""Folds of the rows of a fit, by which terms are chosen and residuals examined."""

from __future__ import annotations

from math import prod

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.recordings.preparation.filtering import filtered_blocks, settling_time
from crosscheck.recordings.preparation.splits import GUARD_TIME, fold_rows

FOLDS = 8
"""Number of folds: enough for a standard deviation, few enough for folds of a second in ten."""

MIN_FOLD_GUARDS = 2.0
"""Shortest fold, in guards: what is left out around a fold must not be most of the recording."""

MAX_ROWS = 100_000
"""Largest number of rows that are looked at, from the beginning: friction with memory is computed for all of a run at
once, which takes a kilobyte a row."""

MAX_LEAKAGE = 1e-2
"""Fraction of a predicted torque that the filter may still carry into the fit across the guard."""


def beginning(recording: Recording) -> Recording:
    """The rows that are looked at: all of a recording, or the first MAX_ROWS."""
    return recording if len(recording.t) <= MAX_ROWS else recording.take(slice(None, MAX_ROWS))


def choosing_folds(
    recording: Recording, preparation: Preparation
) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]] | str:
    """Rows of each fold's fit and prediction, as those of the equations; or why there are none."""
    guard = max(GUARD_TIME, settling_time(float(recording.torque_cutoff.min()), MAX_LEAKAGE))
    blocks, factor = filtered_blocks(recording, preparation.decimate), prod(preparation.decimate)
    length, needed = sum(float(np.ptp(recording.t[rows])) for rows in blocks), FOLDS * MIN_FOLD_GUARDS * guard
    if length < needed:
        return (
            f"{length:.3g} s are too short for {FOLDS} folds with {guard:.2g} s left out around each; record "
            f"{needed:.3g} s or more"
        )
    return [
        tuple(np.concatenate([rows[block][::factor] for block in blocks]) for rows in pair)  # type: ignore[misc]
        for pair in fold_rows(recording, FOLDS, guard)
    ]
