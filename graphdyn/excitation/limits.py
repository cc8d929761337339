"""Limits of a motion."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.excitation.bounding_spheres import Sphere, sphere_around
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

LIMIT_KINDS = ("position", "velocity", "acceleration", "jerk", "torque")


@dataclass(frozen=True, eq=False)
class Plane:
    """Half-space normal · p ≥ distance for all checked spheres; in world axes, normalized here. [-, m]"""

    normal: ArrayLike
    distance: float = 0.0

    def __post_init__(self) -> None:
        normal = as_floats("normal of the plane", self.normal)
        length = np.linalg.norm(normal)
        if normal.shape != (3,) or not np.isfinite(length) or not length or not np.isfinite(self.distance):
            raise InvalidInput(
                f"a plane has normal {normal.tolist()} and distance {self.distance}; give three finite numbers, not "
                "all zero, and a finite distance"
            )
        object.__setattr__(self, "normal", normal / length)


@dataclass(frozen=True, eq=False)
class Clearance:
    """Smallest distance between the surfaces of two bodies' bounding spheres.

    name: of the two, such as "forearm - wrist_2"
    one, other: spheres of one body each
    distance: if negative, spheres may overlap by that much  [m]
    """

    name: str
    one: tuple[Sphere, ...]
    other: tuple[Sphere, ...]
    distance: float = 0.0

    def __post_init__(self) -> None:
        bodies = [{sphere.body for sphere in spheres} for spheres in (self.one, self.other)]
        if any(len(numbers) != 1 for numbers in bodies) or not np.isfinite(self.distance):
            raise InvalidInput(
                f"the clearance '{self.name}' has spheres of the bodies {bodies[0] or '{}'} and {bodies[1] or '{}'} "
                f"and the distance {self.distance}; give spheres of one body each, and a finite distance"
            )

    @cached_property
    def around(self) -> tuple[Sphere, Sphere]:
        """A sphere around all spheres of one, and one around those of the other."""
        return sphere_around(self.one), sphere_around(self.other)


@dataclass(frozen=True, eq=False)
class MotionLimits:
    """Limits of the n joints of a robot, including those that others drive; infinite if there is none.

    lower, upper: positions                                  (n,)  [rad or m]
    velocity, acceleration, jerk: largest sizes              (n,)  […/s, …/s², …/s³]
    torque: largest sizes, of the independent joints         (nv,)  [N m or N]
    planes: of the workspace
    clearances: between parts of the robot
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    torque: Array
    planes: tuple[Plane, ...] = field(default=())
    clearances: tuple[Clearance, ...] = field(default=())

    @classmethod
    def of_model(
        cls,
        model: RobotModel,
        *,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike = np.inf,
        jerk: ArrayLike = np.inf,
        torque: ArrayLike | None = None,
        velocity_share: float = 1.0,
        torque_share: float = 1.0,
        planes: tuple[Plane, ...] = (),
    ) -> MotionLimits:
        """The limits that the model states, or those given instead: one number for all joints, or one for each.

        velocity_share, torque_share: usable fraction of the model's limits; not of those given
        A velocity or an effort of zero or less in the model counts as not stated.

        Raises InvalidInput if a joint has no limit of velocity, and for limits that leave no motion.
        """
        stated = [joint.limits for joint in model.joints]
        speeds = [share_of(x.velocity, velocity_share) for x in stated]
        efforts = [share_of(model.joints[k].limits.effort, torque_share) for k in model.degrees_of_freedom.independent]
        n, free = model.n_bodies, model.nv
        limits = cls(
            _each("lower limit", lower, [-np.inf if x.lower is None else x.lower for x in stated], n),
            _each("upper limit", upper, [np.inf if x.upper is None else x.upper for x in stated], n),
            _each("limit of velocity", velocity, speeds, n),
            _each("limit of acceleration", acceleration, [], n),
            _each("limit of jerk", jerk, [], n),
            _each("limit of torque", torque, efforts, free),
            planes,
        )
        limits._check(model)
        return limits

    def _check(self, model: RobotModel) -> None:
        for name, array in (("velocity", self.velocity), ("acceleration", self.acceleration), ("jerk", self.jerk)):
            if not np.all(array > 0):
                raise InvalidInput(f"a limit of {name} is {array.min():g}; give numbers above zero")
        if not np.all(self.torque > 0):
            raise InvalidInput(f"a limit of torque is {self.torque.min():g}; give numbers above zero")
        for joint, lower, upper, speed in zip(model.joint_names, self.lower, self.upper, self.velocity, strict=True):
            if not lower < upper:
                raise InvalidInput(
                    f"joint '{joint}' may move from {lower:g} to {upper:g}; lock it, or give other limits"
                )
            if not np.isfinite(speed):
                raise InvalidInput(f"joint '{joint}' has no limit of velocity; give one")


def share_of(stated: float | None, share: float) -> float:
    """A fraction of a stated limit; infinite if none is stated."""
    return np.inf if stated is None or stated <= 0 else share * stated


def _each(name: str, given: ArrayLike | None, stated: list[float], n: int) -> Array:
    array = np.array(stated) if given is None else as_floats(name, given)
    if array.shape not in ((), (n,)) or np.isnan(array).any():
        raise InvalidInput(f"{name} has shape {array.shape}; give one number, or {n}")
    return np.array(np.broadcast_to(array, (n,)))
