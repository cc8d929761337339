"""A base that moves as prescribed: the first joints' constraint becomes φ(q, t) = 0 (the paper's rail, section 3)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import cross

BASE_ROTATION_TOLERANCE = 1e-9
"""Largest entry of RᵀR - E that counts as rounding."""

_TRAILING = {"rotation": (3, 3), "translation": (3,), "velocity": (6,), "acceleration": (6,)}


@dataclass(frozen=True, eq=False)
@short_repr
class BaseMotion:
    """How the moving base of a robot moves; the ground frame stands on it at `model.base`. Leading dimensions
    broadcast.

    rotation, translation: placement of the moving base in the world       (…, 3, 3), (…, 3)  [m]
    velocity: ṗ of its origin, then ω, world axes                       (…, 6)             [m/s, rad/s]
    acceleration: p̈ of its origin, then ω̇, world axes                   (…, 6)             [m/s², rad/s²]

    Gravity stays that of the model, in world axes. Raises InvalidInput for wrong shapes, NaN or infinity, and a
    matrix that is not a rotation.
    """

    rotation: Array = field(default_factory=lambda: np.eye(3))
    translation: Array = field(default_factory=lambda: np.zeros(3))
    velocity: Array = field(default_factory=lambda: np.zeros(6))
    acceleration: Array = field(default_factory=lambda: np.zeros(6))

    def __post_init__(self) -> None:
        batches = {}
        for name, trailing in _TRAILING.items():
            array = as_floats(f"{name} of the base", getattr(self, name))
            if array.shape[-len(trailing) :] != trailing:
                expected = ", ".join(["…", *map(str, trailing)])
                raise InvalidInput(f"{name} of the base has shape {array.shape}, expected ({expected})")
            if not np.all(np.isfinite(array)):
                raise InvalidInput(f"{name} of the base contains NaN or infinity")
            object.__setattr__(self, name, array)
            batches[name] = array.shape[: array.ndim - len(trailing)]
        try:
            object.__setattr__(self, "batch", np.broadcast_shapes(*batches.values()))
        except ValueError as error:
            raise InvalidInput(f"leading dimensions of the base motion do not broadcast: {batches}") from error
        product = np.swapaxes(self.rotation, -1, -2) @ self.rotation
        if np.abs(product - np.eye(3)).max(initial=0.0) > BASE_ROTATION_TOLERANCE or np.any(
            np.linalg.det(self.rotation) < 0
        ):
            raise InvalidInput("rotation of the base is not a rotation matrix: RᵀR = E and det R = 1 are needed")

    batch: tuple[int, ...] = field(init=False, repr=False, default=())

    @property
    def moves(self) -> bool:
        """Whether it has a velocity or an acceleration."""
        return bool(self.velocity.any() or self.acceleration.any())

    def at(self, batch: tuple[int, ...], index: tuple[NDArray[np.intp], ...]) -> BaseMotion:
        """The samples at this index, once broadcast to a leading shape."""
        return BaseMotion(
            **{
                name: np.broadcast_to(getattr(self, name), (*batch, *trailing))[index]
                for name, trailing in _TRAILING.items()
            }
        )


AT_REST = BaseMotion()


@dataclass(frozen=True, eq=False)
class Ground:
    """Vertex 0 of the graph: where the ground frame is and how it moves, in world axes.

    position (…, 3), rotation (…, 3, 3), velocity and acceleration (…, 6): of its origin, then angular
    """

    position: Array
    rotation: Array
    velocity: Array
    acceleration: Array

    def at(self, arm: Array) -> Ground:
        """The same frame moved by an arm (3,) in its own axes."""
        r = self.rotation @ arm
        if not (self.velocity.any() or self.acceleration.any()):
            return Ground(self.position + r, self.rotation, self.velocity, self.acceleration)
        omega, alpha = self.velocity[..., ANGULAR], self.acceleration[..., ANGULAR]
        velocity, acceleration = self.velocity.copy(), self.acceleration.copy()
        carried = cross(omega, r)
        velocity[..., LINEAR] += carried
        acceleration[..., LINEAR] += cross(alpha, r) + cross(omega, carried)
        return Ground(self.position + r, self.rotation, velocity, acceleration)

    def moved_to(self, position: Array) -> Ground:
        """The same motion elsewhere in the world."""
        return Ground(np.broadcast_to(position, self.position.shape), self.rotation, self.velocity, self.acceleration)


def ground(model: RobotModel, base: BaseMotion | None, batch: tuple[int, ...] = ()) -> Ground:
    """The ground frame of a robot on a moving base, at rest without one. Arrays have the leading dimensions batch."""
    base = base or AT_REST
    base_motion = Ground(
        np.broadcast_to(base.translation, (*batch, 3)),
        np.broadcast_to(base.rotation, (*batch, 3, 3)),
        np.broadcast_to(base.velocity, (*batch, 6)),
        np.broadcast_to(base.acceleration, (*batch, 6)),
    )
    moved = base_motion.at(model.base.translation)
    return Ground(moved.position, moved.rotation @ model.base.rotation, moved.velocity, moved.acceleration)


def rooted_ground(model: RobotModel, base: BaseMotion | None, batch: tuple[int, ...] = ()) -> Ground:
    """The same with joint 1 at the world's origin (RobotModel.rooted)."""
    moving = ground(model, base, batch)
    return moving.moved_to(-(moving.rotation @ model.joints[0].placement.translation))
