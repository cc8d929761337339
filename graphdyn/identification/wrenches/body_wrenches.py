"""Wrenches on each body from measured joint wrenches: the right sides of the identification equations."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.model.spatial import cross

_TRAILING = {
    "q": (),
    "v": (),
    "a": (),
    "rotation": (3, 3),
    "acceleration": (3,),
    "angular_velocity": (3,),
    "angular_acceleration": (3,),
    "joint_forces": (3,),
    "joint_moments": (3,),
}


class WrenchData(Protocol):
    """N samples of the motion of n bodies and of the wrenches in their joints, world axes (paper, section 3.1).

    joint_names: in the order of the columns
    q, v, a: joint positions, velocities, accelerations     (N, n)        [rad or m, …/s, …/s²]
    rotation: R, body axes to world axes                    (N, n, 3, 3)
    acceleration: r̈ of the centers of mass                  (N, n, 3)     [m/s²]
    angular_velocity, angular_acceleration: ω, ω̇            (N, n, 3)     [rad/s, rad/s²]
    joint_forces: F^e_j, of the inside body on body j       (N, n, 3)     [N]
    joint_moments: M_j about O_j, actuator included         (N, n, 3)     [N m]
    """

    @property
    def joint_names(self) -> tuple[str, ...]: ...
    @property
    def q(self) -> Array: ...
    @property
    def v(self) -> Array: ...
    @property
    def a(self) -> Array: ...
    @property
    def rotation(self) -> Array: ...
    @property
    def acceleration(self) -> Array: ...
    @property
    def angular_velocity(self) -> Array: ...
    @property
    def angular_acceleration(self) -> Array: ...
    @property
    def joint_forces(self) -> Array: ...
    @property
    def joint_moments(self) -> Array: ...


def body_wrenches(model: RobotModel, data: WrenchData) -> tuple[Array, Array]:
    """Resultants of the joint force elements on every body, without gravity: forces, and moments.

    The forces F_i^R = -Σ S^e_ik F^e_k are in world axes (N, n, 3) [N], Eq. (40), (44). The moments M_i =
    -Σ C^e_ik × F^e_k - Σ S_ik M_k about the center of mass are in body axes (N, n, 3) [N m], Eq. (19), (26).

    The model gives the geometry (joints, centers of mass); its masses and moments of inertia are not read.
    Raises InvalidInput if the data do not fit the model, or are not finite.
    """
    x = fitting_data(model, data, "q", "rotation", "joint_forces", "joint_moments")
    s = model.graph.incidence()  # which is S^e
    force = -np.einsum("ik,...ka->...ia", s, x["joint_forces"])
    to_body = np.swapaxes(x["rotation"], -1, -2)[..., :, None, :, :]  # body i, joint k
    pushes = (to_body @ x["joint_forces"][..., None, :, :, None])[..., 0]
    turns = (to_body @ x["joint_moments"][..., None, :, :, None])[..., 0]
    moment = -np.sum(cross(_levers(model, x["q"]), pushes) + s[..., None] * turns, axis=-2)
    return force, moment


def link_wrenches(model: RobotModel, data: WrenchData) -> Array:
    """The same resultants as wrenches at the link origins O_i, in link axes (N, n, 6) [N, N m].

    No center of mass is read, neither of the model nor of the data. Raises InvalidInput as body_wrenches does.
    """
    check_model(model)
    force, moment = body_wrenches(model.skeleton, data)
    in_link_axes = np.einsum("...iba,...ib->...ia", data.rotation, force)
    return np.concatenate([in_link_axes, moment], axis=-1)


def fitting_data(model: RobotModel, data: WrenchData, *names: str) -> dict[str, Array]:
    """The named arrays of the data, checked against the model.

    Raises InvalidInput, naming array, sample and body, for other joints, wrong shapes, NaN or infinity, no sample.
    """
    check_model(model)
    if tuple(data.joint_names) != model.joint_names:
        raise InvalidInput(
            f"the data have joints {', '.join(data.joint_names)}, robot '{model.name}' has "
            f"{', '.join(model.joint_names)}; bring them into the order of the robot"
        )
    arrays = {name: as_floats(name, getattr(data, name)) for name in names}
    samples = len(arrays[names[0]]) if arrays[names[0]].ndim else 0
    for name, array in arrays.items():
        expected = (samples, model.n_bodies, *_TRAILING[name])
        if array.shape != expected or samples == 0:
            raise InvalidInput(
                f"{name} has shape {array.shape}, expected {('N', *expected[1:])} with the same N ≥ 1 in all arrays"
            )
        bad = np.argwhere(~np.isfinite(array))
        if bad.size:
            raise InvalidInput(
                f"{name} contains NaN or infinity at sample {bad[0][0]}, body '{model.body_names[bad[0][1]]}'; "
                "leave the sample out"
            )
    return arrays


def _levers(model: RobotModel, q: Array) -> Array:
    """Lever arms C^e_ik (N, n, n, 3) with the sliding joints in their position, Eq. (17)-(18) [m]."""
    levers = np.tile(model.body_joint_vectors(), (len(q), 1, 1, 1))
    for k, joint in enumerate(model.joints, start=1):
        if joint.is_prismatic and joint.inside > 0:
            levers[:, joint.inside - 1, k - 1] += q[:, k - 1, None] * (joint.placement.rotation @ joint.axis)
    return levers
