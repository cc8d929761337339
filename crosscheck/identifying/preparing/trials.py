"""Equations of a trial, for the fitted and the predicted rows, and residual statistics pooled over several trials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.identifying.preparing.holding_out import Fold
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn.identification import Problem, ResidualSizes, ResidualStatistics
from graphdyn.layout import Array


def problems_of(
    trial: Fold, fit: Problem, recording: Recording, preparation: Preparation
) -> tuple[Problem, Problem, list[Array]]:
    """Problems of the fitted and of the predicted rows, and the times of the latter; fit: problem of the recording."""
    if trial.fold is None:
        train, test = (preparation.problem(fit.torque_model, rows) for rows in (trial.train, trial.test))
        return train, test, preparation.times(trial.test)
    (train, _), (test, times) = (preparation.part(fit, recording, rows) for rows in trial.fold)
    return train, test, times


def pooled(parts: Sequence[ResidualStatistics]) -> ResidualStatistics:
    """Statistics of all rows of all trials. Whiteness and correlation are NaN for several trials, because of the
    gaps.
    """
    if len(parts) == 1:
        return parts[0]
    unknown = np.full(len(parts[0].durbin_watson), np.nan)
    return ResidualStatistics(
        pooled_sizes([part.everything for part in parts]),
        pooled_sizes([part.moving for part in parts]),
        unknown,
        unknown,
        unknown,
    )


def pooled_sizes(parts: Sequence[ResidualSizes]) -> ResidualSizes:
    """Sizes of the residuals of all parts together; NaN if no part has a sample."""
    counts = np.array([part.count for part in parts])
    total = counts.sum(axis=0)
    means, rms, relative = (np.array([getattr(part, name) for part in parts]) for name in ("mean", "rms", "relative"))
    squares = np.where(counts > 0, counts * rms**2, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = np.where(squares > 0, squares / relative**2, 0.0).sum(axis=0)
        largest = np.max([np.where(counts[k] > 0, parts[k].largest, -np.inf) for k in range(len(parts))], axis=0)
        return ResidualSizes(
            total,
            np.where(counts > 0, counts * means, 0.0).sum(axis=0) / total,
            np.sqrt(squares.sum(axis=0) / total),
            np.where(total > 0, largest, np.nan),
            np.sqrt(squares.sum(axis=0) / measured),
        )
