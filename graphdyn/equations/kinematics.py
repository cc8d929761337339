"""Joint state → maximal state.

Maximal coordinates: per body the position r of the center of mass in world axes and its orientation R; velocity
(ṙ in world axes, ω in body axes), acceleration (r̈, ω̇) likewise. Vertex arrays carry the ground as row 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats, joint_arrays
from graphdyn.arguments.base_motion import BaseMotion, Ground, ground
from graphdyn.arguments.choices import Method, is_recursive, with_keywords
from graphdyn.compiler.batch import evaluate, request_of
from graphdyn.compiler.programs import Request
from graphdyn.compiler.running import has_paid
from graphdyn.display import short_repr
from graphdyn.equations.vertices import Vertices, constraint_values
from graphdyn.errors import InvalidInput
from graphdyn.layout import ANGULAR, LINEAR, Array, stacked_rows
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.model.spatial import cardano_angles, cardano_rate_matrix, cross, solve


@dataclass(frozen=True, eq=False)
@short_repr
class MaximalState:
    """Placements and motions of all bodies; arrays have leading batch dimensions.

    position: r, centers of mass, world axes                (…, n, 3)     [m]
    rotation: R, body axes to world axes                    (…, n, 3, 3)
    velocity: ṙ in world axes, ω in body axes               (…, n, 6)     [m/s, rad/s]
    acceleration: r̈ in world axes, ω̇ in body axes; or None  (…, n, 6)     [m/s², rad/s²]
    ground: where the ground frame is and how it moves; at rest at `model.base` if left out
    """

    model: RobotModel
    position: Array
    rotation: Array
    velocity: Array
    acceleration: Array | None = None
    ground: Ground | None = None

    def __post_init__(self) -> None:
        check_model(self.model)
        n = self.model.n_bodies
        shapes = {"position": (n, 3), "rotation": (n, 3, 3), "velocity": (n, 6), "acceleration": (n, 6)}
        for name, trailing in shapes.items():
            value = getattr(self, name)
            if value is None and name == "acceleration":
                continue
            array = as_floats(name, value)
            if array.shape[-len(trailing) :] != trailing:
                raise InvalidInput(f"{name} has shape {array.shape}, expected (…, {', '.join(map(str, trailing))})")
            if not np.all(np.isfinite(array)):
                raise InvalidInput(f"{name} of the maximal state contains NaN or infinity")
            object.__setattr__(self, name, array)
        batches = {
            name: getattr(self, name).shape[: -len(trailing)]
            for name, trailing in shapes.items()
            if getattr(self, name) is not None
        }
        if len(set(batches.values())) > 1:
            raise InvalidInput(f"leading dimensions of the maximal state differ: {batches}")
        if self.ground is None:
            object.__setattr__(self, "ground", ground(self.model, None, batches["position"]))

    @property
    def cardano(self) -> Array:
        """θ = (α, β, γ) of every body (…, n, 3) [rad], Eq. (1)."""
        return cardano_angles(self.rotation)

    @property
    def cardano_rates(self) -> Array:
        """θ̇ = D⁻¹ ω (…, n, 3) [rad/s], Eq. (3), (33). Grows without bound towards gimbal lock."""
        d = cardano_rate_matrix(self.cardano)
        return solve(d, self.velocity[..., ANGULAR])

    def constraint_residual(self) -> Array:
        """φ (…, n, 5), Eq. (65)-(105): how far the bodies are from where the joints hold them. [m, -]"""
        return constraint_values(self.model, self.vertices)

    @cached_property
    def vertices(self) -> Vertices:
        """The bodies and the ground as vertices of the graph."""
        assert self.ground is not None
        return Vertices(self.model, self.position, self.rotation, self.velocity, self.ground)


class ComplexState(MaximalState):
    """The state of a complex step (graphdyn.equations.complex_steps), inside a specification: nothing is checked."""

    def __post_init__(self) -> None:
        pass


@with_keywords
def maximal_state(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike | None = None,
    a: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
) -> MaximalState:
    """Positions, orientations and twists of all bodies, and with a their accelerations.

    q, v, a: joint positions, velocities, accelerations     (…, nv)  [rad or m, …/s, …/s²]
    A missing v stands for zero; without a the state has no acceleration. The methods "projected" and "dense" are the
    same here.

    Raises InvalidInput for wrong shapes, NaN or infinity.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> state = graphdyn.maximal_state(model, q, v)
    >>> state.position.shape, state.rotation.shape
    ((6, 3), (6, 3, 3))
    """
    check_model(model)
    rest = np.zeros(model.nv)
    x = joint_arrays(model, base, q=q, v=rest if v is None else v, a=rest if a is None else a)
    of_velocities = request_of("maximal_state", ("position", "rotation", "velocity"), x, base)
    samples = x["q"][..., 0].size
    if is_recursive(method, samples, lambda: has_paid(model, of_velocities, samples)):
        return _recursive_state(model, of_velocities, x, a is not None, base, threads)
    return state_on(ground(model, base, x["q"].shape[:-1]), model, x["q"], x["v"], None if a is None else x["a"])


def state_on(vertex_0: Ground, model: RobotModel, q: Array, v: Array, a: Array | None) -> MaximalState:
    """maximal_state on a ground that is where it is: q, v, a and the ground's arrays have the same leading shape."""
    batch, n = q.shape[:-1], model.n_bodies
    if model.couplings:
        to_joints = model.degrees_of_freedom.matrix.T
        q, v, a = model.joint_positions(q), v @ to_joints, None if a is None else a @ to_joints
    number = np.result_type(q, v, *(() if a is None else (a,)))  # complex for graphdyn.equations.complex_steps
    rotation = np.empty((*batch, n + 1, 3, 3), dtype=number)
    # of the link origins, world axes; row 0 is the ground
    origin, linear, angular = (np.zeros((*batch, n + 1, 3), dtype=number) for _ in range(3))
    linear_acc, angular_acc = (np.zeros((*batch, n + 1, 3), dtype=number) for _ in range(2))
    rotation[..., 0, :, :], origin[..., 0, :] = vertex_0.rotation, vertex_0.position
    linear[..., 0, :], angular[..., 0, :] = vertex_0.velocity[..., LINEAR], vertex_0.velocity[..., ANGULAR]
    linear_acc[..., 0, :], angular_acc[..., 0, :] = (
        vertex_0.acceleration[..., LINEAR],
        vertex_0.acceleration[..., ANGULAR],
    )
    for j, joint in enumerate(model.joints, start=1):
        i, k = joint.inside, j - 1
        in_world = rotation[..., i, :, :] @ joint.placement.rotation
        axis = in_world @ joint.axis
        arm = rotation[..., i, :, :] @ joint.placement.translation
        omega, alpha = angular[..., i, :], angular_acc[..., i, :]
        rate = v[..., k, None] * axis
        if joint.is_prismatic:
            arm = arm + q[..., k, None] * axis
            rotation[..., j, :, :] = in_world
            angular[..., j, :] = omega
        else:
            rotation[..., j, :, :] = in_world @ joint.turn(q[..., k])
            angular[..., j, :] = omega + rate
        origin[..., j, :] = origin[..., i, :] + arm
        carried = cross(omega, arm)
        linear[..., j, :] = linear[..., i, :] + carried
        if joint.is_prismatic:
            linear[..., j, :] += rate
        if a is None:
            continue
        relative = a[..., k, None] * axis
        linear_acc[..., j, :] = linear_acc[..., i, :] + cross(alpha, arm) + cross(omega, carried)
        if joint.is_prismatic:
            angular_acc[..., j, :] = alpha
            linear_acc[..., j, :] += 2 * cross(omega, rate) + relative
        else:
            angular_acc[..., j, :] = alpha + cross(omega, rate) + relative
    rotation, origin, angular, angular_acc = (
        rotation[..., 1:, :, :],
        origin[..., 1:, :],
        angular[..., 1:, :],
        angular_acc[..., 1:, :],
    )
    centers = np.stack([body.center_of_mass for body in model.bodies])
    arms = np.einsum("...iab,ib->...ia", rotation, centers)

    def twist(at_origin: Array, angular_part: Array) -> Array:
        return np.concatenate([at_origin, np.einsum("...iba,...ib->...ia", rotation, angular_part)], axis=-1)

    carried = cross(angular, arms)
    velocity = twist(linear[..., 1:, :] + carried, angular)
    acceleration = None
    if a is not None:
        at_center = linear_acc[..., 1:, :] + cross(angular_acc, arms) + cross(angular, carried)
        acceleration = twist(at_center, angular_acc)
    kind = ComplexState if number.kind == "c" else MaximalState
    return kind(model, origin + arms, rotation, velocity, acceleration, vertex_0)


def _recursive_state(
    model: RobotModel,
    of_velocities: Request,
    x: dict[str, Array],
    accelerated: bool,
    base: BaseMotion | None,
    threads: int | None,
) -> MaximalState:
    """state_on by graphdyn.recursions."""
    acceleration = None
    if accelerated:
        of_accelerations = request_of("inverse_dynamics", ("body_accelerations",), x, base)
        there = evaluate(model, of_accelerations, x, base, threads=threads, check=False)
        acceleration = there.arrays["body_accelerations"]
    given = {"q": x["q"], "v": x["v"]}
    state = evaluate(model, of_velocities, given, base, threads=threads, check=False).arrays
    return MaximalState(model, **state, acceleration=acceleration, ground=ground(model, base, x["q"].shape[:-1]))


def bias_acceleration(model: RobotModel, q: Array, v: Array, on: Ground | None = None) -> Array:
    """Ṅ v (…, n, 6): the body accelerations at v when all joint accelerations are zero; on a ground that may move."""
    vertex_0 = ground(model, None, q.shape[:-1]) if on is None else on
    acceleration = state_on(vertex_0, model, q, v, np.zeros_like(q)).acceleration
    assert acceleration is not None
    return acceleration


def link_origins(state: MaximalState) -> Array:
    """O_j (…, n, 3): origins of the link frames, where the inside joints are; world axes [m]."""
    vertices = state.vertices
    origins: Array = state.position - np.einsum("...iab,ib->...ia", state.rotation, vertices.center[1:])
    return origins


def levers(state: MaximalState) -> Array:
    """Levers from O_k to the center of mass of body i (…, k, i, 3), zero where i is not outside joint k  [m].

    In world axes, summed from link to link: in a difference of two positions the short lever of a wrist loses digits.
    """
    joints, vertices, on_path = state.model.joints, state.vertices, state.model.graph.path_matrix()[..., None]
    turned = vertices.rotation[..., [joint.inside for joint in joints], :, :]
    links = np.einsum("...jab,jb->...ja", turned, np.stack([joint.placement.translation for joint in joints]))
    arms = np.einsum("...iab,ib->...ia", state.rotation, vertices.center[1:])
    found = np.zeros((*arms.shape[:-1], *arms.shape[-2:]), dtype=arms.dtype)
    for j, joint in enumerate(joints):
        i = joint.inside - 1
        if i < 0:
            continue
        link = links[..., j, :]
        if joint.is_prismatic:
            link = state.position[..., j, :] - arms[..., j, :] - (state.position[..., i, :] - arms[..., i, :])
        found[..., j, :] = (found[..., i, :] + link[..., None, :]) * on_path[:, i]
    found += arms[..., None, :, :]
    found *= on_path
    return found


def frame_placement(
    model: RobotModel, q: ArrayLike, name: str, *, base: BaseMotion | None = None
) -> tuple[Array, Array]:
    """Rotation (…, 3, 3) and position (…, 3) [m] in the world of a named frame (see RobotModel.frame).

    Raises UnknownFrame for an unknown name, InvalidInput for wrong shapes, NaN or infinity.

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> rotation, position = graphdyn.frame_placement(model, q, "B6")
    >>> bool(np.allclose(rotation @ rotation.T, np.eye(3)))
    True
    """
    check_model(model)
    frame = model.frame(name)
    state = maximal_state(model, q, base=base)
    vertices = state.vertices
    rotation = vertices.rotation[..., frame.body, :, :]
    position = vertices.position[..., frame.body, :] + vertices.arm(frame.body, frame.placement.translation)
    return rotation @ frame.placement.rotation, position


def null_space(state: MaximalState) -> Array:
    """N (…, 6n, nv) with body velocities = N v: its columns span the null space of φ_q, since φ_q N = 0.

    What a joint does to its own body is taken in link axes, where p and p × c are not rounded.
    """
    model = state.model
    axes, on_path = joint_axes(state), model.graph.path_matrix()
    lever, axis = np.swapaxes(levers(state), -2, -3), axes[..., None, :, :]  # body i, joint k
    revolute = np.array([not joint.is_prismatic for joint in model.joints])[:, None]
    linear = np.where(revolute, cross(axis, lever), axis)
    angular = np.where(revolute, np.einsum("...iba,...kb->...ika", state.rotation, axes), 0.0)
    own, fixed = np.flatnonzero(revolute), np.stack([joint.axis for joint in model.joints])
    across = cross(fixed, state.vertices.center[1:])
    linear[..., own, own, :] = np.einsum("...iab,ib->...ia", state.rotation[..., own, :, :], across[own])
    angular[..., own, own, :] = fixed[own]
    columns = np.concatenate([linear, angular], axis=-1) * on_path.T[:, :, None]  # (…, body, joint, 6)
    n = stacked_rows(np.swapaxes(columns, -1, -2))
    return n @ model.degrees_of_freedom.matrix if model.couplings else n


def joint_axes(state: MaximalState) -> Array:
    """p_j (…, n, 3): unit joint axes in world axes."""
    vertices = state.vertices
    return np.stack(
        [
            vertices.rotation[..., joint.inside, :, :] @ (joint.placement.rotation @ joint.axis)
            for joint in state.model.joints
        ],
        axis=-2,
    )
