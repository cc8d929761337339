"""Robots whose joints drive each other: graphdyn beside Pinocchio's free joints, projected by K of q_all = K q + o.

Pinocchio's own mimic joints are not asked: its Coriolis terms are wrong there, and most of its functions refuse them.
All other quantities are those of the robot without couplings.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.referee.scales import (
    acceleration_scale,
    by_parameter_type,
    largest,
    largest_tensor,
    relative,
    term_sizes,
)
from crosscheck.referee.states import ACCELERATION_RANGE, Case
from graphdyn import Placement, RobotModel, forward_dynamics, inverse_dynamics, joint_torque_regressor, mass_matrix
from graphdyn._methods import Method
from graphdyn.layout import Array

MOST = 100
"""Largest number of states: the other quantities have looked at the rest of the robot."""

METHODS: tuple[Method, ...] = ("dense", "projected", "recursive")
"""The error of a quantity is the largest of these."""


def coupled_case(model: RobotModel, samples: int, seed: int) -> Case:
    """Random states of the free joints, with loads on the bodies."""
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, min(samples, MOST))
    a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
    weight = sum(body.mass for body in model.bodies)
    wrenches = weight * rng.normal(size=(len(q), model.n_bodies, 6))
    return Case("coupled", model, Placement(), q, v, a, None, wrenches)


def coupled_errors(case: Case, referee: PinocchioModel, *, forward: bool) -> Iterator[tuple[str, Array]]:
    """Name and errors (N,) of each quantity. forward: whether the mass matrix is regular."""
    model, loads = case.model, case.external_wrenches
    k, reactions = model.freedoms.matrix, model.freedoms.reactions
    everywhere = model.joint_positions(case.q), case.v @ k.T, case.a @ k.T
    ref = referee.evaluate(*everywhere, np.zeros_like(everywhere[0]), loads)
    tau, wrench = ref.tau_external @ k, largest(ref.joint_wrenches_external)
    size = term_sizes(model, everywhere[1], everywhere[2], ref.position, ref.velocity, ref.acceleration)
    mass, inertia = k.T @ ref.mass_matrix @ k, np.full(len(tau), largest_tensor(model)) * np.abs(k).sum() ** 2
    inverse = [inverse_dynamics(model, case.q, case.v, case.a, loads, method=method) for method in METHODS]

    def worst(errors: list[Array]) -> Array:
        largest_of_all: Array = np.maximum.reduce(errors)
        return largest_of_all

    yield "coupled_torque", worst([relative(found.tau, tau, wrench, size.spin) for found in inverse])
    needed = ref.tau_external @ reactions.T
    yield "coupling_multipliers", worst([relative(x.coupling_multipliers, needed, wrench, size.spin) for x in inverse])
    ours = [mass_matrix(model, case.q, method=method) for method in METHODS]
    yield "coupled_mass_matrix", worst([relative(found, mass, inertia) for found in ours])
    regressor = np.swapaxes(np.swapaxes(ref.torque_regressor, -1, -2) @ k, -1, -2)
    found = [joint_torque_regressor(model, case.q, case.v, case.a, method=method) for method in METHODS]
    yield "coupled_regressor", worst([by_parameter_type(x, regressor, *size.regressor_columns) for x in found])
    if forward:
        solved = [forward_dynamics(model, case.q, case.v, tau, loads, method=method).a for method in METHODS]
        scale = acceleration_scale(mass, case.a, tau, ref.joint_wrenches_external)
        yield "coupled_acceleration", worst([largest(a - case.a) / scale for a in solved])
