"""Limits of a motion, and the points and spheres of the robot that keep distances from planes and each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.equations.kinematics import joint_axes, link_origins, maximal_state
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import cross

Numbers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
@short_repr
class Sphere:
    """A sphere fixed in a body, 0 for the ground: center in its link frame (3,) [m], and radius [m]; 0 is a point."""

    body: int
    center: Array
    radius: float = 0.0


def frame_origins(model: RobotModel) -> tuple[Sphere, ...]:
    """The origins of all moving frames: bodies and the links that are fused into them, including tools."""
    origins = [(body, (0.0, 0.0, 0.0)) for body in range(1, model.n_bodies + 1)]
    origins += [(frame.body, tuple(frame.placement.translation.tolist())) for frame in model.frames if frame.body]
    return tuple(Sphere(body, np.array(center)) for body, center in dict.fromkeys(origins))


def sphere_around(spheres: Sequence[Sphere]) -> Sphere:
    """A sphere around spheres of one body."""
    centers = np.array([sphere.center for sphere in spheres])
    radii = np.array([sphere.radius for sphere in spheres])
    middle = (centers.max(axis=0) + centers.min(axis=0)) / 2
    return Sphere(spheres[0].body, middle, float(np.max(np.linalg.norm(centers - middle, axis=1) + radii)))


class Poses:
    """Poses of a robot's bodies at positions q (N, nv), and the joint forces of forces on spheres."""

    def __init__(self, model: RobotModel, q: Array) -> None:
        self._model = model
        self._state = maximal_state(model, q, method="recursive")
        self._origins = link_origins(self._state)
        self._centers: dict[tuple[Sphere, ...], Array] = {}

    def __len__(self) -> int:
        return len(self._origins)

    def of_body(self, body: int) -> tuple[Array, Array]:
        """Rotation (N, 3, 3) and origin of the link frame (N, 3) [m], world axes; of the ground for 0."""
        vertices = self._state.vertices
        origin = self._state.ground.position if body == 0 else self._origins[:, body - 1]  # type: ignore[union-attr]
        return vertices.rotation[:, body], origin

    def centers(self, spheres: tuple[Sphere, ...]) -> Array:
        """World positions of centers (N, spheres, 3) [m], computed once for the same spheres."""
        if spheres not in self._centers:
            self._centers[spheres] = self._computed(spheres)
        return self._centers[spheres]

    def _computed(self, spheres: tuple[Sphere, ...]) -> Array:
        carrying = np.array([sphere.body for sphere in spheres])
        local = np.array([sphere.center for sphere in spheres])
        found = np.empty((len(self._origins), len(spheres), 3))
        for body in np.unique(carrying).tolist():
            rotation, origin = self.of_body(body)
            mine = carrying == body
            found[:, mine] = local[mine] @ rotation.swapaxes(-1, -2) + origin[:, None]
        return found

    def joint_forces(self, rows: Numbers, bodies: Numbers, points: Array, forces: Array) -> Array:
        """Generalized forces (N, nv) of forces (K, 3) at points (K, 3) of bodies (K,) in the poses rows (K,).

        The generalized force is Jᵀ f: for a revolute joint the moment of all forces beyond it about its axis, for a
            prismatic
        joint their component along it. World axes [m].
        """
        model = self._model
        moments = cross(points[:, None] - self._origins[rows], forces[:, None])
        felt = np.where(self._is_revolute[:, None], moments, forces[:, None])
        along = (felt * self._axes[rows]).sum(axis=-1) * self._beyond[bodies]
        total = np.zeros((len(self), model.n_bodies))
        np.add.at(total, rows, along)
        return np.asarray(total @ model.degrees_of_freedom.matrix)

    @cached_property
    def _is_revolute(self) -> NDArray[np.bool_]:
        return np.array([not joint.is_prismatic for joint in self._model.joints])

    @cached_property
    def _axes(self) -> Array:
        """Axes of the joints (N, n, 3)."""
        return joint_axes(self._state)

    @cached_property
    def _beyond(self) -> Array:
        """Incidence: 1 in row i, column j if joint j carries body i; the ground is row 0 (n + 1, n)."""
        carried = self._model.graph.path_matrix().T.astype(float)
        return np.vstack([np.zeros(self._model.n_bodies), carried])


LIMIT_KINDS = ("position", "velocity", "acceleration", "jerk", "torque")


@dataclass(frozen=True, eq=False)
@short_repr
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
@short_repr
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
@short_repr
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
                raise InvalidInput(f"joint '{joint}' has no limit of velocity; give velocity=, or --velocity")


def share_of(stated: float | None, share: float) -> float:
    """A fraction of a stated limit; infinite if none is stated."""
    return np.inf if stated is None or stated <= 0 else share * stated


def _each(name: str, given: ArrayLike | None, stated: list[float], n: int) -> Array:
    array = np.array(stated) if given is None else as_floats(name, given)
    if array.shape not in ((), (n,)):
        raise InvalidInput(f"{name} has shape {array.shape}; give one number, or {n}")
    return np.array(np.broadcast_to(array, (n,)))
