"""Maximal state → joint state: positions, velocities and accelerations of the joints, read off the bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.equations.kinematics import MaximalState, bias_acceleration, joint_axes, link_origins
from graphdyn.errors import InconsistentState, InvalidInput, in_row
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.model.spatial import cross

MAX_CONSTRAINT_RESIDUAL = 1e-6
"""Largest constraint residual [m, rad] with which joint_state still reads joint angles off a maximal state.

Far above rounding (1e-15 m for an arm of some meters), far below what a misplaced body would show."""


def joint_state(model: RobotModel, state: MaximalState) -> tuple[Array, Array]:
    """q, v (…, nv) of a maximal state. Angles come back in (-π, π]: full turns leave no trace in R.

    The motion of the base is that of the state.
    Raises InconsistentState, naming the joint, where the bodies are not where the joints of the model hold them
    (MAX_CONSTRAINT_RESIDUAL); InvalidInput for a state of another number of bodies.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found, _ = graphdyn.joint_state(model, graphdyn.maximal_state(model, q, v))
    >>> bool(np.allclose(found, q))
    True
    """
    check_model(model)
    state = replace(state, model=model)
    residual = np.abs(state.constraint_residual())
    if residual.size and residual.max() > MAX_CONSTRAINT_RESIDUAL:
        *row, worst, _ = (int(k) for k in np.unravel_index(int(residual.argmax()), residual.shape))
        raise InconsistentState(
            f"joint '{model.joint_names[worst]}' is open by {residual.max():.2g} (m or rad){in_row(row)}; "
            f"a state of robot '{model.name}' closes every joint to {MAX_CONSTRAINT_RESIDUAL:g}"
        )
    return read_joints(state)


def read_joints(state: MaximalState) -> tuple[Array, Array]:
    """joint_state for the state's own model, however far the joints are open: along and about the axes."""
    model = state.model
    q, v = (np.empty((*state.position.shape[:-2], model.n_bodies)) for _ in range(2))
    vertices, axes, origins = state.vertices, joint_axes(state), link_origins(state)
    for j, joint in enumerate(model.joints, start=1):
        i, k = joint.inside, j - 1
        axis = axes[..., k, :]
        if joint.is_prismatic:
            arm = vertices.arm(i, joint.placement.translation)
            slide = origins[..., k, :] - vertices.position[..., i, :] - arm
            q[..., k] = _dot(slide, axis)
            arm_j = origins[..., k, :] - state.position[..., k, :]
            velocity_j = vertices.velocity[..., j, :] + cross(vertices.angular_velocity[..., j, :], arm_j)
            carried = vertices.velocity[..., i, :] + cross(vertices.angular_velocity[..., i, :], arm + slide)
            v[..., k] = _dot(velocity_j - carried, axis)
        else:
            inside = vertices.rotation[..., i, :, :] @ joint.placement.rotation
            turn = np.swapaxes(inside, -1, -2) @ state.rotation[..., k, :, :]
            t_1, t_2 = joint.axis_normals
            q[..., k] = np.arctan2((turn @ t_1) @ t_2, (turn @ t_1) @ t_1)
            v[..., k] = _dot(vertices.angular_velocity[..., j, :] - vertices.angular_velocity[..., i, :], axis)
    _refuse_uncoupled(model, q, v)
    independent = list(model.degrees_of_freedom.independent)
    return q[..., independent], v[..., independent]


def _refuse_uncoupled(model: RobotModel, q: Array, v: Array) -> None:
    """Raise InconsistentState where driven joints are not where, or not as fast as, their couplings want (…, n)."""
    if not model.couplings:
        return
    rows, offsets = model.degrees_of_freedom.rows, np.array([coupling.offset for coupling in model.couplings])
    driven = [model.joints[model.joint_names.index(coupling.joint)] for coupling in model.couplings]
    gap = q @ rows.T - offsets
    turns = 2 * np.pi * np.array([not joint.is_prismatic for joint in driven])
    gap = gap - turns * np.round(gap / np.where(turns == 0, 1.0, turns))
    for what, unit, error in (("position", "rad or m", gap), ("velocity", "rad/s or m/s", v @ rows.T)):
        if error.size and (largest := float(np.abs(error).max())) > MAX_CONSTRAINT_RESIDUAL:
            *row, worst = (int(k) for k in np.unravel_index(int(np.abs(error).argmax()), error.shape))
            raise InconsistentState(
                f"the {what} of joint '{driven[worst].name}' is off its coupling by "
                f"{largest:.2g} {unit}{in_row(row)}; a state of robot '{model.name}' holds couplings to "
                f"{MAX_CONSTRAINT_RESIDUAL:g}"
            )


def joint_acceleration(model: RobotModel, state: MaximalState) -> Array:
    """a (…, nv): joint accelerations of a maximal state that carries body accelerations [rad/s² or m/s²].

    The acceleration of each body relative to its inside body, along the joint axis.

    Raises InconsistentState as joint_state does; InvalidInput where the state has no acceleration.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> state = graphdyn.maximal_state(model, q, v, a=np.ones(6))
    >>> bool(np.allclose(graphdyn.joint_acceleration(model, state), 1))
    True
    """
    check_model(model)
    if state.acceleration is None:
        raise InvalidInput("the maximal state has no acceleration; call maximal_state with a, or set it")
    q, v = joint_state(model, state)
    bias = bias_acceleration(model, q, v, state.ground)
    return project_accelerations(replace(state, model=model), state.acceleration, bias)


def project_accelerations(state: MaximalState, acceleration: Array, bias: Array) -> Array:
    """a (…, nv) from body accelerations (…, n, 6) and Ṅ v (…, n, 6): relative ones along the joint axes."""
    model = state.model
    relative = acceleration - bias  # = N a
    axes, origins, vertices = joint_axes(state), link_origins(state), state.vertices
    angular = np.einsum("...iab,...ib->...ia", state.rotation, relative[..., ANGULAR])
    at_ground = np.zeros_like(angular[..., :1, :])
    angular = np.concatenate([at_ground, angular], axis=-2)
    linear = np.concatenate([at_ground, relative[..., LINEAR]], axis=-2)
    a = np.empty(relative.shape[:-1], dtype=relative.dtype)
    for j, joint in enumerate(model.joints, start=1):
        i, k = joint.inside, j - 1
        if joint.is_prismatic:
            at_j = linear[..., j, :] + cross(angular[..., j, :], origins[..., k, :] - vertices.position[..., j, :])
            at_i = linear[..., i, :] + cross(angular[..., i, :], origins[..., k, :] - vertices.position[..., i, :])
            difference = at_j - at_i
        else:
            difference = angular[..., j, :] - angular[..., i, :]
        a[..., k] = _dot(difference, axes[..., k, :])
    return a[..., list(model.degrees_of_freedom.independent)] if model.couplings else a


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.einsum("...a,...a->...", a, b)
    return product
