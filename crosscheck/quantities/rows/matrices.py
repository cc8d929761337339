"""Matrices of the equations of motion."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from crosscheck.quantities.measures import Chosen, constant, rate_size, relative_to, through_mass_matrix
from crosscheck.quantities.quantity import USUAL_TWICE, Quantity, verb
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import acceleration_scale, largest, largest_tensor, ratio, relative
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.quantities.tolerances import ACCELERATION
from crosscheck.reference.native_functions import NativeFunction
from graphdyn.layout import Array

BY_RATE = "largest entry of M × largest velocity"
SOLVED_INVERSE = "only cond(M) ‖M⁻¹‖"

_CHRISTOFFEL = "of the Christoffel symbols"
"""The matrix C with Ṁ - 2C skew that most codes compute. Others have the same C v and the same C + Cᵀ = Ṁ."""


def _coriolis_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Coriolis errors of C; else of C + Cᵀ and C v over the largest velocity, which all valid matrices C have in
    common."""
    if chosen["matrix"] == _CHRISTOFFEL:
        return relative(x, y, rate_size(states))
    direction = states.v / np.maximum(largest(states.v), np.finfo(float).tiny)[:, None]
    difference = x - y
    parts = [difference + np.swapaxes(difference, -1, -2), difference @ direction[..., None]]
    return ratio(np.maximum.reduce([largest(part) for part in parts]), np.maximum(largest(y), rate_size(states)))


def solved_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Errors of M⁻¹."""
    return ratio(largest(x - y), acceleration_scale(states.mass, y, 0 * states.tau, 0 * states.tau))


class MatrixFunctions(TypedDict, total=False):
    """What of it a user may give to be judged, as keywords of crosscheck.judge."""

    mass_matrix: TestedFunction | None
    mass_matrix_inverse: TestedFunction | None
    coriolis_matrix: TestedFunction | None


MATRICES = (
    Quantity(
        name="mass_matrix",
        shows="inertia",
        ours=verb("mass_matrix"),
        pinocchio=lambda there, _: there.mass_matrix,
        against="crba",
        errors=relative_to(lambda states: constant(largest_tensor(states.model), states)),
        scale="largest entry of a tensor",
        forms=USUAL_TWICE,
        mujoco="mass_matrix",
    ),
    Quantity(
        name="mass_matrix_inverse",
        shows="inverse of the inertia",
        ours=verb("mass_matrix_inverse"),
        pinocchio=NativeFunction("computeMinverse", ("q",), "symmetric", rooted=True),
        against="computeMinverse; inverted",
        errors=solved_errors,
        scale=SOLVED_INVERSE,
        tolerance=ACCELERATION,
        solves=True,
        judged_errors=through_mass_matrix(),
        judged_scale="∣M∣ ∣M⁻¹∣, of M × the error",
        benchmark="inverse of the mass matrix",
    ),
    Quantity(
        name="coriolis_matrix",
        shows="velocity terms as a matrix",
        ours=verb("coriolis_matrix"),
        pinocchio=NativeFunction("computeCoriolisMatrix", ("q", "v"), "square", rooted=True),
        against="computeCoriolisMatrix; complex steps",
        errors=_coriolis_errors,
        scale=BY_RATE,
        conventions={"matrix": (_CHRISTOFFEL, "another with the same C v and Ṁ - 2C skew")},
        widening=("matrix",),
        benchmark="Coriolis matrix",
    ),
)
