"""Regressors: matrices whose product with inertial parameters is the quantity."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from crosscheck.quantities.measures import Chosen, columns_relative_to, span_errors
from crosscheck.quantities.quantity import USUAL, USUAL_TWICE, Quantity, verb
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import PARAMETER_TYPES, acceleration_scale, by_parameter_type, largest, ratio
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.quantities.tolerances import ACCELERATION
from graphdyn.layout import BODY_PARAMETERS, Array

if TYPE_CHECKING:
    from crosscheck.reference.pinocchio_model import PinocchioAnswers

BY_TYPE = "columns of m: compensated × lever; of m c: compensated; of I: turn"


def _regressor(there: PinocchioAnswers, chosen: Chosen) -> Array:
    return there.each(lambda robot, x: robot.regressor_of(x.q, x.v, x.a))


def _momentum_regressor(there: PinocchioAnswers, chosen: Chosen) -> Array:
    return there.each(lambda robot, x: robot.regressor_of(x.q, 0 * x.v, x.v), there.weightless)


def _rate(states: ScaledStates) -> Array:
    return states.sizes.omega * states.sizes.arm + states.sizes.slide_rate


def _through_mass_matrix(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """M × the error over ∣M∣ ∣reference∣, each type of parameter on its own scale."""
    required, zero = np.abs(states.mass) @ np.abs(y), np.zeros(len(x))
    return by_parameter_type(required + states.mass @ (x - y), required, zero, zero, zero)


def _solved_by_type(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """The largest error of the columns of m, of m c and of I of -M⁻¹ W, each on its own scale."""
    x, y = (z.reshape(*states.tau.shape, -1, BODY_PARAMETERS) for z in (x, y))
    errors = []
    for part, column in zip(PARAMETER_TYPES, states.solved_sizes.regressor_columns, strict=True):
        scale = acceleration_scale(states.mass, y[..., part], column, 0 * states.tau)
        errors.append(ratio(largest((x - y)[..., part]), scale))
    found: Array = np.maximum.reduce(errors)
    return found


class RegressorFunctions(TypedDict, total=False):
    """What of it a user may give to be judged, as keywords of crosscheck.judge."""

    joint_torque_regressor: TestedFunction | None
    base_regressor: TestedFunction | None
    momentum_regressor: TestedFunction | None
    forward_dynamics_parameter_derivatives: TestedFunction | None
    body_regressor: TestedFunction | None


REGRESSORS = (
    Quantity(
        name="joint_torque_regressor",
        shows="torques per parameter",
        ours=verb("joint_torque_regressor"),
        pinocchio=_regressor,
        against="computeJointTorqueRegressor",
        errors=columns_relative_to(*(lambda states, k=k: states.sizes.regressor_columns[k] for k in range(3))),
        scale=BY_TYPE,
        forms=USUAL_TWICE,
    ),
    Quantity(
        name="base_regressor",
        ours=replace(verb("joint_torque_regressor"), shape=("n", "p")),
        pinocchio=_regressor,
        errors=span_errors,
        scale="",
        forms=(),
        judged_scale="largest entry of a column over all states; of what the other regressor's columns cannot give",
    ),
    Quantity(
        name="momentum_regressor",
        ours=verb("momentum_regressor"),
        pinocchio=_momentum_regressor,
        against="computeJointTorqueRegressor, v for a",
        errors=columns_relative_to(
            lambda states: _rate(states) * states.sizes.arm, _rate, lambda states: states.sizes.omega
        ),
        scale="columns of m: rate × arm; of m c: rate; of I: ‖ω‖",
    ),
    Quantity(
        name="forward_dynamics_parameter_derivatives",
        ours=verb("forward_dynamics_parameter_derivatives"),
        pinocchio=lambda there, _: there.accelerations_by_parameters,
        against="-computeMinverse × regressor",
        errors=_solved_by_type,
        scale="per type of column: only cond(M) ‖∂a‖ + ‖M⁻¹‖ × that of joint_torque_regressor",
        tolerance=ACCELERATION,
        solves=True,
        judged_errors=_through_mass_matrix,
        judged_scale="∣M∣ ∣the derivatives∣ of the parameter type (m, m c, I), of M × the error",
    ),
    Quantity(
        name="body_regressor",
        ours=verb("body_regressor"),
        pinocchio=lambda there, _: there.body_regressor,
        against="jointBodyRegressor",
        errors=columns_relative_to(
            lambda states: states.sizes.compensated,
            lambda states: states.sizes.compensated,
            lambda states: states.sizes.turn,
        ),
        scale="columns of m and m c: compensated; of I: turn",
        forms=USUAL,
    ),
)
