"""Functions that answer a matrix of the equations of motion."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.functions.measures import rate_size, relative_to, through_mass_matrix
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import largest, ratio, relative
from graphdyn.layout import Array

CHRISTOFFEL = "of the Christoffel symbols"
"""The matrix C with Ṁ - 2C skew that most codes compute. Others have the same C v and the same C + Cᵀ = Ṁ."""


def _coriolis_errors(answer: Array, reference: Array, states: JudgedStates, chosen: Chosen) -> Array:
    """Of C; else of C + Cᵀ and C v over the largest velocity, which all valid matrices C have in common."""
    if chosen["matrix"] == CHRISTOFFEL:
        return relative(answer, reference, rate_size(states))
    direction = states.v / np.maximum(largest(states.v), np.finfo(float).tiny)[:, None]
    difference = answer - reference
    parts = [difference + np.swapaxes(difference, -1, -2), difference @ direction[..., None]]
    return ratio(
        np.maximum.reduce([largest(part) for part in parts]), np.maximum(largest(reference), rate_size(states))
    )


def _coriolis(states: JudgedStates, chosen: Chosen) -> Array:
    return graphdyn.coriolis_matrix(states.model, states.q, states.v)


MATRICES = (
    KnownFunction(
        "mass_matrix", ("q",), ("n", "n"), "kg m², kg m, kg",
        ours=lambda states, _: states.mass,
        errors=relative_to(),
        scale="largest entry of M",
        code="graphdyn.mass_matrix(model, q)",
        pinocchio=lambda there, _: there.values.mass_matrix,
        mujoco="mass_matrix",
    ),
    KnownFunction(
        "mass_matrix_inverse", ("q",), ("n", "n"), "1/(kg m²), 1/(kg m), 1/kg",
        ours=lambda states, _: graphdyn.mass_matrix_inverse(states.model, states.q),
        errors=through_mass_matrix(),
        scale="∣M∣ ∣M⁻¹∣, of M × the error",
        code="graphdyn.mass_matrix_inverse(model, q)",
        pinocchio=lambda there, _: there.derived("mass_matrix_inverse"),
        solves=True,
    ),
    KnownFunction(
        "coriolis_matrix", ("q", "v"), ("n", "n"), "N m s, N s, kg/s",
        ours=_coriolis,
        errors=_coriolis_errors,
        scale="largest entry of M × largest velocity",
        code="graphdyn.coriolis_matrix(model, q, v)",
        pinocchio=lambda there, _: there.derived("coriolis_matrix"),
        conventions={"matrix": (CHRISTOFFEL, "another with the same C v and Ṁ - 2C skew")},
        widening=("matrix",),
    ),
)  # fmt: skip
