"""Second derivatives of the torques.

Pinocchio's Python interface has none. The torques are trigonometric polynomials of degree two in the angle of a joint
that turns, and polynomials of degree two in the position of one that slides. Derivatives of such functions are exact
sums of a few of their values (Trefethen, Spectral Methods in MATLAB, 2000, chapter 3): here of Pinocchio's first
derivatives.

Derivatives, matrices, energies and the motion of frames, which the first random states are compared with.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.frames import frame_motion, momenta, parameter_values
from crosscheck.reference.pinocchio_model.ordered import OrderedModel
from crosscheck.reference.pinocchio_model.reactions import reaction_derivatives
from graphdyn.layout import Array

_STEPS = np.array([-2, -1, 1, 2])
_TURNS = _STEPS * (2 * np.pi / 5)
_OF_TURNS = 0.5 * (-1.0) ** (_STEPS + 1) / np.sin(_TURNS / 2)
"""Weights of the values after these turns: their sum is the derivative."""


def second_derivatives(robot: OrderedModel, q: Array, v: Array, a: Array) -> dict[str, Array]:
    """∂²τ/∂q∂q, ∂²τ/∂q∂v, ∂²τ/∂q∂a, ∂²τ/∂v∂v (n, n, n) of one state in our order: the torque comes first."""
    by_q = np.stack([_change(robot, j, q, v, a) for j in range(len(q))], axis=-2)
    rest = np.zeros_like(q)
    by_v = np.stack([_first_derivatives(robot, q, unit, rest)[1] for unit in np.eye(len(q))], axis=-1)  # linear in v
    return {"d2tau_dqdq": by_q[0], "d2tau_dqdv": by_q[1], "d2tau_dqda": by_q[2], "d2tau_dvdv": by_v}


def _change(robot: OrderedModel, j: int, q: Array, v: Array, a: Array) -> Array:
    """∂/∂q_j of the first derivatives (3, n, n)."""
    unit = np.eye(len(q))[j]
    if robot.model.joints[j].is_prismatic:
        step = _reach(robot)
        ahead, behind = (_first_derivatives(robot, q + sign * step * unit, v, a) for sign in (1, -1))
        return (ahead - behind) / (2 * step)
    turned = [_first_derivatives(robot, q + turn * unit, v, a) for turn in _TURNS]
    return np.tensordot(_OF_TURNS, np.array(turned), axes=1)


def _first_derivatives(robot: OrderedModel, q: Array, v: Array, a: Array) -> Array:
    """∂τ/∂q, ∂τ/∂v, ∂τ/∂a (3, n, n) of one state in our order."""
    state = robot.configuration(q), robot.there(v), robot.there(a)
    by_q, by_v, mass = pin.computeRNEADerivatives(robot.native, robot.data, *state)
    return np.array([robot.square(by_q), robot.square(by_v), robot.symmetric(mass)])


def _reach(robot: OrderedModel) -> float:
    """The size of the robot [m]: all steps from joint to joint, and not nothing."""
    return 1e-3 + sum(float(np.linalg.norm(joint.placement.translation)) for joint in robot.model.joints)


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
    """Values of the quantities crosscheck.quantities.quantities.DERIVED that are no second derivatives, at N states.

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
