"""Energies, momentum, and the center of mass of the robot."""

from __future__ import annotations

from dataclasses import replace
from typing import TypedDict

import numpy as np

from crosscheck.quantities.measures import (
    ORDER,
    Chosen,
    Measure,
    Size,
    columns_relative_to,
    constant,
    linear_first,
    relative_to,
    total_mass,
)
from crosscheck.quantities.quantity import Quantity, verb
from crosscheck.quantities.rows.frames import VELOCITY
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import by_part, center_offset, largest, largest_tensor, relative
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.reference.native_functions import NativeFunction
from graphdyn.layout import ANGULAR, LINEAR, Array

_ORIGIN = "the world's origin"
_POINT = {"about": ("the center of mass", _ORIGIN), **ORDER}
"""Convention: the point of the angular momentum."""

_WORLD_ORIGIN = "at the height of the world's origin"


def _reach(states: ScaledStates) -> Array:
    """Largest position of a link, and offset of a center of mass [m]."""
    return largest(states.origins) + center_offset(states.model)


def _gravity(states: ScaledStates) -> float:
    return float(np.linalg.norm(states.model.gravity))


def _potential_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Up to a constant if zero is elsewhere: the median of the differences, which single wrong answers do not move."""
    if chosen["zero"] != _WORLD_ORIGIN:
        x = x - np.median(x - y)
    return relative(x, y, _gravity(states) * total_mass(states) * _reach(states))


def _linear(states: ScaledStates) -> Array:
    return total_mass(states) * states.sizes.velocity


def _spin(states: ScaledStates) -> Array:
    return largest_tensor(states.model) * states.sizes.omega


def _linear_of_joint(states: ScaledStates) -> Array:
    return total_mass(states) * states.sizes.arm


def _spin_of_joint(states: ScaledStates) -> Array:
    return largest_tensor(states.model) + 0 * states.sizes.arm


def _by_part(linear: Size, spin: Size, six: int = -1, about: str = "") -> Measure:
    """Errors of linear and angular momentum. about: the point, where it is not chosen; six: the axis of the two
    parts"""

    def errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        x, y = (np.moveaxis(linear_first(z, chosen, six), six, -1) for z in (x, y))
        lever = states.sizes.lever
        if (about or chosen["about"]) == _ORIGIN:
            lever = lever + float(np.abs(states.model.base.translation).max())
        return by_part(x, y, linear(states), linear(states) * lever + spin(states))

    return errors


def _about_chosen(answer: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """The momentum (N, 6), or the map to it (N, 6, n), about the chosen point."""
    if chosen["about"] != _ORIGIN:
        return answer
    center = states.answer("center_of_mass")
    moved = np.array(answer)
    if answer.ndim == 2:
        moved[:, ANGULAR] += np.cross(center, answer[:, LINEAR])
    else:
        moved[:, ANGULAR] += np.cross(center[:, :, None], answer[:, LINEAR], axis=1)
    return moved


class EnergyFunctions(TypedDict, total=False):
    """What of it a user may give to be judged, as keywords of crosscheck.judge."""

    center_of_mass: TestedFunction | None
    center_of_mass_velocity: TestedFunction | None
    center_of_mass_jacobian: TestedFunction | None
    momentum: TestedFunction | None
    centroidal_map: TestedFunction | None
    kinetic_energy: TestedFunction | None
    potential_energy: TestedFunction | None
    kinetic_energy_regressor: TestedFunction | None
    potential_energy_regressor: TestedFunction | None


MOMENTA = (
    Quantity(
        name="center_of_mass",
        ours=verb("center_of_mass"),
        pinocchio=NativeFunction("centerOfMass", ("q",)),
        errors=relative_to(_reach),
        scale="largest position, offset of a center",
        massive=True,
    ),
    Quantity(
        name="center_of_mass_velocity",
        ours=verb("center_of_mass_velocity"),
        pinocchio=lambda there, _: there.center_of_mass_velocity,
        against="centerOfMass, vcom",
        errors=relative_to(lambda states: states.sizes.velocity),
        scale=VELOCITY,
        massive=True,
    ),
    Quantity(
        name="center_of_mass_jacobian",
        ours=verb("center_of_mass_jacobian"),
        pinocchio=NativeFunction("jacobianCenterOfMass", ("q",), "columns_of", rooted=True),
        errors=relative_to(lambda states: states.sizes.arm),
        scale="arm",
        massive=True,
    ),
    Quantity(
        name="momentum",
        ours=verb("momentum", "about_center_of_mass"),
        pinocchio=NativeFunction("computeCentroidalMomentum", ("q", "v"), rooted=True),
        errors=_by_part(_linear, _spin),
        scale="linear: mass × velocity; angular: that × lever + tensor × ‖ω‖",
        massive=True,
        conventions=_POINT,
        as_chosen=_about_chosen,
    ),
    Quantity(
        name="momentum_about_origin",
        ours=verb("momentum", "about_origin"),
        pinocchio=lambda there, _: there.momentum_about_origin,
        against="Σ of the bodies' momenta",
        errors=_by_part(_linear, _spin, about=_ORIGIN),
        scale="the same, levers from the world's origin",
        massive=True,
    ),
    Quantity(
        name="centroidal_map",
        ours=verb("centroidal_map"),
        pinocchio=NativeFunction("computeCentroidalMap", ("q",), "columns_of", rooted=True),
        errors=_by_part(_linear_of_joint, _spin_of_joint, -2),
        scale="linear: mass × arm; angular: that × lever + tensor",
        massive=True,
        conventions=_POINT,
        as_chosen=_about_chosen,
        six=-2,
    ),
)

ENERGIES = (
    Quantity(
        name="kinetic_energy",
        shows="inertia as a quadratic form",
        ours=verb("kinetic_energy"),
        pinocchio=NativeFunction("computeKineticEnergy", ("q", "v"), rooted=True),
        against="computeKineticEnergy; of the bodies",
        errors=relative_to(),
        scale="nothing more",
        benchmark="kinetic energy",
    ),
    Quantity(
        name="potential_energy",
        ours=verb("potential_energy"),
        pinocchio=NativeFunction("computePotentialEnergy", ("q",)),
        against="computePotentialEnergy; of the bodies",
        errors=_potential_errors,
        scale="weight × largest position",
        conventions={"zero": (_WORLD_ORIGIN, "elsewhere")},
        widening=("zero",),
    ),
    Quantity(
        name="kinetic_energy_regressor",
        ours=verb("energy_regressor", "kinetic"),
        pinocchio=NativeFunction("computeKineticEnergyRegressor", ("q", "v"), "parameters_of"),
        errors=columns_relative_to(
            lambda states: states.sizes.velocity**2,
            lambda states: states.sizes.velocity * states.sizes.omega,
            lambda states: states.sizes.omega**2,
        ),
        scale="columns of m: velocity²; of m c: velocity × ‖ω‖; of I: ‖ω‖²",
    ),
    Quantity(
        name="potential_energy_regressor",
        ours=replace(
            verb("energy_regressor", "potential"),
            arguments=("q",),
            code="graphdyn.energy_regressor(model, q, 0 * q).potential",
        ),
        pinocchio=NativeFunction("computePotentialEnergyRegressor", ("q",), "parameters_of"),
        errors=columns_relative_to(
            lambda states: _gravity(states) * _reach(states),
            lambda states: constant(_gravity(states), states),
            lambda states: constant(0, states),
        ),
        scale="columns of m: ‖g‖ × largest position; of m c: ‖g‖",
    ),
)
