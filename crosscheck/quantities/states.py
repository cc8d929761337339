"""The states at which two dynamics codes are compared: random ones, and special ones where codes tend to fail."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn import Placement, RobotModel, inverse_dynamics, maximal_state
from graphdyn.layout import Array

ACCELERATION_RANGE = 10.0
"""Largest joint acceleration of random states, uniform in ± this range [rad/s² or m/s²]."""

FAST = 10.0
"""Factor on the velocities and accelerations of the fast states."""

LOAD = 0.1
"""Size of external forces [N] and moments [N m], as a part of the robot's weight in standard gravity [N]."""

RANDOM = "random"
"""Name of the first case, the random states."""

AWKWARD = 50
"""Largest number of states of each special case that does not concern a single body."""


@dataclass(frozen=True, eq=False)
class Case:
    """N states of one kind, of a robot whose mounting and gravity may differ from the original.

    model: the robot, with base and gravity rotated if the case needs it
    turn: this rotation of base and gravity
    q, v, a: (N, n); external_wrenches: (N, n, 6)
    tau: given torques (N, n), or None for the torques that cause exactly a (then terms cancel)
    """

    name: str
    model: RobotModel
    turn: Placement
    q: Array
    v: Array
    a: Array
    tau: Array | None
    external_wrenches: Array

    def rows(self, selected: slice | NDArray[np.bool_]) -> Case:
        """The same case with some of its states."""
        arrays = {name: getattr(self, name) for name in ("q", "v", "a", "tau", "external_wrenches")}
        return replace(self, **{name: array[selected] for name, array in arrays.items() if array is not None})


def cases(model: RobotModel, samples: int, seed: int) -> Iterator[Case]:
    """All cases for one robot, reproducible by seed."""
    rng = np.random.default_rng(seed)
    scale = _torque_scale(model, np.random.default_rng(seed))

    def case(name: str, q: Array, v: Array, a: Array, *, of: RobotModel = model, turn: Placement | None = None) -> Case:
        tau = rng.normal(size=q.shape) * scale
        return Case(name, of, turn or Placement(), q, v, a, tau, _load(model, rng, len(q)))

    def draw(size: int) -> tuple[Array, Array, Array]:
        q, v = model.random_state(rng, size)
        return q, v, rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)

    yield case(RANDOM, *draw(samples))
    few = min(samples, AWKWARD)
    q, v, a = draw(few)
    rest = np.zeros_like(q)
    yield case("zero pose at rest", rest[:1], rest[:1], rest[:1])
    yield case("zero pose", rest, v, a)
    q, v, a = draw(few)
    yield case("fast", q, FAST * v, FAST * a)
    yield case("zero gravity", *draw(few), of=model.with_gravity(np.zeros(3)))
    q, v, a = draw(few)
    yield Case("torques of a", model, Placement(), q, v, a, None, _load(model, rng, few))
    for i, body in enumerate(model.bodies):
        q, v, a = draw(1)
        third = maximal_state(model, q[0]).rotation[i, :, 2]
        turn = unit_turn(third)  # sin β = e_1·e_3 = 1
        yield case(f"gimbal lock of {body.name}", q, v, a, of=turned(model, turn), turn=turn)
    for joint in model.joints:
        q, v, a = draw(1)
        inside = maximal_state(model, q[0]).vertices.rotation[joint.inside]
        turn = unit_turn(inside @ joint.placement.rotation @ joint.axis)
        yield case(f"horizontal axis of {joint.name}", q, v, a, of=turned(model, turn), turn=turn)


def has_mass(model: RobotModel) -> bool:
    """Whether any body has mass: others are good for kinematics only."""
    return any(body.mass > 0 for body in model.bodies)


def unit_turn(direction: Array) -> Placement:
    """A rotation of the world that brings a unit vector onto the world x axis."""
    least = int(np.argmin(np.abs(direction)))
    second = np.cross(direction, np.eye(3)[least])
    second /= np.linalg.norm(second)
    return Placement(np.stack([direction / np.linalg.norm(direction), second, np.cross(direction, second)]))


def turned(model: RobotModel, turn: Placement) -> RobotModel:
    return model.with_base(turn @ model.base).with_gravity(turn.rotation @ model.gravity)


def _torque_scale(model: RobotModel, rng: np.random.Generator) -> Array:
    """Per joint, the usual size of its torque (n,), so that random torques give sensible accelerations."""
    q, v = model.random_state(rng, AWKWARD)
    a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
    rms: Array = np.sqrt(np.mean(inverse_dynamics(model, q, v, a).tau ** 2, axis=0))
    return rms


def _load(model: RobotModel, rng: np.random.Generator, size: int) -> Array:
    weight = 9.81 * sum(body.mass for body in model.bodies)
    return LOAD * weight * rng.normal(size=(size, model.n_bodies, 6))
