"""Functions that answer regressors: matrices whose product with inertial parameters is the quantity."""

from __future__ import annotations

import graphdyn
from crosscheck.judging.functions.known_function import KnownFunction
from crosscheck.judging.functions.measures import columns_relative_to
from crosscheck.judging.functions.spans import span_errors
from crosscheck.judging.judged_states import JudgedStates
from graphdyn.layout import Array


def _lever(states: JudgedStates) -> Array:
    return states.sizes.compensated * states.sizes.lever


def _compensated(states: JudgedStates) -> Array:
    return states.sizes.compensated


def _turn(states: JudgedStates) -> Array:
    return states.sizes.turn


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
        "body_regressor", ("q", "v", "a"), ("n", 6, 10), "N, N m per parameter",
        ours=lambda states, _: graphdyn.body_regressor(states.model, states.q, states.v, states.a),
        errors=columns_relative_to(_compensated, _compensated, _turn),
        scale="largest entry and term of the parameter type (m, m c, I)",
        code="graphdyn.body_regressor(model, q, v, a)",
        pinocchio=lambda there, _: there.values.body_regressor,
    ),
)  # fmt: skip
