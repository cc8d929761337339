"""Equations and pooled errors of trials, and the baselines that every model has to outperform in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.identifying.preparing.holding_out import Division, Fold
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn import RobotModel
from graphdyn.identification import (
    OrdinaryLeastSquares,
    Problem,
    ResidualSizes,
    ResidualStatistics,
    TorqueModel,
    residual_statistics,
)
from graphdyn.identification.terms import Offset
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
    """Statistics of all rows of all trials. Whiteness and correlation of several trials are NaN: they have gaps."""
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


@dataclass(frozen=True, eq=False)
class Baselines:
    """Errors of the baselines on the rows that the methods predict.

    constant: the mean torque of the fitted rows; cad: links as given, drives fitted; None where no link is unknown
    """

    constant: ResidualStatistics
    cad: ResidualStatistics | None


def constant_model(robot: RobotModel) -> TorqueModel:
    """A constant torque per joint."""
    return TorqueModel(robot, (Offset(),))


def fitted_constant(train: Problem, test: Problem) -> ResidualStatistics:
    """Errors on the rows of `test` of the mean torque of those of `train`, both of a constant_model."""
    (errors,) = residual_statistics(test, OrdinaryLeastSquares().estimate(train).parameters[None])
    return errors


def constant_errors(robot: RobotModel, preparation: Preparation, division: Division) -> ResidualStatistics:
    """Errors of the mean torque of the fitted rows, of all trials together."""
    fit, parts = preparation.problem(constant_model(robot), division.fit), []
    for trial in division.trials:
        train, test, _ = problems_of(trial, fit, division.fit, preparation)
        parts.append(fitted_constant(train, test))
    return pooled(parts)
