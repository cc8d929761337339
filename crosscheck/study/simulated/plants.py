"""The robot of a study as it is, its controller, and what the identification believes of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import urdf
from crosscheck.identifying.virtual import as_in_cad
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.design import Stream
from crosscheck.study.settings.settings import BadConfiguration, Numbers, RobotSettings
from graphdyn import (
    Friction,
    InvalidInput,
    PDControl,
    RobotModel,
    mass_matrix,
)
from graphdyn.errors import counted
from graphdyn.excitation import MotionLimits
from graphdyn.identification import TorqueModel
from graphdyn.identification.terms import Coulomb, RigidBodies, RotorInertia, Term, Viscous
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model import pseudo_inertia_from_parameters
from graphdyn.motion_laws import MotionLaw

CONTROLLER_FREQUENCY, CONTROLLER_DAMPING = 30.0, 1.0
"""Frequency of the position loop where no gains are given [rad/s], and its damping ratio."""


@dataclass(frozen=True, eq=False)
class ControlledRobot:
    """A robot with drives, the gains of its controller, and the limits of its motions; arrays (n,).

    velocity_noise: that the controller sees [rad/s or m/s]
    """

    model: RobotModel
    friction: Friction
    rotors: Array
    position_gain: Array
    velocity_gain: Array
    velocity_noise: float
    limits: MotionLimits

    @cached_property
    def drives(self) -> tuple[Term, ...]:
        """The terms of those drives that the robot has."""
        there = {Viscous: self.friction.viscous, Coulomb: self.friction.coulomb, RotorInertia: self.rotors}
        return tuple(kind() for kind, values in there.items() if np.any(values))

    @cached_property
    def known_exactly(self) -> TorqueModel:
        """The torque model of the robot as it is."""
        return TorqueModel(self.model, (RigidBodies(), *self.drives))

    def controller(self, laws: Sequence[MotionLaw], period: float) -> PDControl:
        """The loop that follows the laws."""
        return PDControl(self.position_gain, self.velocity_gain, list(laws), period=period)

    def truth(self, torque_model: TorqueModel) -> Array:
        """The parameters (p,) of a torque model of `torque_model`."""
        drives = {Viscous: self.friction.viscous, Coulomb: self.friction.coulomb, RotorInertia: self.rotors}
        parts = [
            self.model.inertial_parameters if isinstance(term, RigidBodies) else np.asarray(drives[type(term)])
            for term in torque_model.terms
        ]
        return np.concatenate(parts)


@lru_cache(maxsize=8)
def plant_of(settings: RobotSettings) -> ControlledRobot:
    """Raises BadConfiguration for numbers that are not of this robot, and for loops; urdf's errors."""
    model = urdf.load(settings.name, reading=settings.reading)
    if model.chords or model.couplings:
        what = "loops" if model.chords else "joints that drive others"
        raise BadConfiguration(
            f"{settings.file}: robot '{settings.name}' has {what}, which a study does not simulate; lock them (locked "
            "in [robot]), or name another robot"
        )

    def each(name: str, value: Numbers) -> Array:
        array = np.asarray(value, dtype=float)
        if array.shape not in ((), (model.nv,)):
            raise BadConfiguration(
                f"{settings.file}: {name} in [robot] has {counted(array.size, 'number')}; robot '{settings.name}' has "
                f"{counted(model.nv, 'joint')}: {', '.join(model.independent_joints)}"
            )
        return np.array(np.broadcast_to(array, (model.nv,)))

    rotors = each("rotor_inertia", settings.rotor_inertia)
    inertia = np.diag(mass_matrix(model, np.zeros(model.nv), method="reproducible")) + rotors
    stiff, damped = CONTROLLER_FREQUENCY**2 * inertia, 2 * CONTROLLER_DAMPING * CONTROLLER_FREQUENCY * inertia
    if settings.position_gain is not None and settings.velocity_gain is not None:
        stiff, damped = each("position_gain", settings.position_gain), each("velocity_gain", settings.velocity_gain)
    bounds: dict[str, Any] = {
        name: each(name, value)
        for name in ("lower", "upper", "velocity", "acceleration")
        if (value := getattr(settings, name)) is not None
    }
    try:
        limits = MotionLimits.of_model(model, **bounds)
    except InvalidInput as error:
        raise BadConfiguration(f"{settings.file}: limits in [robot]: {error}") from None
    return ControlledRobot(
        model,
        Friction(each("viscous", settings.viscous), each("coulomb", settings.coulomb)),
        rotors,
        stiff,
        damped,
        settings.velocity_noise,
        limits,
    )


def refuse_unfit(study: Configuration) -> None:
    """Raise BadConfiguration for settings, or errors of the model, that do not fit a robot; urdf's errors."""
    for robot in study.robots:
        joints = plant_of(robot).model.nv
        for name, value in vars(study.errors).items():
            if isinstance(value, tuple) and name != "payload_center" and len(value) != joints:
                raise BadConfiguration(
                    f"{study.file}: {name} in [errors] has {counted(len(value), 'number')}; robot '{robot.name}' has "
                    f"{counted(joints, 'joint')}: give one for all joints, or one each"
                )


CAD_STREAM, START_STREAM = 1, 4
"""Numbers of the random streams of a study."""


@lru_cache(maxsize=8)
def torque_model_of(
    settings: RobotSettings, seed: int, cad_error: float, dry_friction: bool, stream: Stream = (0, 0)
) -> TorqueModel:
    """What the identification knows: a CAD model that is off, and the terms of the drives.

    seed: of the study; dry_friction: whether it is among the terms; stream: which errors of the CAD model
    """
    plant = plant_of(settings)
    model, drives = plant.model, plant.drives
    if cad_error:
        model = as_in_cad(model, generator(seed, CAD_STREAM, *stream), cad_error)
    return TorqueModel(model, (RigidBodies(), *(one for one in drives if dry_friction or not isinstance(one, Coulomb))))


def start_near_truth(
    plant: ControlledRobot, torque_model: TorqueModel, seed: int, error: float, stream: Stream
) -> Array:
    """Parameters (p,) of a robot that could be real. Every parameter is off by its own normal error.

    seed: of the study; error: standard deviation of the relative errors; stream: which of them

    The parameters of a body are drawn again until it could be real, drives until they take power: so do Leboutet et al.
    (2021). Raises InvalidInput for a body of which hardly any draw could be real.
    """
    rng = generator(seed, START_STREAM, *stream)
    bodies = plant.model.inertial_parameters.reshape(-1, BODY_PARAMETERS)
    near = [_body_near(body, error, rng, plant.model.bodies[k].name) for k, body in enumerate(bodies)]

    def off(values: ArrayLike) -> Array:
        return np.abs(np.asarray(values, dtype=float) * (1 + error * rng.standard_normal(np.shape(values))))

    friction = Friction(off(plant.friction.viscous), off(plant.friction.coulomb))
    model = plant.model.with_inertial_parameters(np.concatenate(near))
    return replace(plant, model=model, friction=friction, rotors=off(plant.rotors)).truth(torque_model)


START_DRAWS = 100_000
"""Draws of the parameters of one body, of which one must be real."""


def _body_near(body: Array, error: float, rng: np.random.Generator, name: str) -> Array:
    """Parameters (10,) of a body that could be real, beside those of another."""
    for _number in range(START_DRAWS // 1000):
        drawn = body * (1 + error * rng.standard_normal((1000, BODY_PARAMETERS)))
        real = np.linalg.eigvalsh(pseudo_inertia_from_parameters(drawn))[:, 0] > 0
        if real.any():
            return np.asarray(drawn[np.argmax(real)])
    raise InvalidInput(
        f"start = {error:g} in the configuration: of {START_DRAWS} bodies near '{name}', none could be real; give a "
        "smaller number"
    )


def generator(*entropy: int) -> np.random.Generator:
    """The random numbers of one stream of a study. entropy: its seed, numbers of the stream"""
    return np.random.default_rng(np.random.SeedSequence(entropy))
