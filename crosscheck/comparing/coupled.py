"""Robots whose joints drive each other: graphdyn beside Pinocchio's free joints, projected by K of q_all = K q + o.

Pinocchio's own mimic joints are not asked: its Coriolis terms are wrong there, and most of its functions refuse them.
All other quantities are those of the robot without couplings.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from crosscheck.quantities.scales import (
    acceleration_scale,
    by_parameter_type,
    largest,
    largest_tensor,
    relative,
    term_sizes,
)
from crosscheck.quantities.states import ACCELERATION_RANGE, Case
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from graphdyn import (
    InverseDynamics,
    Placement,
    RobotModel,
    forward_dynamics,
    inverse_dynamics,
    joint_torque_regressor,
    mass_matrix,
)
from graphdyn.arguments import Method
from graphdyn.layout import Array

MAX_COUPLED_STATES = 100
"""Largest number of states: the other quantities have looked at the rest of the robot."""

COUPLED_METHODS: tuple[Method, ...] = ("dense", "projected", "recursive")
"""The error of a quantity is the largest of these."""


def coupled_case(model: RobotModel, samples: int, seed: int) -> Case:
    """Random states of the free joints, with loads on the bodies."""
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, min(samples, MAX_COUPLED_STATES))
    a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
    weight = sum(body.mass for body in model.bodies)
    wrenches = weight * rng.normal(size=(len(q), model.n_bodies, 6))
    return Case("coupled", model, Placement(), q, v, a, None, wrenches)


@dataclass(frozen=True, eq=False)
class CoupledAnswers:
    """What graphdyn answers at the states of a case, by each of COUPLED_METHODS."""

    inverse: list[InverseDynamics]
    mass_matrix: list[Array]
    regressor: list[Array]


def coupled_answers(case: Case) -> CoupledAnswers:
    q, v, a = case.q, case.v, case.a
    return CoupledAnswers(
        [inverse_dynamics(case.model, q, v, a, case.external_wrenches, method=method) for method in COUPLED_METHODS],
        [mass_matrix(case.model, q, method=method) for method in COUPLED_METHODS],
        [joint_torque_regressor(case.model, q, v, a, method=method) for method in COUPLED_METHODS],
    )


def coupled_errors(
    case: Case, ours: CoupledAnswers, pinocchio: PinocchioModel, *, forward: bool
) -> Iterator[tuple[str, Array]]:
    """Name and errors (N,) of each quantity. forward: whether the mass matrix is regular."""
    model, loads = case.model, case.external_wrenches
    k, reactions = model.degrees_of_freedom.matrix, model.degrees_of_freedom.reactions
    everywhere = model.joint_positions(case.q), case.v @ k.T, case.a @ k.T
    ref = PinocchioAnswers(pinocchio, model.uncoupled, *everywhere, np.zeros_like(everywhere[0]), loads)
    tau, wrench = ref.tau @ k, largest(ref.joint_wrenches)
    size = term_sizes(model, everywhere[1], everywhere[2], ref.position, ref.velocity, ref.acceleration)
    mass, inertia = k.T @ ref.mass_matrix @ k, np.full(len(tau), largest_tensor(model)) * np.abs(k).sum() ** 2

    def worst(errors: list[Array]) -> Array:
        largest_of_all: Array = np.maximum.reduce(errors)
        return largest_of_all

    yield "coupled_inverse_dynamics", worst([relative(found.tau, tau, wrench, size.spin) for found in ours.inverse])
    needed = ref.tau @ reactions.T
    yield (
        "coupling_multipliers",
        worst([relative(x.coupling_multipliers, needed, wrench, size.spin) for x in ours.inverse]),
    )
    yield "coupled_mass_matrix", worst([relative(found, mass, inertia) for found in ours.mass_matrix])
    regressor = np.swapaxes(np.swapaxes(pinocchio.torque_regressor(*everywhere), -1, -2) @ k, -1, -2)
    yield (
        "coupled_joint_torque_regressor",
        worst([by_parameter_type(x, regressor, *size.regressor_columns) for x in ours.regressor]),
    )
    if forward:
        solved = [forward_dynamics(model, case.q, case.v, tau, loads, method=method).a for method in COUPLED_METHODS]
        scale = acceleration_scale(mass, case.a, tau, ref.joint_wrenches)
        yield "coupled_forward_dynamics", worst([largest(a - case.a) / scale for a in solved])
