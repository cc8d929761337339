"""Derivatives, matrices, energies and the motion of frames, which the first random states are compared with."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.referee.pinocchio_model.frames import frame_motion
from crosscheck.referee.pinocchio_model.momenta import momenta
from crosscheck.referee.pinocchio_model.ordered import OrderedModel
from crosscheck.referee.pinocchio_model.parameters import parameter_values
from crosscheck.referee.pinocchio_model.reactions import reaction_derivatives
from graphdyn.layout import Array


def derive(
    robot: OrderedModel,
    rooted: OrderedModel,
    weightless: OrderedModel,
    q: Array,
    v: Array,
    a: Array,
    tau: Array,
    external_wrenches: Array,
) -> dict[str, Array]:
    """Values of the quantities crosscheck.referee.quantities.DERIVED that are no second derivatives, at N states.

    q, v, a, tau (N, n), external_wrenches (N, n, 6)
    rooted: the robot moved to the world's origin, of which all is taken that does not depend on where the robot is:
        Pinocchio computes about that point, and would lose the digits of the distance
    weightless: the robot without gravity
    """
    rows = []
    for q_k, v_k, a_k, tau_k, external in zip(q, v, a, tau, external_wrenches, strict=True):
        at, rate, change, given = robot.configuration(q_k), robot.there(v_k), robot.there(a_k), robot.there(tau_k)
        row = {
            **_at_rooted(rooted, at, rate, change, given),
            **_with_loads(robot, at, rate, change, robot.forces(external)),
            **frame_motion(robot, rooted, at, rate, change),
            **momenta(robot, rooted, at, rate),
            **parameter_values(robot, rooted, weightless, at, rate, given),
        }
        row["potential_energy"] = np.array(pin.computePotentialEnergy(robot.native, robot.data, at))
        rows.append(row)
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return {**values, **reaction_derivatives(rooted, q, v, a)}


def _with_loads(robot: OrderedModel, q: Array, v: Array, a: Array, forces: pin.StdVec_Force) -> dict[str, Array]:
    native, data, columns = robot.native, robot.data, robot.columns
    return {
        "static_torque": pin.computeStaticTorque(native, data, q, forces)[columns],
        "power": (pin.rnea(native, data, q, v, a, forces) * v)[columns],
    }


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
