"""The robot of a study as it is, its controller, what is simulated of it, and what the identification believes of it.

Simulated is the robot with rigid joints, or with a spring between motor and link in each of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import urdf
from crosscheck.identifying.virtual import as_in_cad
from crosscheck.study.settings.design import Stream
from crosscheck.study.settings.settings import BadConfiguration, ErrorSettings, Numbers, RobotSettings
from graphdyn import (
    Body,
    Friction,
    InvalidInput,
    Joint,
    JointLimits,
    JointStops,
    PDControl,
    Placement,
    RobotModel,
    mass_matrix,
)
from graphdyn.errors import counted
from graphdyn.excitation import MotionLimits
from graphdyn.identification import TorqueModel
from graphdyn.identification.closed_loop import MAX_SIMULATION_STEP
from graphdyn.identification.terms import Coulomb, RigidBodies, RotorInertia, Term, Viscous
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.motion_laws import Locked, MotionLaw

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


@lru_cache(maxsize=1)
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
    """Parameters (p,) of a robot that could be real: masses, centers of mass and drives are off by `error` at most.

    seed: of the study; stream: which of them
    """
    rng = generator(seed, START_STREAM, *stream)

    def off(values: ArrayLike) -> Array:
        return np.asarray(np.asarray(values) * rng.uniform(1 - error, 1 + error, np.shape(values)), dtype=float)

    model = as_in_cad(plant.model, rng, error)
    friction = Friction(off(plant.friction.viscous), off(plant.friction.coulomb))
    return replace(plant, model=model, friction=friction, rotors=off(plant.rotors)).truth(torque_model)


def generator(*entropy: int) -> np.random.Generator:
    """The random numbers of one stream of a study. entropy: its seed, numbers of the stream"""
    return np.random.default_rng(np.random.SeedSequence(entropy))


MAX_STABLE_STEP = 1.0
"""Largest product of the width of a step and the fastest eigenvalue: rk4 is stable up to 2.8."""


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A robot of n joints as it is simulated, with m = n or, where they are flexible, m = 2 n joints.

    friction, rotors: of the m joints; springs: of flexible ones
    longest_step: of the simulation [s]
    flexible: motors are every other joint, each followed by its spring
    """

    model: RobotModel
    friction: Friction
    rotors: Array
    springs: JointStops | None
    longest_step: float
    flexible: bool

    def of_motors(self, values: ArrayLike) -> Array:
        """(n,), or one number for all, as (m,): zero for springs."""
        n = self.model.nv
        if not self.flexible:
            return np.array(np.broadcast_to(values, n), dtype=float)
        return _alternating(np.broadcast_to(np.asarray(values, dtype=float), n // 2))

    def motors(self, values: Array) -> Array:
        """(N, n) of (N, m): of the motors."""
        return values[:, ::2] if self.flexible else values

    def links(self, values: Array) -> Array:
        """(N, n) of (N, m): of the links, which motors and springs move together."""
        return values[:, ::2] + values[:, 1::2] if self.flexible else values

    def parameters(self, inertial: Array) -> Array:
        """Inertial parameters (10 m,) from those of the links (10 n,)."""
        if not self.flexible:
            return inertial
        bodies = inertial.reshape(-1, BODY_PARAMETERS)
        return np.stack([np.zeros_like(bodies), bodies], axis=1).ravel()

    def controlled(self, controller: PDControl) -> PDControl:
        """The controller, which knows nothing of springs."""
        if not self.flexible:
            return controller
        gains = {name: self.of_motors(getattr(controller, name)) for name in ("position_gain", "velocity_gain")}
        target = [law for motor in controller.target for law in (motor, Locked())]  # type: ignore[union-attr]
        return replace(controller, **gains, target=target)  # type: ignore[arg-type]


def rigid(plant: ControlledRobot) -> Mechanism:
    return Mechanism(plant.model, plant.friction, plant.rotors, None, MAX_SIMULATION_STEP, False)


def flexible(plant: ControlledRobot, errors: ErrorSettings) -> Mechanism:
    """Friction and rotors are those of the motors, whose bodies have no mass beside.

    Spong, "Modeling and control of elastic joint robots", Journal of Dynamic Systems, Measurement, and Control 109(4),
    1987. Raises InvalidInput for a joint without rotor inertia: nothing would move between motor and spring.
    """
    names = plant.model.joint_names
    if not np.all(plant.rotors > 0):
        joint = names[int(np.argmin(plant.rotors))]
        raise InvalidInput(f"flexible joints need a rotor_inertia in [robot] above zero; that of '{joint}' is zero")
    n = plant.model.nv
    stiffness = np.broadcast_to(np.asarray(errors.joint_stiffness, dtype=float), n)
    inertia = mass_matrix(plant.model, np.zeros(n), method="reproducible")
    share = np.broadcast_to(np.asarray(errors.joint_damping, dtype=float), n)
    damping = 2 * share * np.sqrt(stiffness * np.diag(inertia))
    springs = JointStops(_alternating(np.zeros(n), stiffness), _alternating(np.zeros(n), damping))
    friction = Friction(_alternating(plant.friction.viscous), _alternating(plant.friction.coulomb))
    step = min(MAX_SIMULATION_STEP, MAX_STABLE_STEP / _fastest(inertia, plant.rotors, stiffness, damping))
    return Mechanism(_with_springs(plant.model), friction, _alternating(plant.rotors), springs, step, True)


def _fastest(inertia: Array, rotors: Array, stiffness: Array, damping: Array) -> float:
    """Largest size of an eigenvalue of δ'' = -(M⁻¹ + J⁻¹) (K δ + D δ') of springs between rotors and links [1/s]."""
    n = len(rotors)
    moved = np.linalg.inv(inertia) + np.diag(1 / rotors)
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-moved * stiffness, -moved * damping]])
    return float(np.abs(np.linalg.eigvals(system)).max())


def _with_springs(model: RobotModel) -> RobotModel:
    """Each link behind a second joint about the same axis, whose limits are zero."""
    bodies, joints = list[Body](), list[Joint]()
    for body, joint in zip(model.bodies, model.joints, strict=True):
        bodies += [Body(f"{body.name} motor", 0.0, np.zeros(3), np.zeros((3, 3))), body]
        joints += [
            replace(joint, inside=2 * joint.inside, limits=JointLimits()),
            Joint(
                f"{joint.name} spring",
                "prismatic" if joint.is_prismatic else "revolute",
                len(bodies) - 1,
                Placement(np.eye(3), np.zeros(3)),
                joint.axis,
                JointLimits(0.0, 0.0),
            ),
        ]
    return RobotModel(f"{model.name}, flexible", tuple(bodies), tuple(joints), gravity=model.gravity)


def _alternating(motors: ArrayLike, springs: ArrayLike | None = None) -> Array:
    values = np.asarray(motors, dtype=float)
    return np.stack([values, np.zeros_like(values) if springs is None else springs], axis=-1).ravel()
