"""What is shown: robots with their shapes, at rest or in a recorded motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn import Body, RobotModel
from graphdyn.layout import Array

SECOND_MOMENT_TOLERANCE = 1e-9
"""Part of the largest second moment below which a negative one is rounding."""


@dataclass(frozen=True, eq=False)
class BodyShape:
    """Triangles of one color that move with a body; body 0 is the ground.

    vertices: in link axes of the body                      (k, 3)  [m]
    faces: numbers of the vertices of each triangle         (m, 3)
    color: red, green, blue, opacity, from 0 to 1
    """

    body: int
    vertices: Array
    faces: NDArray[np.intp]
    color: tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class LoadedMotion:
    """A motion at N times, and its loads.

    time: increasing                                        (N,)           [s]
    q: of the independent joints                            (N, nv)  [rad or m]
    joint_wrenches: of the inside body on body j, at O_j, in link axes of j   (N, n, 6)  [N, N m]
    tau: of the rigid bodies, from these joint wrenches      (N, nv)  [N m or N]
    recorded_tau: as recorded, None where it was not        (N, nv)  [N m or N]
    """

    time: Array
    q: Array
    joint_wrenches: Array
    tau: Array
    recorded_tau: Array | None = None


@dataclass(frozen=True, eq=False)
class ShownRobot:
    """A robot and its shapes; one of them may be in several figures.

    notes: what its viewer should know
    collision: shapes that are shown on demand, none where the file states none
    """

    model: RobotModel
    shapes: tuple[BodyShape, ...]
    notes: tuple[str, ...] = ()
    collision: tuple[BodyShape, ...] = ()


@dataclass(frozen=True, eq=False)
class Figure:
    """A robot on the stage, under a name.

    motion: None where it only stands; notes: on the motion
    start: where it stands without a motion (nv,), standing_position if None [rad or m]
    """

    name: str
    robot: ShownRobot
    motion: LoadedMotion | None = None
    notes: tuple[str, ...] = ()
    start: Array | None = None

    @property
    def first(self) -> Array:
        """q (nv,) before anything is moved [rad or m]."""
        if self.motion is not None:
            return np.asarray(self.motion.q[0])
        return standing_position(self.robot.model) if self.start is None else self.start


def standing_position(model: RobotModel) -> Array:
    """q (nv,) of a robot without a motion: zero, or the nearest position within limits; loops are closed.

    Raises InconsistentState where no pose closes them.
    """
    if model.chords:
        return model.closed_pose
    limits = [model.joints[k].limits for k in model.degrees_of_freedom.independent]
    lower = [-np.inf if limit.lower is None else limit.lower for limit in limits]
    upper = [np.inf if limit.upper is None else limit.upper for limit in limits]
    return np.clip(np.zeros(model.nv), lower, upper)


def inertia_ellipsoid(body: Body) -> tuple[Array, Array] | None:
    """Half axes (3,) [m] and their directions, columns (3, 3), of the homogeneous ellipsoid with mass and inertia.

    With the second moments Σ = (tr J / 2) E - J of the body, an ellipsoid of half axes a has Σ = m diag(a²) / 5. None
    where a moment is negative, which no real body has, and for bodies without mass.
    """
    if body.mass == 0:
        return None
    moments, directions = np.linalg.eigh(np.trace(body.inertia) / 2 * np.eye(3) - body.inertia)
    if moments[0] < -SECOND_MOMENT_TOLERANCE * np.abs(moments).max():
        return None
    directions[:, 0] *= np.sign(np.linalg.det(directions))
    return np.sqrt(5 * np.maximum(moments, 0.0) / body.mass), directions
