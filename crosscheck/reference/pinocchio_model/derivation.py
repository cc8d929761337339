"""Second derivatives of the torques.

Pinocchio's Python interface has none. The torques are trigonometric polynomials of degree two in the angle of a joint
that turns, and polynomials of degree two in the position of one that slides. Derivatives of such functions are exact
sums of a few of their values (Trefethen, Spectral Methods in MATLAB, 2000, chapter 3): here of Pinocchio's first
derivatives.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.model import PinocchioModel
from graphdyn.layout import Array

_STEPS = np.array([-2, -1, 1, 2])
_TURNS = _STEPS * (2 * np.pi / 5)
_OF_TURNS = 0.5 * (-1.0) ** (_STEPS + 1) / np.sin(_TURNS / 2)
"""Weights of the values after these turns: their sum is the derivative."""


def second_derivatives(robot: PinocchioModel, q: Array, v: Array, a: Array) -> dict[str, Array]:
    """∂²τ/∂q∂q, ∂²τ/∂q∂v, ∂²τ/∂q∂a, ∂²τ/∂v∂v (n, n, n) of one state in our order: the torque comes first."""
    by_q = np.stack([_change(robot, j, q, v, a) for j in range(len(q))], axis=-2)
    rest = np.zeros_like(q)
    by_v = np.stack([_first_derivatives(robot, q, unit, rest)[1] for unit in np.eye(len(q))], axis=-1)  # linear in v
    return {"d2tau_dqdq": by_q[0], "d2tau_dqdv": by_q[1], "d2tau_dqda": by_q[2], "d2tau_dvdv": by_v}


def _change(robot: PinocchioModel, j: int, q: Array, v: Array, a: Array) -> Array:
    """∂/∂q_j of the first derivatives (3, n, n)."""
    unit = np.eye(len(q))[j]
    if robot.model.joints[j].is_prismatic:
        step = _reach(robot)
        ahead, behind = (_first_derivatives(robot, q + sign * step * unit, v, a) for sign in (1, -1))
        return (ahead - behind) / (2 * step)
    turned = [_first_derivatives(robot, q + turn * unit, v, a) for turn in _TURNS]
    return np.tensordot(_OF_TURNS, np.array(turned), axes=1)


def _first_derivatives(robot: PinocchioModel, q: Array, v: Array, a: Array) -> Array:
    """∂τ/∂q, ∂τ/∂v, ∂τ/∂a (3, n, n) of one state in our order."""
    state = robot.configuration(q), robot.there(v), robot.there(a)
    by_q, by_v, mass = pin.computeRNEADerivatives(robot.native, robot.data, *state)
    return np.array([robot.square(by_q), robot.square(by_v), robot.symmetric(mass)])


def _reach(robot: PinocchioModel) -> float:
    """The size of the robot [m]: all steps from joint to joint, and not nothing."""
    return 1e-3 + sum(float(np.linalg.norm(joint.placement.translation)) for joint in robot.model.joints)
