"""The table that says how each verb of the dynamics is computed."""

from __future__ import annotations

from typing import Any

from graphdyn.equations import body_sums, complex_steps, projected, regressors
from graphdyn.equations import frame_motion as frames
from graphdyn.equations.loops import derivatives as loop_derivatives
from graphdyn.equations.loops import dynamics as loops
from graphdyn.equations.projected import Specification
from graphdyn.layout import Array
from graphdyn.verbs.answers import (
    EnergyRegressor,
    ForwardDynamics,
    ForwardDynamicsDerivatives,
    InverseDynamics,
    InverseDynamicsDerivatives,
    InverseDynamicsSecondDerivatives,
    Momentum,
    ReactionDerivatives,
)
from graphdyn.verbs.verb import Verb

DIFFERENCES = "take differences along closed motions (graphdyn.assemble)"


def _torques(specification: Specification) -> Verb[Array]:
    """A verb that answers torques, or torques per parameter; of robots with loops those of the motors."""
    return Verb(specification, closed=loops.at_motors(specification))


class Verbs:
    """The table of verbs. Each has a public function of its name; graphdyn.compile takes those of one array."""

    forward_dynamics = Verb(projected.forward_dynamics, answer=ForwardDynamics, closed=loops.forward_dynamics)
    inverse_dynamics = Verb(projected.inverse_dynamics, answer=InverseDynamics, closed=loops.inverse_dynamics)
    solve_kkt = Verb[tuple[Array, Array]](
        projected.forward_dynamics,
        "forward_dynamics",
        ("body_accelerations", "multipliers"),
        closed=loops.forward_dynamics,
    )
    joint_torques = Verb[Array](projected.inverse_dynamics, "inverse_dynamics", ("tau",), closed=loops.inverse_dynamics)
    joint_accelerations = Verb[Array](
        projected.forward_dynamics, "forward_dynamics", ("a",), closed=loops.forward_dynamics
    )
    mass_matrix = Verb[Array](projected.mass_matrix)
    mass_matrix_inverse = Verb[Array](projected.mass_matrix_inverse, remedy="joint_accelerations says what torques do")
    coriolis_matrix = Verb[Array](complex_steps.coriolis_matrix)
    bias_torque = _torques(projected.torque_at_zero("bias_torque", "a"))
    gravity_torque = _torques(projected.torque_at_zero("gravity_torque", "v", "a"))
    static_torque = _torques(projected.torque_at_zero("static_torque", "v", "a"))
    power = Verb[Array](projected.power, closed=loops.power)
    kinetic_energy = Verb[Array](projected.kinetic_energy)
    potential_energy = Verb[Array](projected.potential_energy)
    center_of_mass = Verb[Array](body_sums.center_of_mass)
    center_of_mass_velocity = Verb[Array](body_sums.center_of_mass_velocity)
    center_of_mass_jacobian = Verb[Array](body_sums.center_of_mass_jacobian)
    momentum = Verb(body_sums.momentum, answer=Momentum)
    centroidal_map = Verb[Array](body_sums.centroidal_map)
    inverse_dynamics_derivatives = Verb(
        complex_steps.inverse_dynamics_derivatives,
        answer=InverseDynamicsDerivatives,
        closed=loop_derivatives.inverse_dynamics_derivatives,
    )
    inverse_dynamics_second_derivatives = Verb(
        complex_steps.inverse_dynamics_second_derivatives,
        answer=InverseDynamicsSecondDerivatives,
        remedy=DIFFERENCES,
    )
    forward_dynamics_derivatives = Verb(
        complex_steps.forward_dynamics_derivatives,
        answer=ForwardDynamicsDerivatives,
        closed=loop_derivatives.forward_dynamics_derivatives,
    )
    reaction_derivatives = Verb(
        complex_steps.reaction_derivatives,
        answer=ReactionDerivatives,
        remedy=DIFFERENCES,
    )
    forward_dynamics_parameter_derivatives = Verb[Array](
        regressors.forward_dynamics_parameter_derivatives, remedy=DIFFERENCES
    )
    frame_jacobian = Verb[Array](frames.frame_jacobian)
    frame_jacobian_derivative = Verb[Array](complex_steps.frame_jacobian_derivative)
    frame_velocity = Verb[Array](frames.frame_velocity)
    frame_acceleration = Verb[Array](frames.frame_acceleration)
    joint_torque_regressor = _torques(regressors.joint_torque_regressor)
    body_regressor = Verb[Array](regressors.body_regressor)
    momentum_regressor = Verb[Array](regressors.momentum_regressor)
    energy_regressor = Verb(regressors.energy_regressor, answer=EnergyRegressor)


VERBS: dict[str, Verb[Any]] = {name: verb for name, verb in vars(Verbs).items() if isinstance(verb, Verb)}
