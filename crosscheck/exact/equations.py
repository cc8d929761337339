"""Eq. (111) in balls: the specification, which shares no line with the recursions that it is compared with.

    ⎡ A    φ_qᵀ ⎤ ⎡ q̈ ⎤   ⎡ B ⎤
    ⎣ φ_q   0   ⎦ ⎣ λ ⎦ = ⎣ ζ ⎦

In the twist form, q̈ = (r̈, ω̇) of each body, r̈ of its center of mass in world axes, ω̇ in link axes. A solution in
balls also proves that the matrix is regular at the state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crosscheck.exact.balls import Balls, as_balls, ball, cross, eye, rotation_about, solved, zeros
from crosscheck.exact.ground import ExactGround, ground
from crosscheck.exact.robot import ExactBody, ExactRobot
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS


@dataclass(frozen=True, eq=False)
class BodyState:
    """Body j in the world, and the wrench that acts on it whatever its acceleration.

    rotation (3, 3); center of mass (3,); omega (3,); velocity of the center of mass (3,), all in world axes
    joint: O_j (3,), of the ground its origin
    axes: columns t_1, t_2 and p in world axes, t_1 and t_2 fixed in the inside body  (3, 3)
    """

    rotation: Balls
    center: Balls
    omega: Balls
    velocity: Balls
    joint: Balls
    axes: Balls


@dataclass(frozen=True, eq=False)
class System:
    """matrix (11n, 11n) and right side (11n,) of Eq. (111) at one state."""

    matrix: Balls
    rhs: Balls

    def solve(self) -> tuple[Balls, Balls] | None:
        """Accelerations of the bodies (n, 6) and multipliers (n, 5); None where the balls do not prove that there is
        one solution."""
        x = solved(self.matrix, self.rhs)
        if x is None:
            return None
        n = len(x) // (BODY_DOF + JOINT_CONSTRAINTS)
        return x[: BODY_DOF * n].reshape(n, BODY_DOF), x[BODY_DOF * n :].reshape(n, JOINT_CONSTRAINTS)


def states(robot: ExactRobot, on: ExactGround, q: Sequence[Any], v: Sequence[Any]) -> list[BodyState]:
    """All bodies at joint positions and velocities (n,), from the ground outwards."""
    found = [BodyState(on.rotation, on.position, on.omega, on.velocity, on.position, eye())]
    for body, position, rate in zip(robot.bodies, q, v, strict=True):
        inside = found[body.inside]
        frame = inside.rotation @ body.placement.rotation
        origin = inside.joint + inside.rotation @ body.placement.translation
        axes, own_axis = frame @ body.joint_axes, body.joint_axes[:, 2]
        axis, omega = axes[:, 2], inside.omega
        if body.prismatic:
            origin, rotation = origin + axis * position, frame
        else:
            rotation, omega = frame @ rotation_about(own_axis, position), omega + axis * rate
        at_joint = inside.velocity + cross(inside.omega, origin - inside.center)
        at_joint = at_joint + axis * rate if body.prismatic else at_joint
        arm = rotation @ body.center_of_mass
        found.append(BodyState(rotation, origin + arm, omega, at_joint + cross(omega, arm), origin, axes))
    return found


def placed(robot: ExactRobot, on: ExactGround, q: Sequence[Any], name: str) -> tuple[Balls, Balls]:
    """Rotation (3, 3) and position (3,) in the world of a frame, at positions (nv,) of the joints that move freely."""
    joints = as_balls(robot.couplings.matrix) @ np.array(q, dtype=object) + as_balls(robot.couplings.offset)
    number, placement = robot.frames[name]
    body = states(robot, on, list(joints), list(zeros(len(joints))))[number]
    return body.rotation @ placement.rotation, body.joint + body.rotation @ placement.translation


def system(
    robot: ExactRobot,
    q: Sequence[Any],
    v: Sequence[Any],
    tau: Sequence[Any],
    external_wrenches: Balls | None = None,
    on: ExactGround | None = None,
) -> System:
    """Eq. (111) at one state.

    external_wrenches: force and moment on each body at O_j, in link axes (n, 6)
    on: the ground, at rest if left out
    """
    on = on or ground(robot)
    at, n = states(robot, on, q, v), len(robot.bodies)
    size = (BODY_DOF + JOINT_CONSTRAINTS) * n
    matrix, rhs = zeros(size, size), zeros(size)
    for j, body in enumerate(robot.bodies, start=1):
        state, rows = at[j], slice(BODY_DOF * (j - 1), BODY_DOF * j)
        matrix[rows, rows] = _inertia(body)
        rhs[rows] = _passive(robot, body, state, None if external_wrenches is None else external_wrenches[j - 1])
        first = BODY_DOF * n + JOINT_CONSTRAINTS * (j - 1)
        held = slice(first, first + JOINT_CONSTRAINTS)
        wrenches = _held_wrenches(body, state)
        drive = (state.axes[:, 2], zeros(3)) if body.prismatic else (zeros(3), state.axes[:, 2])
        for number, sign in ((j, 1), (body.inside, -1)):
            if number == 0:
                continue
            own = slice(BODY_DOF * (number - 1), BODY_DOF * number)
            columns = np.column_stack([_on_body(at[number], state.joint, wrench) for wrench in wrenches])
            matrix[own, held] = columns * -sign
            matrix[held, own] = (columns * -sign).T
            rhs[own] = rhs[own] + _on_body(at[number], state.joint, drive) * (tau[j - 1] * sign)
        rhs[held] = np.array([_curvature(body, at[body.inside], state, v[j - 1], wrench) for wrench in wrenches])
        if body.inside == 0:
            rhs[held] = rhs[held] - np.array([_carried(on, state, wrench) for wrench in wrenches])
    return System(matrix, rhs)


def _inertia(body: ExactBody) -> Balls:
    """A_j = diag(m E, J), Eq. (37) in twist form."""
    block = zeros(BODY_DOF, BODY_DOF)
    block[:3, :3], block[3:, 3:] = eye() * body.mass, body.tensor
    return block


def _passive(robot: ExactRobot, body: ExactBody, state: BodyState, external: Balls | None) -> Balls:
    """Gravity, gyroscopic moment and external wrench (6,)."""
    omega = state.rotation.T @ state.omega
    force, moment = robot.gravity * body.mass, -cross(omega, body.tensor @ omega)
    if external is not None:
        force = force + state.rotation @ external[:3]
        moment = moment + external[3:] - cross(body.center_of_mass, external[:3])
    return np.concatenate([force, moment])


def _held_wrenches(body: ExactBody, state: BodyState) -> list[tuple[Balls, Balls]]:
    """Force and moment at O_j, in the world, of a unit of each multiplier: what the joint holds."""
    none, (first, second, axis) = zeros(3), state.axes.T
    if body.prismatic:
        return [(first, none), (second, none), (none, first), (none, second), (none, axis)]
    return [*((direction, none) for direction in eye()), (none, first), (none, second)]


def _on_body(state: BodyState, point: Balls, wrench: tuple[Balls, Balls]) -> Balls:
    """A wrench at a point as rows of a body (6,): force in world axes, moment about its center in link axes."""
    force, moment = wrench
    return np.concatenate([force, state.rotation.T @ (moment + cross(point - state.center, force))])


def _curvature(body: ExactBody, inside: BodyState, state: BodyState, rate: Any, wrench: tuple[Balls, Balls]) -> Any:
    """The entry of ζ that belongs to a held wrench: how O_j and ω_j would part from the inside body without r̈ and ω̇.

    The joint does no work on what it holds: along its force, the accelerations of both bodies at O_j agree but for
    2 ω_i × ṡ p, where it slides; along its moment, their angular accelerations but for ω_i × ω_j.
    """
    force, moment = wrench
    apart = [cross(each.omega, cross(each.omega, state.joint - each.center)) for each in (state, inside)]
    linear = apart[0] - apart[1]
    if body.prismatic:
        linear = linear - cross(inside.omega, state.axes[:, 2]) * (rate * 2)
    angular = -cross(inside.omega, state.omega)
    return force @ linear + moment @ angular + ball(0)


def _carried(on: ExactGround, state: BodyState, wrench: tuple[Balls, Balls]) -> Any:
    """The acceleration that the ground gives to O_j and to ω_j along a held wrench, but for its curvature."""
    force, moment = wrench
    return force @ (on.acceleration + cross(on.alpha, state.joint - on.position)) + moment @ on.alpha
