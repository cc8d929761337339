"""What every model has to beat: a constant torque, and the links of CAD with drives fitted to them."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.identifying.holding_out import Division
from crosscheck.identifying.pooling import pooled
from crosscheck.identifying.preparation import Preparation
from crosscheck.identifying.trial_problems import problems_of
from graphdyn import RobotModel
from graphdyn.identification import OrdinaryLeastSquares, ResidualStatistics, TorqueModel, residual_statistics
from graphdyn.identification.terms import Offset


@dataclass(frozen=True, eq=False)
class Baselines:
    """Their errors on the rows that the methods predict.

    constant: the mean torque of the fitted rows; cad: links as given, drives fitted; None where no link is unknown
    """

    constant: ResidualStatistics
    cad: ResidualStatistics | None


def constant_errors(robot: RobotModel, preparation: Preparation, division: Division) -> ResidualStatistics:
    """Of the mean torque of the fitted rows."""
    fit, parts = preparation.problem(TorqueModel(robot, (Offset(),)), division.fit), []
    for trial in division.trials:
        train, test, _ = problems_of(trial, fit, division.fit, preparation)
        x = OrdinaryLeastSquares().estimate(train).parameters
        parts.extend(residual_statistics(test, x[None]))
    return pooled(parts)
