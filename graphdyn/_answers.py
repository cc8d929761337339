"""What forward and inverse dynamics answer."""

from __future__ import annotations

from dataclasses import dataclass

from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class ForwardDynamics:
    """Answer of forward_dynamics.

    a: joint accelerations                                  (…, n)     [rad/s² or m/s²]
    body_accelerations: r̈ in world axes, ω̇ in body axes     (…, n, 6)  [m/s², rad/s²]
    multipliers: reaction of the inside body on body j      (…, n, 5)  [N, N m]
    joint_wrenches: force, moment on body j, actuator included, at O_j, in link axes   (…, n, 6)  [N, N m]
    """

    a: Array
    body_accelerations: Array
    multipliers: Array
    joint_wrenches: Array


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """Answer of inverse_dynamics.

    tau: actuator torques or forces                         (…, n)     [N m or N]
    body_accelerations, multipliers, joint_wrenches: as in ForwardDynamics
    """

    tau: Array
    body_accelerations: Array
    multipliers: Array
    joint_wrenches: Array
