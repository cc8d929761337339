"""Motion, torques, wrenches, matrices and regressors of Pinocchio, which every state is compared with."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.ordered import OrderedModel
from crosscheck.reference.reference_values import RefereeValues, at_centers
from graphdyn.layout import Array


def evaluate(robot: OrderedModel, q: Array, v: Array, a: Array, tau: Array, external_wrenches: Array) -> RefereeValues:
    """All reference values at N states: q, v, a, tau (N, n), external_wrenches (N, n, 6)."""
    rows = [_evaluate_one(robot, *state) for state in zip(q, v, a, tau, external_wrenches, strict=True)]
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    rotation, velocity = values["rotation"], values["velocity"]
    # still spatial vectors; moved to the centers of mass for all states at once
    centers = _centers(robot)
    _, forward = at_centers(centers, rotation, velocity, values["a_body_accelerations"])
    values["velocity"], values["acceleration"] = at_centers(centers, rotation, velocity, values["acceleration"])
    return RefereeValues(**{**values, "a_body_accelerations": forward})


def _evaluate_one(robot: OrderedModel, q: Array, v: Array, a: Array, tau: Array, external: Array) -> dict[str, Array]:
    native, data, columns = robot.native, robot.data, robot.columns
    q, v, a, tau = robot.configuration(q), robot.there(v), robot.there(a), robot.there(tau)
    forces = robot.forces(external)
    row = {}
    row["tau_external"] = pin.rnea(native, data, q, v, a, forces)[columns]
    row["joint_wrenches_external"] = robot.joint_wrenches()
    row["tau"] = pin.rnea(native, data, q, v, a)[columns]
    row["joint_wrenches"] = robot.joint_wrenches()
    row["mass_matrix"] = robot.symmetric(pin.crba(native, data, q))
    row["torque_regressor"] = robot.regressor_of(q, v, a)
    pin.rnea(native, data, q, v, a)
    row["body_regressor"] = np.array([pin.jointBodyRegressor(native, data, k) for k in robot.ids])
    pin.forwardKinematics(native, data, q, v, a)
    row["rotation"] = np.array([data.oMi[k].rotation for k in robot.ids])
    row["position"] = np.array([data.oMi[k].translation for k in robot.ids])
    row["velocity"], row["acceleration"] = robot.spatial(data.v), robot.spatial(data.a)
    a = np.array(pin.aba(native, data, q, v, tau, forces))
    row["a_external"] = a[columns]
    pin.rnea(native, data, q, v, a, forces)
    row["a_wrenches_external"] = robot.joint_wrenches()
    a = np.array(pin.aba(native, data, q, v, tau))
    row["a"] = a[columns]
    pin.rnea(native, data, q, v, a)
    row["a_wrenches"] = robot.joint_wrenches()
    pin.forwardKinematics(native, data, q, v, a)
    row["a_body_accelerations"] = robot.spatial(data.a)
    return row


def _centers(robot: OrderedModel) -> Array:
    """Centers of mass (n, 3) in link axes.

    Pinocchio loses the center of a body with zero or tiny mass, because it divides m c by at least eps; then ours
    is used, so that the same point is compared.
    """
    inertias = [robot.native.inertias[k] for k in robot.ids]
    return np.array(
        [
            inertia.lever if inertia.mass > np.finfo(float).eps else body.center_of_mass
            for inertia, body in zip(inertias, robot.model.bodies, strict=True)
        ]
    )
