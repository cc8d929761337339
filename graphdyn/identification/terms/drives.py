"""Torques of the drives: inertia of the rotors, and coupling of the last two axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.equations.kinematics import maximal_state, null_space
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.friction import smooth_sign
from graphdyn.identification.terms.term import TermParameter, per_joint_columns, per_joint_rows
from graphdyn.layout import ANGULAR, Array
from graphdyn.model.robot_model import RobotModel

UNIT_AXIS_TOLERANCE = 1e-6
"""Largest deviation of the length of an axis from 1 that rounding in a file explains."""


@dataclass(frozen=True, eq=False)
@short_repr
class RotorInertia:
    """I_a a per joint: inertia of rotor and gear as seen at the joint.

    With gears it includes gyroscopic coupling. Rotor j turns with s = G_j v_j about an axis n that is fixed in the body
    that carries it, the inside body of joint j, with inertia I = I_a / G_j² about n. The term contains those parts of
    its kinetic energy I (s + n·ω)² / 2 that depend on s; the rest is inertia of the carrier:

        I_a a_j + I_a / G_j n·ω̇            on joint j
        I_a / G_j Jᵀ (n a_j + ω × n v_j)   on all joints that turn the carrier, J its angular Jacobian

    Siciliano, Sciavicco, Villani and Oriolo, Robotics: Modeling, Planning and Control, 2009, section 7.1.1, with the
    terms that it neglects for large G.

    gears: G_j, signed: turns of the rotor per turn of the joint      (n,)   [1, rad/m]
    axes: n_j, of length 1, in axes of the inside link; that of the joint if left out      (n, 3)
    """

    gears: ArrayLike | None = None
    axes: ArrayLike | None = None

    def __post_init__(self) -> None:
        if self.axes is not None and self.gears is None:
            raise InvalidInput("axes of the rotors have no effect without their gears; give both")

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "rotor inertia", "IA", "kg m²", "kg")

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        rows = per_joint_rows(samples.a)
        if self.gears is None:
            return rows
        gears, axes = self._rotors(model)
        state = maximal_state(model, samples.q, samples.v, samples.a, base=samples.base, method="reproducible")
        assert state.acceleration is not None
        jacobian = null_space(state).reshape(*samples.q.shape[:1], model.n_bodies, 6, -1)[:, :, ANGULAR]
        for j, number in enumerate(model.degrees_of_freedom.independent):
            carrier = model.joints[number].inside - 1
            if carrier < 0:  # a rotor in the base
                if samples.base is not None:
                    raise InvalidInput("rotors with gears need a base at rest; leave the gears out")
                continue
            omega = state.velocity[:, carrier, ANGULAR]
            change = axes[j] * samples.a[:, [j]] + np.cross(omega, axes[j]) * samples.v[:, [j]]
            rows[:, :, j] += np.einsum("tak,ta->tk", jacobian[:, carrier], change) / gears[j]
            rows[:, j, j] += state.acceleration[:, carrier, ANGULAR] @ axes[j] / gears[j]
        return rows

    def _rotors(self, model: RobotModel) -> tuple[Array, Array]:
        n = model.nv
        gears = as_floats("gears of the rotors", self.gears)
        if gears.shape != (n,) or not np.all(np.isfinite(gears)) or not np.all(gears):
            raise InvalidInput(f"gears of the rotors are {np.array2string(gears)}; give {n} numbers that are not zero")
        joints = [model.joints[number] for number in model.degrees_of_freedom.independent]
        own = [joint.placement.rotation @ joint.axis for joint in joints]
        axes = as_floats("axes of the rotors", own if self.axes is None else self.axes)
        if axes.shape != (n, 3) or not np.all(np.abs(np.linalg.norm(axes, axis=-1) - 1) <= UNIT_AXIS_TOLERANCE):
            raise InvalidInput(f"axes of the rotors have shape {axes.shape}; give {n} vectors of length 1")
        return gears, axes


@dataclass(frozen=True)
class CoupledWrist:
    """Coupling of two axes j, k whose motors act on both joints (Stäubli RX and TX: axes 5 and 6).

    On joint j:  IAM a_k + FVM v_k + FCM sign(v_j + v_k)
    On joint k:  IAM a_j + FVM v_j + FCM sign(v_j + v_k)

    Gautier, Janot and Vandanjon, "A new closed-loop output error method for parameter identification of robot
    dynamics", IEEE Transactions on Control Systems Technology 21(2), 2013.

    joints: their names; the last two of the robot if left out
    width: tanh(· / width) instead of the sign [rad/s]
    """

    joints: tuple[str, str] | None = None
    width: float | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        _, k = self._numbers(model)
        last = model.independent_joints[k]
        return (
            TermParameter(f"{last} motor inertia in the coupling", f"IAM_{k + 1}", "kg m²"),
            TermParameter(f"{last} motor viscous friction in the coupling", f"FVM_{k + 1}", "N m s/rad"),
            TermParameter(f"{last} motor Coulomb friction in the coupling", f"FCM_{k + 1}", "N m"),
        )

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        j, k = self._numbers(model)
        rows = np.zeros((*samples.v.shape, 3))
        friction = smooth_sign(samples.v[:, [j]] + samples.v[:, [k]], self.width)[:, 0]
        for here, other in ((j, k), (k, j)):
            rows[:, here, 0] = samples.a[:, other]
            rows[:, here, 1] = samples.v[:, other]
            rows[:, here, 2] = friction
        return rows

    def _numbers(self, model: RobotModel) -> tuple[int, int]:
        names = model.independent_joints[-2:] if self.joints is None else self.joints
        unknown = [name for name in names if name not in model.independent_joints]
        if unknown or len(set(names)) != 2:
            raise InvalidInput(
                f"the coupled wrist needs two joints of robot '{model.name}', got {', '.join(names)}; "
                f"it has {', '.join(model.independent_joints)}"
            )
        return model.independent_joints.index(names[0]), model.independent_joints.index(names[1])
