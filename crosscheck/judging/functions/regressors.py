"""Functions that answer regressors: matrices whose product with inertial parameters is the quantity."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.functions.measures import columns_relative_to, nothing
from crosscheck.judging.functions.spans import span_errors
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import by_parameter_type, largest
from graphdyn.layout import ANGULAR, Array


def _lever(states: JudgedStates) -> Array:
    return states.sizes.compensated * states.sizes.lever


def _compensated(states: JudgedStates) -> Array:
    return states.sizes.compensated


def _turn(states: JudgedStates) -> Array:
    return states.sizes.turn


def _potential_energy_regressor(states: JudgedStates, chosen: Chosen) -> Array:
    return graphdyn.energy_regressor(states.model, states.q, 0 * states.q).potential


def _accelerations_by_parameters(states: JudgedStates, chosen: Chosen) -> Array:
    return graphdyn.forward_dynamics_parameter_derivatives(states.model, states.q, states.v, states.tau)


def _by_parameters_through_mass(x: Array, y: Array, states: JudgedStates, chosen: Chosen) -> Array:
    """M × the error over ∣M∣ ∣reference∣, each type of parameter on its own scale."""
    required, zero = np.abs(states.mass) @ np.abs(y), np.zeros(len(x))
    return by_parameter_type(required + states.mass @ (x - y), required, zero, zero, zero)


def _speed_squared(states: JudgedStates) -> Array:
    return states.sizes.velocity**2


def _speed_omega(states: JudgedStates) -> Array:
    return states.sizes.velocity * _omega(states)


def _omega_squared(states: JudgedStates) -> Array:
    return _omega(states) ** 2


def _omega(states: JudgedStates) -> Array:
    return largest(states.motion.velocity[..., ANGULAR])


REGRESSORS = (
    KnownFunction(
        "regressor", ("q", "v", "a"), ("n", "10 n"), "N m or N per parameter",
        ours=lambda states, _: graphdyn.joint_torque_regressor(states.model, states.q, states.v, states.a),
        errors=columns_relative_to(_lever, _compensated, _turn),
        scale="largest entry and term of the parameter type (m, m c, I)",
        code="graphdyn.joint_torque_regressor(model, q, v, a)",
        pinocchio=lambda there, _: there.values.torque_regressor,
    ),
    KnownFunction(
        "base_regressor", ("q", "v", "a"), ("n", "p"), "N m or N per parameter",
        ours=lambda states, _: graphdyn.joint_torque_regressor(states.model, states.q, states.v, states.a),
        errors=span_errors,
        scale="largest entry of a column over all states; of what the columns of the other regressor cannot give",
        code="graphdyn.joint_torque_regressor(model, q, v, a)",
        pinocchio=lambda there, _: there.values.torque_regressor,
    ),
    KnownFunction(
        "momentum_regressor", ("q", "v"), ("n", "10 n"), "kg m²/s or kg m/s per parameter",
        ours=lambda states, _: graphdyn.momentum_regressor(states.model, states.q, states.v),
        errors=columns_relative_to(nothing, nothing, nothing),
        scale="largest entry of the parameter type (m, m c, I)",
        code="graphdyn.momentum_regressor(model, q, v)",
        pinocchio=lambda there, _: there.derived("momentum_regressor"),
    ),
    KnownFunction(
        "kinetic_energy_regressor", ("q", "v"), ("10 n",), "J per parameter",
        ours=lambda states, _: graphdyn.energy_regressor(states.model, states.q, states.v).kinetic,
        errors=columns_relative_to(_speed_squared, _speed_omega, _omega_squared),
        scale="largest entry and term of the parameter type (m, m c, I)",
        code="graphdyn.energy_regressor(model, q, v).kinetic",
        pinocchio=lambda there, _: there.derived("kinetic_energy_regressor"),
    ),
    KnownFunction(
        "potential_energy_regressor", ("q",), ("10 n",), "J per parameter",
        ours=_potential_energy_regressor,
        errors=columns_relative_to(nothing, nothing, nothing),
        scale="largest entry of the parameter type (m, m c, I)",
        code="graphdyn.energy_regressor(model, q, 0 * q).potential",
        pinocchio=lambda there, _: there.derived("potential_energy_regressor"),
    ),
    KnownFunction(
        "forward_dynamics_parameter_derivatives", ("q", "v", "tau"), ("n", "10 n"), "rad/s² or m/s² per parameter",
        ours=_accelerations_by_parameters,
        errors=_by_parameters_through_mass,
        scale="∣M∣ ∣the derivatives∣ of the parameter type (m, m c, I), of M × the error",
        code="graphdyn.forward_dynamics_parameter_derivatives(model, q, v, tau)",
        pinocchio=lambda there, _: there.derived("da_dpi"),
        solves=True,
    ),
    KnownFunction(
        "body_regressor", ("q", "v", "a"), ("n", 6, 10), "N, N m per parameter",
        ours=lambda states, _: graphdyn.body_regressor(states.model, states.q, states.v, states.a),
        errors=columns_relative_to(_compensated, _compensated, _turn),
        scale="largest entry and term of the parameter type (m, m c, I)",
        code="graphdyn.body_regressor(model, q, v, a)",
        pinocchio=lambda there, _: there.values.body_regressor,
    ),
)  # fmt: skip
