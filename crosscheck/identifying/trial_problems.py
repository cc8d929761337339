"""The equations of a trial: of the rows that are fitted, and of those that are predicted."""

from __future__ import annotations

from crosscheck.identifying.holding_out import Trial
from crosscheck.identifying.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn.identification import Problem
from graphdyn.layout import Array


def problems_of(
    trial: Trial, fit: Problem, recording: Recording, preparation: Preparation
) -> tuple[Problem, Problem, list[Array]]:
    """Of the rows that are fitted, of those that are predicted, and the times of these; fit: that of the recording."""
    if trial.fold is None:
        train, test = (preparation.problem(fit.torque_model, rows) for rows in (trial.train, trial.test))
        return train, test, preparation.times(trial.test)
    (train, _), (test, times) = (preparation.part(fit, recording, rows) for rows in trial.fold)
    return train, test, times
