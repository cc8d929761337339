"""Derivatives of torques, accelerations and reactions; column k belongs to joint k."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from crosscheck.quantities.measures import (
    Chosen,
    Measure,
    constant,
    largest_wrench,
    rate_size,
    relative_to,
    spin,
    through_mass_matrix,
    total_mass,
)
from crosscheck.quantities.quantity import AT_FEW_STATES, Quantity, verb
from crosscheck.quantities.rows.dynamics import TORQUE
from crosscheck.quantities.rows.matrices import BY_RATE, SOLVED_INVERSE, solved_errors
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import acceleration_scale, by_part, largest, largest_tensor, ratio, relative
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.quantities.tolerances import ACCELERATION
from crosscheck.reference.native_functions import NativeFunction
from graphdyn.layout import Array

_SOLVED_RATES = "only cond(M) ‖∂a‖ + ‖M⁻¹‖ (‖∂τ‖ + largest joint wrench)"
_TWICE = "exact sums of computeRNEADerivatives"


def _of_torques(name: str) -> NativeFunction:
    return NativeFunction("computeRNEADerivatives", ("q", "v", "a"), "square", True, ("dtau_dq", "dtau_dv").index(name))


def _of_accelerations(number: int) -> NativeFunction:
    form = ("square", "square", "symmetric")[number]
    return NativeFunction("computeABADerivatives", ("q", "v", "tau"), form, True, number)


def _through_torques(name: str) -> Measure:
    """Errors of derivatives of accelerations. name: of the derivatives of the torques by the same"""

    def errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        rates: Array = getattr(states.answer("inverse_dynamics_derivatives", "projected"), name)
        return ratio(largest(x - y), acceleration_scale(states.mass, y, rates, states.solved[2]))

    return errors


def _reaction_terms(states: ScaledStates, by: str) -> tuple[Array, Array]:
    """Sizes of the terms of forces and of moments, per unit of q, v or a."""
    size, mass = states.sizes, total_mass(states)
    tensor = np.full(len(states.q), largest_tensor(states.model))
    force, turning = {
        "q": (mass * np.maximum(size.compensated, size.turn * size.arm), size.spin),
        "v": (2 * mass * (size.omega * size.arm + size.slide_rate), 2 * tensor * size.omega),
        "a": (mass * size.arm, tensor),
    }[by]
    return force, force * size.arm + turning


def _reaction_errors(of: str, by: str) -> Measure:
    def errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        force, moment = _reaction_terms(states, by)
        if of == "multipliers":
            return relative(x, y, force, moment)
        return by_part(np.swapaxes(x, -1, -2), np.swapaxes(y, -1, -2), force, moment)  # the wrench comes last

    return errors


def _of_reactions(of: str, by: str) -> Quantity:
    name = f"d{of}_d{by}"
    terms = {
        "q": "forces: mass × max(compensated, turn × arm); moments: that × arm + spin",
        "v": "forces: 2 mass × rate; moments: that × arm + 2 ‖ω‖ × tensor",
        "a": "forces: mass × arm; moments: that × arm + tensor",
    }
    return Quantity(
        name=name,
        ours=verb("reaction_derivatives", name),
        pinocchio=lambda there, _: there.reaction_derivatives[name],
        against="computeRNEADerivatives of free joints",
        errors=_reaction_errors(of, by),
        scale=terms[by],
        judged_errors=relative_to(),
        judged_scale="largest entry of the derivatives",
    )


def _second(name: str, errors: Measure, scale: str, against: str = _TWICE) -> Quantity:
    return Quantity(
        name=name,
        ours=verb("inverse_dynamics_second_derivatives", name),
        pinocchio=lambda there, _: there.second_derivatives[name],
        against=against,
        errors=errors,
        scale=scale,
        forms=AT_FEW_STATES,
    )


def _mass(states: ScaledStates) -> Array:
    return largest(states.mass)


def _mass_of_units(states: ScaledStates) -> Array:
    """The plain form takes differences of unit steps."""
    return largest(states.mass) * np.maximum(1.0, largest(states.v))


class DerivativeFunctions(TypedDict, total=False):
    """What of it a user may give to be judged, as keywords of crosscheck.judge."""

    dtau_dq: TestedFunction | None
    dtau_dv: TestedFunction | None
    da_dq: TestedFunction | None
    da_dv: TestedFunction | None
    dmultipliers_dq: TestedFunction | None
    dmultipliers_dv: TestedFunction | None
    dmultipliers_da: TestedFunction | None
    dwrenches_dq: TestedFunction | None
    dwrenches_dv: TestedFunction | None
    dwrenches_da: TestedFunction | None


DERIVATIVES = (
    Quantity(
        name="dtau_dq",
        ours=verb("inverse_dynamics_derivatives", "dtau_dq"),
        pinocchio=_of_torques("dtau_dq"),
        against="computeRNEADerivatives; complex steps",
        errors=relative_to(largest_wrench, spin),
        scale=TORQUE,
    ),
    Quantity(
        name="dtau_dv",
        ours=verb("inverse_dynamics_derivatives", "dtau_dv"),
        pinocchio=_of_torques("dtau_dv"),
        against="computeRNEADerivatives; complex steps",
        errors=relative_to(rate_size),
        scale=BY_RATE,
    ),
    Quantity(
        name="dtau_da",
        ours=verb("inverse_dynamics_derivatives", "dtau_da"),
        pinocchio=lambda there, _: there.mass_matrix,
        errors=relative_to(lambda states: constant(largest_tensor(states.model), states)),
        scale="largest entry of a tensor",
        forms=(),
    ),
    Quantity(
        name="da_dq",
        ours=verb("forward_dynamics_derivatives", "da_dq"),
        pinocchio=_of_accelerations(0),
        against="computeABADerivatives; complex steps",
        errors=_through_torques("dtau_dq"),
        scale=_SOLVED_RATES,
        tolerance=ACCELERATION,
        solves=True,
        judged_errors=through_mass_matrix(largest_wrench),
        judged_scale="∣M∣ ∣∂a/∂q∣ and the largest entry of the joint wrenches, of M × the error",
    ),
    Quantity(
        name="da_dv",
        ours=verb("forward_dynamics_derivatives", "da_dv"),
        pinocchio=_of_accelerations(1),
        against="computeABADerivatives; complex steps",
        errors=_through_torques("dtau_dv"),
        scale=_SOLVED_RATES,
        tolerance=ACCELERATION,
        solves=True,
        judged_errors=through_mass_matrix(rate_size),
        judged_scale="∣M∣ ∣∂a/∂v∣ and the largest entry of M × largest velocity, of M × the error",
    ),
    Quantity(
        name="da_dtau",
        ours=verb("forward_dynamics_derivatives", "da_dtau"),
        pinocchio=_of_accelerations(2),
        against="computeABADerivatives; complex steps",
        errors=solved_errors,
        scale=SOLVED_INVERSE,
        tolerance=ACCELERATION,
        solves=True,
    ),
    *(_of_reactions("multipliers", by) for by in "qva"),
    *(_of_reactions("wrenches", by) for by in "qva"),
    _second("d2tau_dqdq", relative_to(largest_wrench, spin), TORQUE),
    _second("d2tau_dqdv", relative_to(rate_size), BY_RATE),
    _second("d2tau_dqda", relative_to(_mass), "largest entry of M"),
    _second(
        "d2tau_dvdv",
        relative_to(_mass_of_units),
        "largest entry of M × max(1, velocity)",
        "computeRNEADerivatives at unit v",
    ),
)
