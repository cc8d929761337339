"""Regressors of energies and momenta, and derivatives by the inertial parameters."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.referee.pinocchio_model.ordered import OrderedModel
from graphdyn.layout import Array


def parameter_values(
    robot: OrderedModel, rooted: OrderedModel, weightless: OrderedModel, q: Array, v: Array, tau: Array
) -> dict[str, Array]:
    """Of one state, q, v, tau in Pinocchio's order.

    rooted: the robot moved to the world's origin, about which Pinocchio computes
    weightless: the robot without gravity, whose torques at rest are M a: with v for a, the momenta M v
    """
    native, data = robot.native, robot.data
    a = np.array(pin.aba(rooted.native, rooted.data, q, v, tau))
    inverse = rooted.symmetric(pin.computeMinverse(rooted.native, rooted.data, q))
    return {
        "kinetic_energy_regressor": robot.parameters_of(pin.computeKineticEnergyRegressor(native, data, q, v)),
        "potential_energy_regressor": robot.parameters_of(pin.computePotentialEnergyRegressor(native, data, q)),
        "momentum_regressor": weightless.regressor_of(q, np.zeros_like(v), v),
        "da_dpi": -inverse @ rooted.regressor_of(q, v, a),
    }
