"""What graphdyn answers for the quantities that are compared at the first random states, by one method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.quantities.states import Case, has_mass
from crosscheck.reference.frame_choices import of_frames
from graphdyn import (
    center_of_mass,
    center_of_mass_jacobian,
    center_of_mass_velocity,
    centroidal_map,
    coriolis_matrix,
    energy_regressor,
    forward_dynamics_derivatives,
    forward_dynamics_parameter_derivatives,
    frame_acceleration,
    frame_jacobian,
    frame_jacobian_derivative,
    frame_velocity,
    inverse_dynamics_derivatives,
    inverse_dynamics_second_derivatives,
    kinetic_energy,
    mass_matrix_inverse,
    momentum,
    momentum_regressor,
    potential_energy,
    power,
    reaction_derivatives,
    static_torque,
)
from graphdyn.arguments import Method
from graphdyn.layout import Array

Answers = Mapping[str, Array]
"""By the names of the quantities, (N, …)."""


@dataclass(frozen=True, eq=False)
class DerivedAnswers:
    """What one method answers.

    forward: quantities that need a regular mass matrix, at the states that have one; empty where none has
    second: second derivatives, at the first SECOND_DERIVATIVE_STATES states
    """

    passive: Answers
    forward: Answers
    second: Answers


SECOND_DERIVATIVE_STATES = slice(20)
"""States at which second derivatives are compared: those of the plain form take 10 ms each."""


def derived_answers(case: Case, tau: Array, regular: NDArray[np.bool_], method: Method) -> DerivedAnswers:
    """Answers by one method.

    tau: given torques (N, n); regular: states with a regular mass matrix (N,)
    """
    few = case.rows(SECOND_DERIVATIVE_STATES)
    return DerivedAnswers(
        passive={
            **_of_dynamics(case, method),
            **_of_frames(case, method),
            **_of_energies(case, method),
            **(_of_momentum(case, method) if has_mass(case.model) else {}),
        },
        forward=_of_forward_dynamics(case.rows(regular), tau[regular], method) if regular.any() else {},
        second=vars(inverse_dynamics_second_derivatives(few.model, few.q, few.v, few.a, method=method)),
    )


def _of_dynamics(case: Case, method: Method) -> Answers:
    model, q, v, a = case.model, case.q, case.v, case.a
    rates = inverse_dynamics_derivatives(model, q, v, a, method=method)
    return {
        "dtau_dq": rates.dtau_dq,
        "dtau_dv": rates.dtau_dv,
        "coriolis_matrix": coriolis_matrix(model, q, v, method=method),
        "static_torque": static_torque(model, q, case.external_wrenches, method=method),
        "momentum_regressor": momentum_regressor(model, q, v, method=method),
        **vars(reaction_derivatives(model, q, v, a, method=method)),
    }


def _of_frames(case: Case, method: Method) -> Answers:
    model, q, v, a = case.model, case.q, case.v, case.a
    return {
        "frame_jacobian": of_frames(model, frame_jacobian, q, method=method),
        "frame_velocity": of_frames(model, frame_velocity, q, v, method=method),
        "frame_acceleration": of_frames(model, frame_acceleration, q, v, a, method=method),
        "frame_acceleration_spatial": of_frames(model, frame_acceleration, q, v, a, method=method, classical=False),
        "frame_jacobian_derivative": of_frames(model, frame_jacobian_derivative, q, v, method=method),
    }


def _of_energies(case: Case, method: Method) -> Answers:
    model, q, v, a = case.model, case.q, case.v, case.a
    regressor = energy_regressor(model, q, v, method=method)
    return {
        "kinetic_energy": kinetic_energy(model, q, v, method=method),
        "potential_energy": potential_energy(model, q, method=method),
        "power": power(model, q, v, a, case.external_wrenches, method=method),
        "kinetic_energy_regressor": regressor.kinetic,
        "potential_energy_regressor": regressor.potential,
    }


def _of_momentum(case: Case, method: Method) -> Answers:
    model, q, v = case.model, case.q, case.v
    found = momentum(model, q, v, method=method)
    return {
        "center_of_mass": center_of_mass(model, q, method=method),
        "center_of_mass_velocity": center_of_mass_velocity(model, q, v, method=method),
        "center_of_mass_jacobian": center_of_mass_jacobian(model, q, method=method),
        "centroidal_momentum": found.about_center_of_mass,
        "momentum_about_origin": found.about_origin,
        "centroidal_map": centroidal_map(model, q, method=method),
    }


def _of_forward_dynamics(case: Case, tau: Array, method: Method) -> Answers:
    model, q, v = case.model, case.q, case.v
    return {
        **vars(forward_dynamics_derivatives(model, q, v, tau, method=method)),
        "mass_matrix_inverse": mass_matrix_inverse(model, q, method=method),
        "da_dpi": forward_dynamics_parameter_derivatives(model, q, v, tau, method=method),
    }
