"""The five multipliers of every joint, from the wrenches of a reference implementation.

The reference values of Pinocchio, in the order and the axes of graphdyn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn import RobotModel
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model import cross


def multipliers_of(model: RobotModel, rotation: NDArray[Any], wrenches: NDArray[Any]) -> NDArray[Any]:
    """The multipliers (N, n, 5) of a reference implementation's joint wrenches, as docs/notation.md defines them.

    rotation: R_0j of all bodies (N, n, 3, 3); wrenches: at O_j in link axes (N, n, 6); complex for complex steps
    """
    force, moment = (np.einsum("...jab,...jb->...ja", rotation, wrenches[..., part]) for part in (LINEAR, ANGULAR))
    result = np.empty((*wrenches.shape[:-1], 5), dtype=np.result_type(rotation, wrenches))
    for k, joint in enumerate(model.joints):
        inside = rotation[..., joint.inside - 1, :, :] if joint.inside else model.base.rotation
        t_1, t_2, p = ((inside @ joint.placement.rotation) @ x for x in (*joint.axis_normals, joint.axis))
        f, m = force[..., k, :], moment[..., k, :]
        if joint.is_prismatic:
            rows = [(f * t_1).sum(-1), (f * t_2).sum(-1), (m * t_1).sum(-1), (m * t_2).sum(-1), (m * p).sum(-1)]
        else:
            rows = [f[..., 0], f[..., 1], f[..., 2], (m * t_1).sum(-1), (m * t_2).sum(-1)]
        result[..., k, :] = np.stack(rows, axis=-1)
    return result


@dataclass(frozen=True, eq=False)
class CarriedValues:
    """Pinocchio's values for a robot on a moving base: τ (N, n), wrenches data.f (N, n, 6), and a (N, n) of given τ."""

    tau: Array
    joint_wrenches: Array
    a: Array


@dataclass(frozen=True, eq=False)
class BareCalls:
    """Pinocchio's functions as a user calls them.

    One state: function(model, data, q, v, …). Many states on several threads: function(threads, pool(threads), q, v, …,
    out), with arrays (n, N) stored by columns, the memory layout of (N, n) by rows.

    tip: the last arguments of functions of a frame: the frame of this name (crosscheck.reference.subject), and
        LOCAL_WORLD_ALIGNED
    """

    model: Any
    data: Any
    rnea: Callable[..., Array]
    aba: Callable[..., Array]
    torque_regressor: Callable[..., Array]
    rnea_derivatives: Callable[..., tuple[Array, Array, Array]]
    aba_derivatives: Callable[..., tuple[Array, Array, Array]]
    tip: tuple[Any, Any]
    rnea_in_parallel: Callable[..., None]
    aba_in_parallel: Callable[..., None]
    pool: Callable[[int], Any]


def at_centers(centers: Array, rotation: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
    """ṙ and ω, r̈ and ω̇ (N, n, 6) from spatial velocities and accelerations at the link origins.

    centers: of mass, in link axes (n, 3); rotation: of the links (N, n, 3, 3)
    """
    linear, omega = velocity[..., LINEAR], velocity[..., ANGULAR]
    alpha = acceleration[..., ANGULAR]
    at_center = linear + cross(omega, centers)
    classical = acceleration[..., LINEAR] + cross(omega, linear)
    classical = classical + cross(alpha, centers) + cross(omega, cross(omega, centers))

    def in_world(vectors: Array) -> Array:
        turned: Array = np.einsum("...ab,...b->...a", rotation, vectors)
        return turned

    return (
        np.concatenate([in_world(at_center), omega], axis=-1),
        np.concatenate([in_world(classical), alpha], axis=-1),
    )
