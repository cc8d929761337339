"""Controllers given by gains: they run inside compiled steps, which a Python function cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.simulated import Law
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.motion_laws import MotionLaw

Target = ArrayLike | Sequence[MotionLaw]


@dataclass(frozen=True, eq=False)
class PDControl:
    """τ = K_p (q_d - q) + K_d (v_d - v) + feedforward, per joint.

    position_gain, velocity_gain: K_p, K_d                  () or (…, n)  [N m/rad or N/m, N m s/rad or N s/m]
    target: positions (n,), or a motion law per joint       [rad or m]
    feedforward: constant                                   () or (n,)  [N m or N]
    period: between two samples; the torque is held in between. None: every step, and with method "dop853" continuously
    """

    position_gain: ArrayLike
    velocity_gain: ArrayLike
    target: Target
    feedforward: ArrayLike = 0.0
    period: float | None = None

    law: ClassVar[Law] = "pd"


@dataclass(frozen=True, eq=False)
class ComputedTorqueControl:
    """The torque of the inverse dynamics at a_d + K_p (q_d - q) + K_d (v_d - v): each joint as a spring of its own.

    position_gain, velocity_gain: K_p, K_d                  () or (…, n)  [1/s², 1/s]
    target: positions (n,), or a motion law per joint       [rad or m]
    nominal: the robot as the controller knows it; the simulated one if left out. Its base is at rest
    period: as in PDControl
    """

    position_gain: ArrayLike
    velocity_gain: ArrayLike
    target: Target
    nominal: RobotModel | None = None
    period: float | None = None

    law: ClassVar[Law] = "computed_torque"


Controller = PDControl | ComputedTorqueControl


def reference(controller: Controller, model: RobotModel, times: Array) -> Array:
    """q_d, v_d, and a_d or the feedforward torque at these times (T, 3 n). Raises InvalidInput."""
    n = model.nv
    target = controller.target
    if isinstance(target, Sequence) and any(callable(law) for law in target):
        if len(target) != n or not all(callable(law) for law in target):
            raise InvalidInput(f"{len(target)} laws for the target of {n} joints; give one motion law per joint")
        laws: Sequence[MotionLaw] = target  # type: ignore[assignment]
        courses = np.array([[as_floats("target", part) for part in law(times)] for law in laws])  # (n, 3, T)
        columns = np.moveaxis(courses, -1, 0).swapaxes(1, 2)
    else:
        position = as_floats("target", target)  # type: ignore[arg-type]
        if position.shape != (n,):
            raise InvalidInput(f"target has shape {position.shape}, expected ({n},) for robot '{model.name}'")
        columns = np.zeros((len(times), 3, n))
        columns[:, 0] = position
    if isinstance(controller, PDControl):
        columns[:, 2] = as_floats("feedforward", controller.feedforward)
    if not np.all(np.isfinite(columns)):
        raise InvalidInput("the target of the controller contains NaN or infinity")
    return np.ascontiguousarray(columns).reshape(len(times), 3 * n)
