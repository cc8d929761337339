"""Derivatives of torques, accelerations, wrenches and multipliers: by complex steps, and from the matrices."""

import numpy as np
from textbook_codes.algebra import gradient
from textbook_codes.matrices import coriolis_matrix, forward_dynamics, mass_matrix
from textbook_codes.multipliers import multipliers
from textbook_codes.torques import inverse_dynamics, joint_wrenches


def dtau_dq(arm, q, v, a):
    return gradient(lambda x: inverse_dynamics(arm, x, v, a), q)


def dtau_dv(arm, q, v, a):
    """Of C v with the Christoffel symbols, this is 2 C."""
    return 2 * coriolis_matrix(arm, q, v)


def da_dq(arm, q, v, tau):
    """The torques stay: 0 = M ∂a/∂q + ∂τ/∂q."""
    a = forward_dynamics(arm, q, v, tau)
    return -np.linalg.solve(mass_matrix(arm, q), dtau_dq(arm, q, v, a))


def da_dv(arm, q, v, tau):
    return -np.linalg.solve(mass_matrix(arm, q), dtau_dv(arm, q, v, tau))


def dwrenches_dq(arm, q, v, a):
    return gradient(lambda x: joint_wrenches(arm, x, v, a), q)


def dwrenches_dv(arm, q, v, a):
    return gradient(lambda x: joint_wrenches(arm, q, x, a), v)


def dwrenches_da(arm, q, v, a):
    return gradient(lambda x: joint_wrenches(arm, q, v, x), a)


def dmultipliers_dq(arm, q, v, a):
    return gradient(lambda x: multipliers(arm, x, v, a), q)


def dmultipliers_dv(arm, q, v, a):
    return gradient(lambda x: multipliers(arm, q, x, a), v)


def dmultipliers_da(arm, q, v, a):
    return gradient(lambda x: multipliers(arm, q, v, x), a)
