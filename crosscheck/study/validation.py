"""How far the parameters that a method finds are from the truth: as numbers, in the torque, and in the simulated loop.

All on a motion that no method has seen, the same for all scenarios of a run, without noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from crosscheck.study.settings.design import Stream
from crosscheck.study.settings.settings import RobotSettings
from crosscheck.study.simulated.motions import reference, start_of
from crosscheck.study.simulated.plants import ControlledRobot, plant_of
from graphdyn import Friction, InvalidInput, rollout
from graphdyn.identification import BaseParameters, Samples, TorqueModel, structure
from graphdyn.identification.closed_loop import DrivenRobot
from graphdyn.layout import Array
from graphdyn.motion_laws import MotionLaw

VALIDATION_SECONDS, VALIDATION_RATE = 10.0, 100.0
"""Length of the held-out motion [s], and samples per second of its torque [Hz]."""

LOOP_RATE = 1000.0
"""Rate of controller and steps of the simulated loop [Hz]."""

MAX_DISTANCE_RATIO = 100.0
"""A robot that is so many times as far from where it should be as it ever goes has run away."""

HELD_OUT_SCENARIO = 2**32 - 1
"""Number of the random motion that is held out: scenarios count theirs from zero."""


@dataclass(frozen=True, eq=False)
class ValidationMetric:
    """The held-out motion of a torque model.

    base: what any motion could determine, b parameters
    truth: base parameters (b,)
    regressor: of the base parameters, all rows   (N n, b)
    torque: of the robot as it is   (N n,)
    followed: positions of the simulated loop of the robot as it is   (K, n)
    """

    plant: ControlledRobot
    torque_model: TorqueModel
    laws: tuple[MotionLaw, ...]
    base: BaseParameters
    truth: Array
    regressor: Array
    torque: Array
    followed: Array

    def parameter_error(self, x: Array) -> float:
        """‖D (x - x*)‖ / ‖D x*‖ of base parameters x (b,), with the lengths D of the columns of the regressor."""
        effect = np.linalg.norm(self.regressor, axis=0)
        return float(np.linalg.norm(effect * (x - self.truth)) / np.linalg.norm(effect * self.truth))

    def torque_error(self, x: Array) -> float:
        """‖W x - τ‖ / ‖τ‖, τ the torque of the robot as it is, with what the torque model does not know."""
        return float(np.linalg.norm(self.regressor @ x - self.torque) / np.linalg.norm(self.torque))

    def trajectory_error(self, x: Array) -> float | None:
        """‖q(x) - q*‖ / ‖q* - mean of q*‖ of the loop simulated with base parameters x; None where it runs away."""
        alone = np.zeros(len(self.torque_model.columns))
        alone[self.base.independent] = x
        robot = DrivenRobot.of(self.torque_model, alone[None])
        q = _followed(self.plant, self.laws, robot.bodies[0], robot.friction, robot.rotors[0])
        spread = self.followed - self.followed.mean(axis=0)
        error = float(np.linalg.norm(q - self.followed) / np.linalg.norm(spread))
        return error if error < MAX_DISTANCE_RATIO else None


@lru_cache(maxsize=8)
def validation_metric(
    settings: RobotSettings, seed: int, torque_model: TorqueModel, stream: Stream = (0, 0)
) -> ValidationMetric:
    """seed: of the study; stream: which motion. Raises InvalidInput where the controller does not hold the robot."""
    plant = plant_of(settings)
    laws = reference(settings, seed, "random", HELD_OUT_SCENARIO, VALIDATION_SECONDS, stream)
    times = np.arange(round(VALIDATION_SECONDS * VALIDATION_RATE) + 1) / VALIDATION_RATE
    q, v, a = np.moveaxis(np.array([law(times) for law in laws]), 0, -1)
    samples = Samples(q, v, a, np.zeros_like(q), time=times)
    base = structure(torque_model).base
    truth = base.values(plant.truth(torque_model))
    regressor = torque_model.rows(samples, base.independent).reshape(-1, base.rank)
    everything = plant.known_exactly
    torque = everything.torque(samples, plant.truth(everything)).ravel()
    followed = _followed(plant, laws, plant.model.inertial_parameters, plant.friction, plant.rotors)
    if not np.all(np.isfinite(followed)):
        raise InvalidInput("the controller does not hold the robot on the held-out motion; give other gains")
    return ValidationMetric(plant, torque_model, laws, base, truth, regressor, torque, followed)


def _followed(
    plant: ControlledRobot, laws: tuple[MotionLaw, ...], bodies: Array, friction: Friction, rotors: Array
) -> Array:
    """Positions of the simulated loop without noise (K, n)."""
    controller = plant.controller(laws, 1 / LOOP_RATE)
    q, v = start_of(laws)
    found = rollout(
        plant.model,
        q,
        v,
        controller,
        step=1 / LOOP_RATE,
        duration=VALIDATION_SECONDS,
        parameters=bodies,
        friction=friction,
        rotor_inertia=rotors,
        every=round(LOOP_RATE / VALIDATION_RATE),
        threads=1,
    )
    return np.asarray(found.q[0])
