"""Baselines that every model has to outperform: a constant torque, and CAD links with fitted drives."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.identifying.preparing.holding_out import Division
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.preparing.trials import pooled, problems_of
from graphdyn import RobotModel
from graphdyn.identification import OrdinaryLeastSquares, Problem, ResidualStatistics, TorqueModel, residual_statistics
from graphdyn.identification.terms import Offset


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
