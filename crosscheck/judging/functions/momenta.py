"""Functions that answer the center of mass and the momentum of the robot."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.functions.measures import ORDER, linear_first, parts_relative_to, relative_to
from crosscheck.judging.functions.pinocchio_answers import PinocchioAnswers
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import center_offset, largest, largest_tensor
from graphdyn.layout import ANGULAR, LINEAR, Array

CENTER, ORIGIN = "the center of mass", "the world's origin"

POINT = {"about": (CENTER, ORIGIN), **ORDER}
"""Convention: the point of the angular momentum."""


def _reach(states: JudgedStates) -> Array:
    """Largest position of a link, and offset of a center of mass [m]."""
    return largest(states.origins) + center_offset(states.model)


def _lever(states: JudgedStates) -> Array:
    return states.sizes.lever


def _velocity(states: JudgedStates) -> Array:
    return states.sizes.velocity


def _mass(states: JudgedStates) -> float:
    return sum(body.mass for body in states.model.bodies)


def _linear(states: JudgedStates) -> Array:
    return _mass(states) * states.sizes.velocity


def _angular(states: JudgedStates) -> Array:
    omega = largest(states.motion.velocity[..., ANGULAR])
    return _linear(states) * (states.sizes.lever + _reach(states)) + largest_tensor(states.model) * omega


def _linear_of_joint(states: JudgedStates) -> Array:
    return _mass(states) * (1.0 + states.sizes.lever)


def _angular_of_joint(states: JudgedStates) -> Array:
    return _linear_of_joint(states) * (states.sizes.lever + _reach(states)) + largest_tensor(states.model)


def _momentum(states: JudgedStates, chosen: Chosen) -> Array:
    found = graphdyn.momentum(states.model, states.q, states.v)
    return linear_first(found.about_center_of_mass if chosen["about"] == CENTER else found.about_origin, chosen)


def _momentum_of_pinocchio(there: PinocchioAnswers, chosen: Chosen) -> Array:
    name = "centroidal_momentum" if chosen["about"] == CENTER else "momentum_about_origin"
    return linear_first(there.derived(name), chosen)


def _centroidal_map(states: JudgedStates, chosen: Chosen) -> Array:
    center = graphdyn.center_of_mass(states.model, states.q)
    return _map_about(graphdyn.centroidal_map(states.model, states.q), center, chosen)


def _map_of_pinocchio(there: PinocchioAnswers, chosen: Chosen) -> Array:
    return _map_about(there.derived("centroidal_map"), there.derived("center_of_mass"), chosen)


def _map_about(found: Array, center: Array, chosen: Chosen) -> Array:
    """The map to the momentum about the center of mass, as chosen (N, 6, n). center: of mass (N, 3)"""
    if chosen["about"] == ORIGIN:
        found = np.array(found)
        found[:, ANGULAR] += np.cross(center[:, :, None], found[:, LINEAR], axis=1)
    return linear_first(found, chosen, axis=-2)


MOMENTA = (
    KnownFunction(
        "center_of_mass", ("q",), (3,), "m",
        ours=lambda states, _: graphdyn.center_of_mass(states.model, states.q),
        errors=relative_to(_reach),
        scale="largest position of a link, and offset of a center of mass",
        code="graphdyn.center_of_mass(model, q)",
        pinocchio=lambda there, _: there.derived("center_of_mass"),
    ),
    KnownFunction(
        "center_of_mass_velocity", ("q", "v"), (3,), "m/s",
        ours=lambda states, _: graphdyn.center_of_mass_velocity(states.model, states.q, states.v),
        errors=relative_to(_velocity),
        scale="‖ω‖ × lever + slide rate",
        code="graphdyn.center_of_mass_velocity(model, q, v)",
        pinocchio=lambda there, _: there.derived("center_of_mass_velocity"),
    ),
    KnownFunction(
        "center_of_mass_jacobian", ("q",), (3, "n"), "m or 1",
        ours=lambda states, _: graphdyn.center_of_mass_jacobian(states.model, states.q),
        errors=relative_to(_lever),
        scale="lever",
        code="graphdyn.center_of_mass_jacobian(model, q)",
        pinocchio=lambda there, _: there.derived("center_of_mass_jacobian"),
    ),
    KnownFunction(
        "momentum", ("q", "v"), (6,), "kg m/s, kg m²/s",
        ours=_momentum,
        errors=parts_relative_to(_linear, _angular),
        scale="linear: mass × velocity; angular: the same × (lever, distance from the world's origin), tensor × ‖ω‖",
        code="graphdyn.momentum(model, q, v).about_center_of_mass",
        pinocchio=_momentum_of_pinocchio,
        conventions=POINT,
    ),
    KnownFunction(
        "centroidal_map", ("q",), (6, "n"), "kg m or kg, kg m² or kg m",
        ours=_centroidal_map,
        errors=parts_relative_to(_linear_of_joint, _angular_of_joint, axis=-2),
        scale="linear rows: mass × lever; angular rows: the same × (lever, distance from the world's origin), tensor",
        code="graphdyn.centroidal_map(model, q)",
        pinocchio=_map_of_pinocchio,
        conventions=POINT,
    ),
)  # fmt: skip
