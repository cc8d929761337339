"""Functions that answer energies."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.functions.measures import relative_to
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import center_offset, largest, relative
from graphdyn.layout import Array

WORLD_ORIGIN = "at the height of the world's origin"


def _weight_height(states: JudgedStates) -> Array:
    """Weight × (largest position of a link + largest offset of a center of mass) [J]."""
    model = states.model
    weight = float(np.linalg.norm(model.gravity)) * sum(body.mass for body in model.bodies)
    return weight * (largest(states.origins) + center_offset(model))


def _potential_errors(answer: Array, reference: Array, states: JudgedStates, chosen: Chosen) -> Array:
    """Up to a constant if zero is elsewhere: the median of the differences, which single wrong answers do not move."""
    if chosen["zero"] != WORLD_ORIGIN:
        answer = answer - np.median(answer - reference)
    return relative(answer, reference, _weight_height(states))


ENERGIES = (
    KnownFunction(
        "kinetic_energy", ("q", "v"), (), "J",
        ours=lambda states, _: graphdyn.kinetic_energy(states.model, states.q, states.v),
        errors=relative_to(),
        scale="the kinetic energy",
        code="graphdyn.kinetic_energy(model, q, v)",
        pinocchio=lambda there, _: there.derived("kinetic_energy"),
    ),
    KnownFunction(
        "potential_energy", ("q",), (), "J",
        ours=lambda states, _: graphdyn.potential_energy(states.model, states.q),
        errors=_potential_errors,
        scale="weight × (largest position of a link + offset of a center of mass)",
        code="graphdyn.potential_energy(model, q)",
        pinocchio=lambda there, _: there.derived("potential_energy"),
        conventions={"zero": (WORLD_ORIGIN, "elsewhere")},
        widening=("zero",),
    ),
)  # fmt: skip
