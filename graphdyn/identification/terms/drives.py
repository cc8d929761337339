"""What the drives add: inertia of the rotors, and coupling of the last two axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn._errors import InvalidInput
from graphdyn._model import RobotModel
from graphdyn.identification.samples import Samples
from graphdyn.identification.terms.friction import smooth_sign
from graphdyn.identification.terms.term import Column, per_joint_columns, per_joint_rows
from graphdyn.layout import Array


@dataclass(frozen=True)
class RotorInertia:
    """I_a a per joint: inertia of rotor and gear as seen at the joint, without gyroscopic effects."""

    def columns(self, model: RobotModel) -> tuple[Column, ...]:
        return per_joint_columns(model, "rotor inertia", "IA", "kg m²", "kg")

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(samples.a)


@dataclass(frozen=True)
class CoupledWrist:
    """Two axes j, k whose motors act on both joints (Stäubli RX and TX: axes 5 and 6).

    On joint j:  IAM a_k + FVM v_k + FCM sign(v_j + v_k)
    On joint k:  IAM a_j + FVM v_j + FCM sign(v_j + v_k)

    Gautier, Janot and Vandanjon, "A new closed-loop output error method for parameter identification of robot
    dynamics", IEEE Transactions on Control Systems Technology 21(2), 2013.

    joints: their names; the last two of the robot if left out
    width: tanh(· / width) instead of the sign [rad/s]
    """

    joints: tuple[str, str] | None = None
    width: float | None = None

    def columns(self, model: RobotModel) -> tuple[Column, ...]:
        _, k = self._numbers(model)
        last = model.independent_joints[k]
        return (
            Column(f"{last} motor inertia in the coupling", f"IAM_{k + 1}", "kg m²"),
            Column(f"{last} motor viscous friction in the coupling", f"FVM_{k + 1}", "N m s/rad"),
            Column(f"{last} motor Coulomb friction in the coupling", f"FCM_{k + 1}", "N m"),
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
