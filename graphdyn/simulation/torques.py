"""Sources of the torque of a simulation: a function, numbers that are held, or a controller.

Controllers that are given by gains run inside compiled steps, which a Python function cannot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.simulated import Law
from graphdyn.display import short_repr
from graphdyn.errors import IntegrationFailed, InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.motion_laws import MotionLaw
from graphdyn.simulation.equations import answer
from graphdyn.simulation.plant import finite, per_joint, refuse_loops
from graphdyn.verbs.compiled import compile as compiled
from graphdyn.verbs.single_state import OfMotion, SingleState

Target = ArrayLike | Sequence[MotionLaw]


@dataclass(frozen=True, eq=False)
@short_repr
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
@short_repr
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


TorqueFunction = Callable[[float, Array, Array], ArrayLike]

SMALLER_STEPS_REMEDY = "take smaller steps, or smaller torques"

QUOTIENT_TOLERANCE = 1e-9
"""A step divides a time if the quotient is this close to a whole number, relative to it."""

CONSTANT_TORQUE_STEPS = 1 << 62
"""Steps for which a constant torque is held."""


@dataclass(frozen=True, eq=False)
class Torques:
    """One of: a function of t, q and v; values (K, n), each held for a K-th of the duration; a controller."""

    model: RobotModel
    duration: float
    function: TorqueFunction | None = None
    values: Array | None = None
    controller: Controller | None = None

    @property
    def period(self) -> float | None:
        """How long a torque is held [s]; None where it follows the state at every instant, or never changes."""
        if self.values is not None and len(self.values) > 1:
            return self.duration / len(self.values)
        return self.controller.period if self.controller else None

    def steps_held(self, step: float, steps: int) -> int:
        """The number of fixed steps a torque is held. Raises InvalidInput where it is no whole number."""
        if self.values is not None:
            if len(self.values) == 1:
                return CONSTANT_TORQUE_STEPS
            if steps % len(self.values):
                raise InvalidInput(
                    f"{len(self.values)} torques for {steps} steps; give a number of rows that divides the steps"
                )
            return steps // len(self.values)
        return 1 if self.period is None else whole_steps("the period of the controller", self.period, step)

    def tau_at(self, t: float, q: Array, v: Array) -> Array:
        """The torque at an instant (n,), where it is not held for a while."""
        t = min(t, self.duration)
        if not (np.all(np.isfinite(q)) and np.all(np.isfinite(v))):
            raise IntegrationFailed(f"at {t:g} s the numbers are no longer finite; {SMALLER_STEPS_REMEDY}")
        if self.function is not None:
            return answer("torque", self.function(t, q.copy(), v.copy()), (self.model.nv,), t)
        return self.values[0] if self.values is not None else self._law(t, q, v)

    def tau_from(self, time: float, q: Array, v: Array) -> Array:
        """The torque that is held from a time on (n,), of the state then."""
        if self.values is not None:
            row = int(time / self.duration * len(self.values) + QUOTIENT_TOLERANCE)
            return np.asarray(self.values[min(row, len(self.values) - 1)])
        return self._law(time, q, v)

    def columns(self, first: int, count: int, period: float) -> Array:
        """Columns of compiled steps: the values or references of the ticks first … first + count - 1 (count, n or 3
        n)."""
        ticks = np.arange(first, first + count)
        if self.values is not None:
            return np.asarray(self.values[np.minimum(ticks, len(self.values) - 1)])
        assert self.controller is not None
        return reference(self.controller, self.model, np.minimum(ticks * period, self.duration))

    @cached_property
    def gains(self) -> Array | None:
        """K_p and K_d of the controller (2 n,)."""
        if self.controller is None:
            return None
        return np.concatenate([per_joint(name, getattr(self.controller, name), self.model) for name in GAIN_NAMES])

    @cached_property
    def _believed(self) -> SingleState[OfMotion]:
        """The joint torques of the robot that the controller believes in."""
        return compiled(getattr(self.controller, "nominal", None) or self.model).joint_torques

    def _law(self, t: float, q: Array, v: Array) -> Array:
        controller, n = self.controller, self.model.nv
        assert controller is not None
        assert self.gains is not None
        wanted, rate, further = reference(controller, self.model, np.array([min(t, self.duration)])).reshape(3, n)
        sought = further + self.gains[:n] * (wanted - q) + self.gains[n:] * (rate - v)
        if isinstance(controller, PDControl):
            return sought
        return self._believed(q, v, sought).copy()


GAIN_NAMES = ("position_gain", "velocity_gain")


def torques(torque: TorqueFunction | Controller | ArrayLike | None, model: RobotModel, duration: float) -> Torques:
    """The argument torque, checked. Raises InvalidInput."""
    if torque is None:
        return Torques(model, duration, values=np.zeros((1, model.nv)))
    if isinstance(torque, Controller):
        check_controller(torque, model)
        return Torques(model, duration, controller=torque)
    if callable(torque):
        return Torques(model, duration, function=torque)
    values = np.atleast_2d(finite("torque", as_floats("torque", torque)))
    if values.ndim != 2 or values.shape[1] != model.nv or len(values) == 0:
        raise InvalidInput(
            f"torque has shape {np.shape(torque)}, expected ({model.nv},) or (K, {model.nv}) for robot '{model.name}'"
        )
    return Torques(model, duration, values=values)


def check_controller(controller: Controller, model: RobotModel) -> None:
    """Raises InvalidInput for gains, a target, a period or a model that do not fit."""
    for name in GAIN_NAMES:
        finite(name, getattr(controller, name))
    if controller.period is not None and not (controller.period > 0 and np.isfinite(controller.period)):
        raise InvalidInput(f"period is {controller.period!r}; give seconds above zero, or None for every step")
    if isinstance(controller, ComputedTorqueControl):
        believed = model if controller.nominal is None else controller.nominal
        check_model(believed)
        for robot in (model, believed):
            refuse_loops("ComputedTorqueControl", robot, "give PDControl, or a function of t, q and v")
        if believed.nv != model.nv:
            known = f"'{model.name}' {model.nv}"
            raise InvalidInput(f"the nominal robot of the controller has {believed.nv} joints, {known}")
    reference(controller, model, np.zeros(1))


def whole_steps(what: str, time: float, step: float) -> int:
    """How many steps a time lasts. Raises InvalidInput where that is no whole number."""
    steps = round(time / step)
    if steps < 1 or abs(time / step - steps) > QUOTIENT_TOLERANCE * steps:
        raise InvalidInput(f"{what}, {time:g} s, is no multiple of the step, {step:g} s; choose a step that divides it")
    return steps
