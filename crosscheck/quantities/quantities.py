"""The compared quantities (docs/notation.md describes them), and the system of equations that some judge."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.quantities.states import Case
from crosscheck.quantities.tolerances import (
    ACCELERATION,
    AGREEMENT,
    BACKWARD,
    FORWARD_WRENCH,
    IDENTIFICATION,
    RANK,
    RESIDUAL,
    Tolerance,
)
from graphdyn import KKTSystem, maximal_state
from graphdyn.equations import applied_terms, constraints, mass_terms
from graphdyn.layout import Array


@dataclass(frozen=True)
class Quantity:
    """One row of the table: a quantity, the function of Pinocchio it is compared with, and the bound of its error.

    scale: besides the largest reference value, what the error is relative to, in the terms of docs/notation.md
    forward: whether it needs a regular mass matrix
    massive: whether it needs a body with mass
    verb: the function of graphdyn to compare, where its result is a torque for each joint and Pinocchio's function
        takes the same arguments; both values, scale and code to reproduce then follow from it
    """

    name: str
    against: str
    scale: str
    tolerance: Tolerance
    forward: bool = False
    massive: bool = False
    verb: str | None = None


_PLACED = "rotations: 1; positions: largest position of a link, offset of a center of mass"
_BY_TYPE = "columns of m: compensated × lever; of m c: compensated; of I: turn"
_BY_PART = "forces: force; moments: moment"
_WRENCH = "largest joint wrench"
_TORQUE = "largest joint wrench; spin"
_CLOSED = "that of acceleration × largest over smallest singular value of J"
_CLOSED_WRENCH = (
    "largest joint wrench × largest over smallest singular value of J; ∣M∣ × the error of a; Pinocchio's own residual"
)
_SOLVED = "only cond(M) ‖a‖ + ‖M⁻¹‖ (‖τ‖ + largest joint wrench)"
_REQUIRED = "only τ, the largest joint wrench and load, ∣M∣ ∣a∣"
_SOLVED_BODIES = "that of acceleration × n × max(1, lever)"
_BASE = "only cond(W) ‖x‖ × rounding of a column, columns of W at unit length"

_PASSIVE = (
    Quantity("link_placement", "forwardKinematics, oMi", _PLACED, AGREEMENT),
    Quantity("frame_placement", "updateFramePlacements, oMf of fused links", _PLACED, AGREEMENT),
    Quantity("link_twist", "forwardKinematics, v", "linear: ‖ω‖ × lever + slide rate", AGREEMENT),
    Quantity("body_acceleration", "forwardKinematics, a", "linear: swing; angular: turn", AGREEMENT),
    Quantity("torque", "rnea", _TORQUE, AGREEMENT),
    Quantity("joint_wrench", "rnea, data.f", _BY_PART, AGREEMENT),
    Quantity("multipliers", "rnea, data.f", _WRENCH, AGREEMENT),
    Quantity("torque_external", "rnea with fext", _TORQUE, AGREEMENT),
    Quantity("joint_wrench_external", "rnea with fext, data.f", _BY_PART, AGREEMENT),
    Quantity("mass_matrix", "crba", "largest entry of a tensor", AGREEMENT),
    Quantity("bias_torque", "nonLinearEffects", _WRENCH, AGREEMENT, verb="bias_torque"),
    Quantity("gravity_torque", "computeGeneralizedGravity", _WRENCH, AGREEMENT, verb="gravity_torque"),
    Quantity("torque_regressor", "computeJointTorqueRegressor", _BY_TYPE, AGREEMENT),
    Quantity("body_regressor", "jointBodyRegressor", "columns of m and m c: compensated; of I: turn", AGREEMENT),
)

_FORWARD = (
    Quantity("acceleration", "aba; ours from the dense system", _SOLVED, ACCELERATION, forward=True),
    Quantity("acceleration_projected", "aba; ours from the null space", _SOLVED, ACCELERATION, forward=True),
    Quantity("acceleration_external", "aba with fext; dense system", _SOLVED, ACCELERATION, forward=True),
    Quantity("backward_error", "τ that rnea needs at a; dense system", _REQUIRED, BACKWARD, forward=True),
    Quantity("backward_error_projected", "τ that rnea needs at a; null space", _REQUIRED, BACKWARD, forward=True),
    Quantity("backward_error_external", "with fext; dense system", _REQUIRED, BACKWARD, forward=True),
    Quantity("backward_error_projected_external", "with fext; null space", _REQUIRED, BACKWARD, forward=True),
    Quantity("forward_body_acceleration", "aba, then a; dense system", _SOLVED_BODIES, ACCELERATION, forward=True),
    Quantity("forward_joint_wrench", "aba, then rnea; dense system", _BY_PART, FORWARD_WRENCH, forward=True),
    Quantity(
        "forward_joint_wrench_external",
        "aba, then rnea, with fext; dense system",
        _BY_PART,
        FORWARD_WRENCH,
        forward=True,
    ),
    Quantity("forward_multipliers", "aba, then rnea; dense system", "force and moment", FORWARD_WRENCH, forward=True),
)

_SOLVED_RATES = "only cond(M) ‖∂a‖ + ‖M⁻¹‖ (‖∂τ‖ + largest joint wrench)"
_SOLVED_INVERSE = "only cond(M) ‖M⁻¹‖"
_BY_RATE = "largest entry of M × largest velocity"

_SOLVED_BY_TYPE = "per type of column: only cond(M) ‖∂a‖ + ‖M⁻¹‖ × that of torque_regressor"
_KINETIC = "columns of m: velocity²; of m c: velocity × ‖ω‖; of I: ‖ω‖²"
_POTENTIAL = "columns of m: ‖g‖ × largest position; of m c: ‖g‖"
_MOMENTUM_BY_TYPE = "columns of m: rate × arm; of m c: rate; of I: ‖ω‖"
_MOMENTUM = "linear: mass × velocity; angular: that × lever + tensor × ‖ω‖"
_MOMENTUM_FAR = "the same, levers from the world's origin"
_CENTROIDAL = "linear: mass × arm; angular: that × lever + tensor"
_FRAME_JACOBIAN = "linear: arm; angular: 1"
_FRAME_VELOCITY = "linear: ‖ω‖ × lever + slide rate"
_FRAME_ACCELERATION = "linear: swing; angular: turn"
_FRAME_RATE = "linear: rate; angular: ‖ω‖"
_LOOSENED = "computeRNEADerivatives of free joints"
_TWICE = "exact sums of computeRNEADerivatives"
_BY_PART_OF = {
    "q": "forces: mass × max(compensated, turn × arm); moments: that × arm + spin",
    "v": "forces: 2 mass × rate; moments: that × arm + 2 ‖ω‖ × tensor",
    "a": "forces: mass × arm; moments: that × arm + tensor",
}

_DERIVED = (
    Quantity("dtau_dq", "computeRNEADerivatives; complex steps", _TORQUE, AGREEMENT),
    Quantity("dtau_dv", "computeRNEADerivatives; complex steps", _BY_RATE, AGREEMENT),
    Quantity("coriolis_matrix", "computeCoriolisMatrix; complex steps", _BY_RATE, AGREEMENT),
    Quantity("kinetic_energy", "computeKineticEnergy; of the bodies", "nothing more", AGREEMENT),
    Quantity("potential_energy", "computePotentialEnergy; of the bodies", "weight × largest position", AGREEMENT),
    Quantity("static_torque", "computeStaticTorque with fext", "largest joint wrench at rest", AGREEMENT),
    Quantity("power", "rnea with fext, times v", f"({_TORQUE}) × largest velocity", AGREEMENT),
    Quantity("kinetic_energy_regressor", "computeKineticEnergyRegressor", _KINETIC, AGREEMENT),
    Quantity("potential_energy_regressor", "computePotentialEnergyRegressor", _POTENTIAL, AGREEMENT),
    Quantity("momentum_regressor", "computeJointTorqueRegressor, v for a", _MOMENTUM_BY_TYPE, AGREEMENT),
    Quantity("center_of_mass", "centerOfMass", "largest position, offset of a center", AGREEMENT, massive=True),
    Quantity("center_of_mass_velocity", "centerOfMass, vcom", _FRAME_VELOCITY, AGREEMENT, massive=True),
    Quantity("center_of_mass_jacobian", "jacobianCenterOfMass", "arm", AGREEMENT, massive=True),
    Quantity("centroidal_momentum", "computeCentroidalMomentum", _MOMENTUM, AGREEMENT, massive=True),
    Quantity("momentum_about_origin", "Σ of the bodies' momenta", _MOMENTUM_FAR, AGREEMENT, massive=True),
    Quantity("centroidal_map", "computeCentroidalMap", _CENTROIDAL, AGREEMENT, massive=True),
    Quantity("frame_jacobian", "getFrameJacobian", _FRAME_JACOBIAN, AGREEMENT),
    Quantity("frame_velocity", "getFrameVelocity", _FRAME_VELOCITY, AGREEMENT),
    Quantity("frame_acceleration", "getFrameClassicalAcceleration", _FRAME_ACCELERATION, AGREEMENT),
    Quantity("frame_acceleration_spatial", "getFrameAcceleration", _FRAME_ACCELERATION, AGREEMENT),
    Quantity("frame_jacobian_derivative", "getFrameJacobianTimeVariation", _FRAME_RATE, AGREEMENT),
    *(Quantity(f"dwrenches_d{x}", _LOOSENED, _BY_PART_OF[x], AGREEMENT) for x in "qva"),
    *(Quantity(f"dmultipliers_d{x}", _LOOSENED, _BY_PART_OF[x], AGREEMENT) for x in "qva"),
    Quantity("d2tau_dqdq", _TWICE, _TORQUE, AGREEMENT),
    Quantity("d2tau_dqdv", _TWICE, _BY_RATE, AGREEMENT),
    Quantity("d2tau_dqda", _TWICE, "largest entry of M", AGREEMENT),
    Quantity("d2tau_dvdv", "computeRNEADerivatives at unit v", "largest entry of M × max(1, velocity)", AGREEMENT),
    Quantity("da_dq", "computeABADerivatives; complex steps", _SOLVED_RATES, ACCELERATION, forward=True),
    Quantity("da_dv", "computeABADerivatives; complex steps", _SOLVED_RATES, ACCELERATION, forward=True),
    Quantity("da_dtau", "computeABADerivatives; complex steps", _SOLVED_INVERSE, ACCELERATION, forward=True),
    Quantity("mass_matrix_inverse", "computeMinverse; inverted", _SOLVED_INVERSE, ACCELERATION, forward=True),
    Quantity("da_dpi", "-computeMinverse × regressor", _SOLVED_BY_TYPE, ACCELERATION, forward=True),
)

_OWN = (
    Quantity("dynamics_residual", "A q̈ + φ_qᵀλ = B", "only the largest row of Σ ∣terms∣", RESIDUAL, forward=True),
    Quantity("constraint_residual", "φ_q q̈ = ζ", "only q̈ and the largest row of Σ ∣terms∣", RESIDUAL, forward=True),
    Quantity("constraint_rank", "φ_q has rank 5n", "full rank", RANK),
    Quantity("kkt_rank", "Eq. (111) has rank 11n", "full rank", RANK, forward=True),
    Quantity("base_parameters", "same least squares with Pinocchio's regressor", _BASE, IDENTIFICATION, massive=True),
)

RECURSIVE = "_recursive"
"""Ending of the names of quantities that the recursive method computes; compared at random states only."""


def _recursive(rows: Iterable[Quantity], names: set[str]) -> Iterator[Quantity]:
    """The named rows again, for the recursive method; where `against` names our own method, it names this one."""
    for row in rows:
        if row.name in names:
            function, ours, _ = row.against.partition("; ")
            against = f"{function}; ours body after body" if ours else function
            yield replace(row, name=f"{row.name}{RECURSIVE}", against=against)


_PASSIVE_TWICE = {"torque", "joint_wrench", "multipliers", "mass_matrix", "torque_regressor"}
_FORWARD_TWICE = {
    "acceleration",
    "backward_error",
    "backward_error_external",
    "forward_body_acceleration",
    "forward_joint_wrench",
    "forward_multipliers",
}
"""Quantities that are compared twice: by the usual method, and by the recursive one."""

QUANTITIES = (
    *_PASSIVE,
    *_recursive(_PASSIVE, _PASSIVE_TWICE),
    *_FORWARD,
    *_recursive(_FORWARD, _FORWARD_TWICE),
    *_DERIVED,
    *_recursive(_DERIVED, {row.name for row in _DERIVED}),
    *_OWN,
)
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}

COUPLED = {
    quantity.name: quantity
    for quantity in (
        Quantity("coupled_torque", "rnea with fext at K q + o, times Kᵀ", _TORQUE, AGREEMENT),
        Quantity("coupling_multipliers", "what rnea with fext needs at driven joints", _TORQUE, AGREEMENT),
        Quantity("coupled_mass_matrix", "Kᵀ crba K", "largest entry of a tensor × (Σ∣K∣)²", AGREEMENT),
        Quantity("coupled_regressor", "Kᵀ computeJointTorqueRegressor", _BY_TYPE, AGREEMENT),
        Quantity("coupled_acceleration", "a for which rnea gives τ", _SOLVED, ACCELERATION, forward=True),
    )
}
"""Compared in addition where joints drive each other; the others are then those of the robot without couplings."""

LOOPED = {
    quantity.name: quantity
    for quantity in (
        Quantity("closed_acceleration", "constraintDynamics, of points held together", _CLOSED, ACCELERATION),
        Quantity("closed_joint_wrench", "rnea with its forces; what is determined", _CLOSED_WRENCH, AGREEMENT),
        Quantity("motor_torque", "a for which constraintDynamics moves as given", _CLOSED, ACCELERATION),
    )
}
"""Compared in addition where chords close loops; the others are then those of the tree."""

DERIVED = tuple(row.name for row in _DERIVED)
"""Quantities that are compared at the first random states only, by the plain and by the recursive methods."""


def kkt_batch(case: Case, tau: Array) -> KKTSystem:
    """Eq. (111) at all states of a case at once."""
    state = maximal_state(case.model.rooted, case.q, case.v)
    phi_q, zeta = constraints(state)
    applied = applied_terms(state, tau, np.zeros((case.model.n_bodies, 6)))
    return KKTSystem(
        np.broadcast_to(mass_terms(state), (*phi_q.shape[:-2], *phi_q.shape[-1:] * 2)), phi_q, applied, zeta
    )
