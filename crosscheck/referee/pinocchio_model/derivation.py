"""Derivatives, energies and matrices of Pinocchio, which the first random states are compared with."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.referee.pinocchio_model.ordered import OrderedModel
from graphdyn.layout import Array


def derive(robot: OrderedModel, rooted: OrderedModel, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
    """Derivatives, energies and matrices at N states: q, v, a, tau (N, n).

    rooted: the robot moved to the world's origin, of which all but the potential energy is taken: Pinocchio computes
        about that point, and would lose the digits of the distance
    """
    rows = [_derive_one(rooted, *state) for state in zip(q, v, a, tau, strict=True)]
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    potential = [pin.computePotentialEnergy(robot.native, robot.data, robot.configuration(q_k)) for q_k in q]
    return {**values, "potential_energy": np.array(potential)}


def _derive_one(robot: OrderedModel, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
    native, data, here, symmetric = robot.native, robot.data, robot.square, robot.symmetric
    q, v, a, tau = robot.configuration(q), robot.there(v), robot.there(a), robot.there(tau)
    row = {}
    dtau_dq, dtau_dv, _ = pin.computeRNEADerivatives(native, data, q, v, a)
    row["dtau_dq"], row["dtau_dv"] = here(dtau_dq), here(dtau_dv)
    da_dq, da_dv, da_dtau = pin.computeABADerivatives(native, data, q, v, tau)
    row["da_dq"], row["da_dv"], row["da_dtau"] = here(da_dq), here(da_dv), symmetric(da_dtau)
    row["mass_matrix_inverse"] = symmetric(pin.computeMinverse(native, data, q))
    row["coriolis_matrix"] = here(pin.computeCoriolisMatrix(native, data, q, v))
    row["kinetic_energy"] = np.array(pin.computeKineticEnergy(native, data, q, v))
    return row
