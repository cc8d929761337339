"""Center of mass and momentum of all bodies together."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.referee.pinocchio_model.ordered import OrderedModel
from graphdyn.layout import Array


def momenta(robot: OrderedModel, rooted: OrderedModel, q: Array, v: Array) -> dict[str, Array]:
    """Of one state, q and v in Pinocchio's order; world axes, linear first.

    rooted: the robot moved to the world's origin, about which Pinocchio computes; taken where the place does not matter
    """
    row = {"center_of_mass": np.array(pin.centerOfMass(robot.native, robot.data, q))}
    row["momentum_about_origin"] = _momentum_about_origin(robot, q, v)
    native, data = rooted.native, rooted.data
    pin.centerOfMass(native, data, q, v)
    row["center_of_mass_velocity"] = np.array(data.vcom[0])
    row["center_of_mass_jacobian"] = rooted.columns_of(pin.jacobianCenterOfMass(native, data, q))
    row["centroidal_momentum"] = np.array(pin.computeCentroidalMomentum(native, data, q, v).vector)
    row["centroidal_map"] = rooted.columns_of(pin.computeCentroidalMap(native, data, q))
    return row


def _momentum_about_origin(robot: OrderedModel, q: Array, v: Array) -> Array:
    """Σ of the spatial momenta of the bodies, each moved to the world's origin."""
    native, data = robot.native, robot.data
    pin.forwardKinematics(native, data, q, v)
    total = sum((data.oMi[k].act(native.inertias[k] * data.v[k]) for k in robot.ids), pin.Force.Zero())
    return np.array(total.vector)
