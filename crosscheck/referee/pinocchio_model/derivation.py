"""Derivatives, matrices, energies and the motion of frames, which the first random states are compared with."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.referee.pinocchio_model.frames import frame_motion
from crosscheck.referee.pinocchio_model.ordered import OrderedModel
from crosscheck.referee.pinocchio_model.reactions import reaction_derivatives
from graphdyn.layout import Array


def derive(robot: OrderedModel, rooted: OrderedModel, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
    """Values of the quantities crosscheck.referee.quantities.DERIVED at N states: q, v, a, tau (N, n).

    rooted: the robot moved to the world's origin, of which all is taken that does not depend on where the robot is:
        Pinocchio computes about that point, and would lose the digits of the distance
    """
    rows = []
    for q_k, *rates_k in zip(q, v, a, tau, strict=True):
        at, *rates = robot.configuration(q_k), *map(robot.there, rates_k)
        row = {**_at_rooted(rooted, at, *rates), **frame_motion(robot, rooted, at, *rates[:2])}
        row["potential_energy"] = np.array(pin.computePotentialEnergy(robot.native, robot.data, at))
        rows.append(row)
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return {**values, **reaction_derivatives(rooted, q, v, a)}


def _at_rooted(robot: OrderedModel, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
    native, data, here, symmetric = robot.native, robot.data, robot.square, robot.symmetric
    row = {}
    dtau_dq, dtau_dv, _ = pin.computeRNEADerivatives(native, data, q, v, a)
    row["dtau_dq"], row["dtau_dv"] = here(dtau_dq), here(dtau_dv)
    da_dq, da_dv, da_dtau = pin.computeABADerivatives(native, data, q, v, tau)
    row["da_dq"], row["da_dv"], row["da_dtau"] = here(da_dq), here(da_dv), symmetric(da_dtau)
    row["mass_matrix_inverse"] = symmetric(pin.computeMinverse(native, data, q))
    row["coriolis_matrix"] = here(pin.computeCoriolisMatrix(native, data, q, v))
    row["kinetic_energy"] = np.array(pin.computeKineticEnergy(native, data, q, v))
    return row
