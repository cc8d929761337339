"""What graphdyn answers for the quantities that are compared at the first random states, by one method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.referee.states import Case
from graphdyn import (
    coriolis_matrix,
    forward_dynamics_derivatives,
    inverse_dynamics_derivatives,
    kinetic_energy,
    mass_matrix_inverse,
    potential_energy,
)
from graphdyn._methods import Method
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class DerivedAnswers:
    """Derivatives, matrices and energies of one method, by the names of their quantities.

    forward: those that need a regular mass matrix, at the states that have one; empty where none has
    """

    passive: Mapping[str, Array]
    forward: Mapping[str, Array]


def derived_answers(case: Case, tau: Array, regular: NDArray[np.bool_], method: Method) -> DerivedAnswers:
    """Derivatives, matrices and energies by one method.

    tau: given torques (N, n); regular: states with a regular mass matrix (N,)
    """
    model, q, v, a = case.model, case.q, case.v, case.a
    rates = inverse_dynamics_derivatives(model, q, v, a, method=method)
    passive = {
        "dtau_dq": rates.dtau_dq,
        "dtau_dv": rates.dtau_dv,
        "coriolis_matrix": coriolis_matrix(model, q, v, method=method),
        "kinetic_energy": kinetic_energy(model, q, v, method=method),
        "potential_energy": potential_energy(model, q, method=method),
    }
    forward = {}
    if regular.any():
        q, v, tau = q[regular], v[regular], tau[regular]
        forward = {
            **vars(forward_dynamics_derivatives(model, q, v, tau, method=method)),
            "mass_matrix_inverse": mass_matrix_inverse(model, q, method=method),
        }
    return DerivedAnswers(passive, forward)
