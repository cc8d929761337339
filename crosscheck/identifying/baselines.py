"""What every model has to beat: a constant torque, and the links of CAD with drives fitted to them."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.identifying.holding_out import Division
from crosscheck.identifying.pooling import pooled
from crosscheck.identifying.preparation import Preparation
from graphdyn.identification import ResidualStatistics, TorqueModel, WeightedLeastSquares, residual_statistics
from graphdyn.identification.terms import KnownBodies, Offset, RigidBodies
from graphdyn.identification.terms.term import CarriesBodies


@dataclass(frozen=True, eq=False)
class Baselines:
    """Their errors on the rows that the methods predict.

    constant: the mean torque of the fitted rows; cad: links as given, drives fitted; None where no link is unknown
    """

    constant: ResidualStatistics
    cad: ResidualStatistics | None


def baselines(torque_model: TorqueModel, preparation: Preparation, division: Division) -> Baselines:
    constant = TorqueModel(torque_model.model, (Offset(),))
    cad = None
    if any(isinstance(term, RigidBodies) for term in torque_model.terms):
        drives = tuple(term for term in torque_model.terms if not isinstance(term, CarriesBodies)) or (Offset(),)
        known = TorqueModel(torque_model.model, drives, (KnownBodies(), *torque_model.known))
        cad = _predicted(known, preparation, division)
    return Baselines(_predicted(constant, preparation, division), cad)


def _predicted(torque_model: TorqueModel, preparation: Preparation, division: Division) -> ResidualStatistics:
    parts = []
    for split in division.trials:
        train, test = (preparation.problem(torque_model, recording) for recording in split)
        x = WeightedLeastSquares().estimate(train).parameters
        parts.extend(residual_statistics(test, x[None]))
    return pooled(parts)
