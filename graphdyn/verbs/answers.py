"""What the verbs answer that answer several arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from graphdyn.display import short_repr
from graphdyn.layout import Array

__all__ = [
    "EnergyRegressor",
    "ForwardDynamics",
    "ForwardDynamicsDerivatives",
    "InverseDynamics",
    "InverseDynamicsDerivatives",
    "InverseDynamicsSecondDerivatives",
    "Momentum",
    "ReactionDerivatives",
]


@dataclass(frozen=True, eq=False)
@short_repr
class ForwardDynamics:
    """Answer of forward_dynamics.

    a: joint accelerations                                  (…, n)     [rad/s² or m/s²]
    body_accelerations: r̈ in world axes, ω̇ in body axes     (…, n, 6)  [m/s², rad/s²]
    multipliers: reaction of the inside body on body j      (…, n, 5)  [N, N m]
    joint_wrenches: force, moment on body j, actuator included, at O_j, in link axes   (…, n, 6)  [N, N m]
    coupling_multipliers: what each coupling supplies to the joint that it drives, as an actuator there would; it takes
        ratio times as much from the joints that drive     (…, n_couplings)  [N m or N]
    chord_multipliers: reaction of body i on body j of each chord, in the order of model.loops.row_names()
                                                            (…, n_chord_rows)  [N, N m]

    With chords, multipliers and joint wrenches are along t_1, t_2 and p of each joint, and NaN where redundant
    constraints leave them undetermined.
    """

    a: Array
    body_accelerations: Array
    multipliers: Array
    joint_wrenches: Array
    coupling_multipliers: Array = field(default_factory=lambda: np.empty(0))
    chord_multipliers: Array = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, eq=False)
@short_repr
class InverseDynamics:
    """Answer of inverse_dynamics.

    tau: actuator torques or forces                         (…, n)     [N m or N]
    body_accelerations, multipliers, joint_wrenches, coupling_multipliers, chord_multipliers: as in ForwardDynamics
    """

    tau: Array
    body_accelerations: Array
    multipliers: Array
    joint_wrenches: Array
    coupling_multipliers: Array = field(default_factory=lambda: np.empty(0))
    chord_multipliers: Array = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, eq=False)
@short_repr
class InverseDynamicsDerivatives:
    """Answer of inverse_dynamics_derivatives; entry (…, i, k) is that of torque i and joint k.

    dtau_dq: ∂τ/∂q                                          (…, n, n)  [N m, N, N/m]
    dtau_dv: ∂τ/∂v                                          (…, n, n)  [N m s, N s, N s/m]
    dtau_da: ∂τ/∂a, the mass matrix                         (…, n, n)  [kg m², kg m, kg]
    """

    dtau_dq: Array
    dtau_dv: Array
    dtau_da: Array


@dataclass(frozen=True, eq=False)
@short_repr
class InverseDynamicsSecondDerivatives:
    """Answer of inverse_dynamics_second_derivatives; entry (…, i, j, k) is that of torque i, by the first variable of
    joint j and the second of joint k. ∂²τ/∂v∂a and ∂²τ/∂a∂a are zero.

    d2tau_dqdq: ∂²τ/∂q∂q, symmetric in j and k              (…, n, n, n)  [N m, N, N/m, N/m²]
    d2tau_dqdv: ∂²τ/∂q∂v                                    (…, n, n, n)  [N m s, N s, N s/m, N s/m²]
    d2tau_dqda: ∂²τ/∂q∂a, the change ∂M_ik/∂q_j of the mass matrix   (…, n, n, n)  [kg m², kg m, kg, kg/m]
    d2tau_dvdv: ∂²τ/∂v∂v, symmetric in j and k              (…, n, n, n)  [kg m², kg m, kg]
    """

    d2tau_dqdq: Array
    d2tau_dqdv: Array
    d2tau_dqda: Array
    d2tau_dvdv: Array


@dataclass(frozen=True, eq=False)
@short_repr
class ForwardDynamicsDerivatives:
    """Answer of forward_dynamics_derivatives; entry (…, i, k) is that of acceleration i and joint k.

    da_dq: ∂a/∂q                                            (…, n, n)  [1/s², 1/(m s²), m/s²]
    da_dv: ∂a/∂v                                            (…, n, n)  [1/s, 1/(m s), m/s]
    da_dtau: ∂a/∂τ, the inverse of the mass matrix          (…, n, n)  [1/(kg m²), 1/(kg m), 1/kg]
    """

    da_dq: Array
    da_dv: Array
    da_dtau: Array


@dataclass(frozen=True, eq=False)
@short_repr
class ReactionDerivatives:
    """Answer of reaction_derivatives: of the multipliers (…, n, 5, n) and of the joint wrenches (…, n, 6, n).

    The last index is the joint; units are those of a force or moment per unit of its q, v or a.
    """

    dmultipliers_dq: Array
    dmultipliers_dv: Array
    dmultipliers_da: Array
    dwrenches_dq: Array
    dwrenches_dv: Array
    dwrenches_da: Array


@dataclass(frozen=True, eq=False)
@short_repr
class Momentum:
    """Answer of momentum: linear momentum, then angular momentum, world axes.

    about_center_of_mass: angular momentum about the center of mass of the robot   (…, 6)  [kg m/s, kg m²/s]
    about_origin: angular momentum about the world's origin                        (…, 6)  [kg m/s, kg m²/s]
    """

    about_center_of_mass: Array
    about_origin: Array


@dataclass(frozen=True, eq=False)
@short_repr
class EnergyRegressor:
    """Answer of energy_regressor; ten columns per body, in the order of model.inertial_parameters.

    kinetic: T = kinetic @ π                                (…, 10n)   [J per kg, kg m, kg m²]
    potential: U = potential @ π                            (…, 10n)   [J per kg, kg m, kg m²]
    """

    kinetic: Array
    potential: Array
