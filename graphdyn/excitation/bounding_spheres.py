"""Points and spheres of the robot that stay on one side of planes, and keep a distance from each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from graphdyn.equations.kinematics import joint_axes, link_origins, maximal_state
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import cross

Numbers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Sphere:
    """A sphere fixed in a body: center in its link frame (3,) [m], and radius [m]; 0 is a point. Body 0 is the
    ground.
    """

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
