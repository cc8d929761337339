"""The answers of the reference implementations, and the errors of a foreign answer against them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

import graphdyn
from crosscheck.judging.judged_states import JudgedStates
from crosscheck.referee.mujoco_model import MujocoModel
from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.referee.scales import (
    acceleration_scale,
    backward_error,
    by_parameter_type,
    largest,
    ratio,
    relative,
    term_sizes,
)
from graphdyn._kinematics import link_origins
from graphdyn.layout import Array

SCALES = {
    "inverse_dynamics": "largest entry of the joint wrenches",
    "forward_dynamics": "cond(M) ‖a‖∞ + ‖M⁻¹‖∞ (‖τ‖∞ + largest joint wrench)",
    "mass_matrix": "largest entry of M",
    "regressor": "largest entry and term of the parameter type (m, m c, I)",
}

BACKWARD_SCALE = "largest of τ, the joint wrenches and ∣M∣ ∣a∣"


@dataclass(frozen=True)
class Reference:
    """A reference implementation ("referee") at the judged states.

    answers: by name of the function
    torques: of accelerations (N, n) at the judged positions and velocities (N, n)
    """

    answers: Mapping[str, Array]
    torques: Callable[[Array], Array]


def graphdyn_reference(states: JudgedStates, given: Mapping[str, object]) -> Reference:
    """Answers that take time only if the function is given."""
    model, q, v, a = states.model, states.q, states.v, states.a
    answers = {
        "inverse_dynamics": graphdyn.inverse_dynamics(model, q, v, a).tau,
        "mass_matrix": graphdyn.mass_matrix(model, q),
    }
    if given["forward_dynamics"] is not None:
        answers["forward_dynamics"] = graphdyn.forward_dynamics(model, q, v, states.tau).a
    if given["regressor"] is not None:
        answers["regressor"] = graphdyn.joint_torque_regressor(model, q, v, a)
    return Reference(answers, lambda a: graphdyn.inverse_dynamics(model, q, v, a).tau)


def pinocchio_reference(states: JudgedStates) -> Reference:
    no_load = np.zeros((*states.q.shape, 6))
    referee = PinocchioModel.from_model(states.model)
    values = referee.evaluate(states.q, states.v, states.a, states.tau, no_load)
    answers = {
        "inverse_dynamics": values.tau,
        "forward_dynamics": values.a,
        "mass_matrix": values.mass_matrix,
        "regressor": values.torque_regressor,
    }
    return Reference(answers, lambda a: referee.rnea(states.q, states.v, a))


def mujoco_reference(states: JudgedStates) -> Reference:
    """Raises MujocoRefuses for robots that MuJoCo cannot represent, and where it is not installed."""
    referee = MujocoModel(states.model)

    def torques(a: Array) -> Array:
        return referee.evaluate(states.q, states.v, a, states.tau)["inverse_dynamics"]

    return Reference(referee.evaluate(states.q, states.v, states.a, states.tau), torques)


def foreign_errors(name: str, answer: Array, reference: Array, states: JudgedStates) -> Array:
    """Relative errors (N,) on the scale of the function; entries that are not finite count as infinite."""
    model, q, v, a = states.model, states.q, states.v, states.a
    dynamics = graphdyn.inverse_dynamics(model, q, v, a)
    if name == "inverse_dynamics":
        errors = relative(answer, reference, largest(dynamics.joint_wrenches))
    elif name == "mass_matrix":
        errors = relative(answer, reference)
    elif name == "forward_dynamics":
        mass = graphdyn.mass_matrix(model, q)
        wrenches = graphdyn.inverse_dynamics(model, q, v, reference).joint_wrenches
        errors = ratio(largest(answer - reference), acceleration_scale(mass, reference, states.tau, wrenches))
    else:
        state = graphdyn.maximal_state(model, q, v, a)
        assert state.acceleration is not None
        size = term_sizes(model, v, a, link_origins(state), state.velocity, state.acceleration)
        errors = by_parameter_type(answer, reference, *size.regressor_columns)
    return np.where(np.isfinite(errors), errors, np.inf)


def backward_errors(answer: Array, reference: Reference, states: JudgedStates) -> Array:
    """Backward errors (N,) of accelerations (N, n): how far the torques that they need are from the given ones.

    Accelerations that are not finite count as infinitely wrong.
    """
    model, q, v, tau = states.model, states.q, states.v, states.tau
    finite = np.all(np.isfinite(answer), axis=-1, keepdims=True)
    a = np.where(finite, answer, 0.0)
    wrenches = graphdyn.inverse_dynamics(model, q, v, a).joint_wrenches
    errors = backward_error(reference.torques(a), tau, wrenches, graphdyn.mass_matrix(model, q), a)
    return np.where(finite[:, 0] & np.isfinite(errors), errors, np.inf)
