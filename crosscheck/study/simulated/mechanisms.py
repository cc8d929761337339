"""What is simulated of a robot: rigid joints, springs between motors and links, or dry friction of bristles."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from crosscheck.study.settings.settings import ErrorSettings, Numbers
from crosscheck.study.simulated.plants import ControlledRobot
from graphdyn import (
    Body,
    Bristles,
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
from graphdyn.identification.closed_loop import MAX_SIMULATION_STEP
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.motion_laws import Locked

MAX_STABLE_STEP = 1.0
"""Largest product of the width of a step and the fastest eigenvalue: rk4 is stable up to 2.8."""


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A robot of n joints as it is simulated, with m = n or, where they are flexible, m = 2 n joints.

    friction, rotors: of the m joints; springs: of flexible ones; bristles: in place of dry friction
    longest_step: of the simulation [s]
    flexible: motors are every other joint, each followed by its spring
    """

    model: RobotModel
    friction: Friction
    rotors: Array
    springs: JointStops | None
    longest_step: float
    flexible: bool
    bristles: Bristles | None = None

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


def mechanism_of(plant: ControlledRobot, errors: ErrorSettings, model_error: str) -> Mechanism:
    """The mechanism of a scenario with this error of the model."""
    if model_error == "flexible":
        return flexible(plant, errors)
    if model_error in ("stribeck", "lugre"):
        return bristly(plant, errors, errors.presliding if model_error == "lugre" else STIFF_PRESLIDING)
    return rigid(plant)


def rigid(plant: ControlledRobot) -> Mechanism:
    return Mechanism(plant.model, plant.friction, plant.rotors, None, MAX_SIMULATION_STEP, False)


STIFF_PRESLIDING = 1e-5
"""Deflection of bristles that leave nothing but the Stribeck curve [rad or m]."""


def bristly(plant: ControlledRobot, errors: ErrorSettings, presliding: Numbers) -> Mechanism:
    """Dry friction with a breakaway torque, of bristles that a deflection bends to the torque of Coulomb friction."""
    dry = np.asarray(plant.friction.coulomb)
    stiffness = dry / np.asarray(presliding)
    inertia = np.diag(mass_matrix(plant.model, np.zeros(plant.model.nv), method="reproducible")) + plant.rotors
    damping = np.sqrt(stiffness * inertia)  # half the critical one
    bristles = Bristles(dry, errors.breakaway * dry, errors.stribeck_velocity, stiffness, damping)
    return replace(rigid(plant), friction=Friction(plant.friction.viscous), bristles=bristles)


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
    name = f"{model.name}, flexible"
    return RobotModel(name, tuple(bodies), tuple(joints), gravity=model.gravity, base=model.base)


def _alternating(motors: ArrayLike, springs: ArrayLike | None = None) -> Array:
    values = np.asarray(motors, dtype=float)
    return np.stack([values, np.zeros_like(values) if springs is None else springs], axis=-1).ravel()
