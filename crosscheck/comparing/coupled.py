"""Robots whose joints drive each other: graphdyn beside Pinocchio's free joints, projected by K of q_all = K q + o.

Pinocchio's own mimic joints are not asked: its Coriolis terms are wrong there, and most of its functions refuse them.
All other quantities are those of the robot without couplings. The error of a quantity is the largest of all methods.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crosscheck.quantities.scaled_states import ScaledStates
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
from graphdyn import Placement, RobotModel
from graphdyn.layout import Array

MAX_COUPLED_STATES = 100
"""Largest number of states: the other quantities have looked at the rest of the robot."""


def coupled_case(model: RobotModel, samples: int, seed: int) -> Case:
    """Random states of the free joints, with loads on the bodies."""
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, min(samples, MAX_COUPLED_STATES))
    a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
    weight = sum(body.mass for body in model.bodies)
    wrenches = weight * rng.normal(size=(len(q), model.n_bodies, 6))
    return Case("coupled", model, Placement(), q, v, a, None, wrenches)


def coupled_errors(case: Case, ours: ScaledStates, pinocchio: PinocchioModel, *, forward: bool) -> dict[str, Array]:
    """Errors (N,) of each quantity by name. ours: the same states; forward: whether the mass matrix is regular"""
    model, loads = case.model, case.external_wrenches
    k, reactions = model.degrees_of_freedom.matrix, model.degrees_of_freedom.reactions
    everywhere = model.joint_positions(case.q), case.v @ k.T, case.a @ k.T
    ref = PinocchioAnswers(pinocchio, model.uncoupled, *everywhere, np.zeros_like(everywhere[0]), loads)
    tau, wrench, needed = ref.tau @ k, largest(ref.joint_wrenches), ref.tau @ reactions.T
    size = term_sizes(model, everywhere[1], everywhere[2], ref.position, ref.velocity, ref.acceleration)
    mass, inertia = k.T @ ref.mass_matrix @ k, np.full(len(tau), largest_tensor(model)) * np.abs(k).sum() ** 2
    inverse = ours.by_methods("inverse_dynamics", loaded=True)
    regressor = np.swapaxes(np.swapaxes(pinocchio.torque_regressor(*everywhere), -1, -2) @ k, -1, -2)

    errors = {
        "coupled_inverse_dynamics": [relative(x.tau, tau, wrench, size.spin) for x in inverse],
        "coupling_multipliers": [relative(x.coupling_multipliers, needed, wrench, size.spin) for x in inverse],
        "coupled_mass_matrix": [relative(x, mass, inertia) for x in ours.by_methods("mass_matrix")],
        "coupled_joint_torque_regressor": [
            by_parameter_type(x, regressor, *size.regressor_columns) for x in ours.by_methods("joint_torque_regressor")
        ],
    }
    if forward:
        solved = replace(ours, tau=tau).by_methods("forward_dynamics", loaded=True)
        scale = acceleration_scale(mass, case.a, tau, ref.joint_wrenches)
        errors["coupled_forward_dynamics"] = [largest(x.a - case.a) / scale for x in solved]
    return {name: np.maximum.reduce(of_methods) for name, of_methods in errors.items()}
