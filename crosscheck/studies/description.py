"""The description of a robot that `graphdyn show` shows: bodies, joints, frames, graph matrices, the 11n equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn import RobotModel
from graphdyn._graph import IntArray
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class BodyRecord:
    """A body in its link axes.

    center_of_mass: in the link frame                       (3,)  [m]
    principal_moments: of the tensor about the center of mass, ascending   (3,)  [kg m²]
    consistent, problems: whether a real body can have these inertials, and why not
    """

    number: int
    name: str
    mass: float
    center_of_mass: Array
    principal_moments: Array
    consistent: bool
    problems: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class JointRecord:
    """A joint between two bodies.

    inside, body: names of the bodies it connects
    axis: in joint axes                                     (3,)
    xyz, rpy: the joint frame in the link frame of the inside body   (3,) [m], (3,) [degree]
    lower, upper [rad or m], velocity [rad/s or m/s], effort [N m or N]: None where there is no limit
    damping [N m s/rad or N s/m], friction [N m or N]: kept, not part of the rigid dynamics
    """

    number: int
    name: str
    kind: str
    inside: str
    body: str
    axis: Array
    xyz: Array
    rpy: Array
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None
    damping: float
    friction: float


@dataclass(frozen=True, eq=False)
class FrameRecord:
    """A named frame fixed in a body; xyz [m], rpy [degree] in the body's link frame (3,)."""

    name: str
    aliases: tuple[str, ...]
    body: str
    xyz: Array
    rpy: Array


@dataclass(frozen=True, eq=False)
class GraphRecord:
    """The graph as matrices, rows and columns as in docs/notation.md.

    incidence: S, path: T, force_element: S^e               (n, n)
    body_joint_vectors: C, in axes of the row's body        (n, n, 3)  [m]
    """

    incidence: IntArray
    path: IntArray
    force_element: IntArray
    body_joint_vectors: Array

    @property
    def matrices(self) -> dict[str, IntArray]:
        """The 0/±1 matrices by title."""
        return {
            "incidence S": self.incidence,
            "path matrix T": self.path,
            "force elements S^e": self.force_element,
        }


@dataclass(frozen=True, eq=False)
class SystemRecord:
    """The matrix [A φ_qᵀ; φ_q 0] of Eq. (111) at one random state.

    q: the state                                            (n,)  [rad or m]
    pattern: where its entries differ from zero             (11n, 11n)
    condition_number: infinite where it is singular (a massless body)
    """

    seed: int
    q: Array
    pattern: NDArray[np.bool_]
    rank: int
    condition_number: float

    @property
    def n_bodies(self) -> int:
        return len(self.q)


@dataclass(frozen=True, eq=False)
class RobotDescription:
    """All that `graphdyn show` shows, and the model itself for drawing it.

    robot: as given; gravity: world axes (3,) [m/s²]; total_mass: of the moving bodies [kg]
    base_xyz, base_rpy: the ground frame in the world       (3,) [m], (3,) [degree]
    """

    model: RobotModel
    robot: str
    locked: Mapping[str, float]
    base: str
    base_xyz: Array
    base_rpy: Array
    gravity: Array
    total_mass: float
    bodies: tuple[BodyRecord, ...]
    joints: tuple[JointRecord, ...]
    frames: tuple[FrameRecord, ...]
    graph: GraphRecord
    system: SystemRecord
