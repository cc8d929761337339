"""The equations of all bodies as they stand, Eq. (111), integrated in maximal coordinates: for teaching and for checks.

Eq. (111) holds φ̈ = 0, not φ = 0: rounding and the errors of the steps let the joints drift open. "projection" moves
positions and velocities back onto φ = 0 and φ̇ = 0 after each step, by the least change in the norm of the mass terms
(Hairer and Wanner, Solving Ordinary Differential Equations II, section VII.2). "baumgarte" puts
φ̈ + 2 α φ̇ + α² φ = 0 in place of φ̈ = 0 (Baumgarte, Computer Methods in Applied Mechanics and Engineering 1, 1972).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from graphdyn.equations.joint_readings import project_accelerations, read_joints
from graphdyn.equations.kinematics import MaximalState, bias_acceleration, maximal_state
from graphdyn.equations.projected import kkt
from graphdyn.equations.system.constraints import constraints
from graphdyn.equations.system.kkt import KKTSystem
from graphdyn.equations.system.unconstrained import mass_terms
from graphdyn.errors import InvalidInput
from graphdyn.layout import ANGULAR, LINEAR, Array, per_body, stacked
from graphdyn.model.spatial import apply
from graphdyn.simulation.equations import Equations
from graphdyn.simulation.integration.events import COURSE_COLUMNS, InitialValueProblem, SimulatedCourse
from graphdyn.simulation.integration.steps import Tableau, tableau
from graphdyn.simulation.torques import whole_steps

Stabilization = Literal["projection", "baumgarte", "none"]

LAST_STEP_RESIDUAL = 1e-8
"""Residual [m, -] whose square is rounding: one Newton step from there closes the joints."""

MAX_NEWTON_PROJECTIONS = 3
"""Newton steps of a projection, at most; one is enough for the error of a step."""

BAUMGARTE_STEPS = 20
"""α is one over so many steps: errors decay within that time, and the equations stay easy to integrate."""


class Pose(NamedTuple):
    """Pose of all bodies: centers of mass r (n, 3), quaternions x, y, z, w (n, 4), velocity (n, 6); work."""

    position: Array
    quaternion: Array
    velocity: Array
    work: float


def maximal(
    problem: InitialValueProblem, method: str, step: float, stabilization: Stabilization
) -> tuple[SimulatedCourse, MaximalState]:
    """The course, with q and v as the bodies show them, and where the bodies are. Raises InvalidInput."""
    if stabilization not in ("projection", "baumgarte", "none"):
        raise InvalidInput(f"stabilization is '{stabilization}'; use 'projection', 'baumgarte' or 'none'")
    steps = whole_steps("the duration", problem.duration, step)
    wanted = range(steps + 1) if problem.at is None else {round(time / step) for time in problem.at.tolist()}
    run = _MaximalRun(problem, tableau(method), step, problem.source.steps_held(step, steps), stabilization)
    times, states, rows = [], [], []
    for number, state, row in run.steps(steps):
        problem.progress(number * step)
        if number in wanted:
            times.append(number * step)
            states.append(state)
            rows.append(row)
    position, rotation, velocity = (
        np.stack([getattr(state, name) for state in states]) for name in ("position", "rotation", "velocity")
    )
    bodies = MaximalState(problem.plant.model, position, rotation, velocity)
    return SimulatedCourse.of_rows(times, rows, (), ""), bodies


class _MaximalRun:
    """One integration."""

    def __init__(
        self, problem: InitialValueProblem, method: Tableau, step: float, hold: int, stabilization: Stabilization
    ) -> None:
        from scipy.spatial.transform import Rotation  # imported where first used: import graphdyn stays light

        self._plant, self._source, self._method, self._step = problem.plant, problem.source, method, step
        self._hold, self._equations, self._stabilization = hold, Equations(problem.plant), stabilization
        self._q, self._tau = problem.start[0], np.zeros(len(problem.start[0]))
        state = maximal_state(problem.plant.model, *problem.start, method="reproducible")
        self._pose = Pose(state.position, Rotation.from_matrix(state.rotation).as_quat(), state.velocity, 0.0)

    def steps(self, count: int) -> Iterator[tuple[int, MaximalState, dict[str, Array]]]:
        """Number, state and row of each step; the last is where the integration ends."""
        for number in range(count + 1):
            t, state = number * self._step, self._state(self._pose)
            q, v = self._joints(state)
            if self._source.function is None and number % self._hold == 0:
                self._tau = self._equations.clamped(self._source.tau_from(t, q, v))
            tau = self._torque(t, state)
            acceleration = self._acceleration(t, state, tau)
            bias = bias_acceleration(self._plant.model, q, v)
            a = project_accelerations(state, acceleration, bias)
            nothing = np.zeros(len(q))
            work = np.array([self._pose.work])
            yield number, state, dict(zip(COURSE_COLUMNS, (q, v, work, np.zeros(1), tau, a, nothing), strict=True))
            self._q = q
            if number < count:
                self._advance(t)

    def _advance(self, t: float) -> None:
        method, h, begin = self._method, self._step, self._pose
        rates: list[Pose] = []
        for c, weights in zip(method.c, method.a, strict=True):
            rates.append(self._rates(t + c * h, _moved(begin, rates, weights, h)))
        pose = _moved(begin, rates, method.b, h)
        pose = pose._replace(quaternion=pose.quaternion / np.linalg.norm(pose.quaternion, axis=-1, keepdims=True))
        self._pose = self._projected(pose) if self._stabilization == "projection" else pose

    def _rates(self, t: float, pose: Pose) -> Pose:
        state = self._state(pose)
        tau = self._torque(t, state)
        _, v = self._joints(state)
        # the derivative of a unit quaternion is ½ q ⊗ ω, ω in body axes
        turning = _times(pose.quaternion, pose.velocity[:, ANGULAR]) / 2
        acceleration = self._acceleration(t, state, tau)
        return Pose(pose.velocity[:, LINEAR], turning, acceleration, float(tau @ v))

    def _acceleration(self, t: float, state: MaximalState, tau: Array) -> Array:
        n = self._plant.model.n_bodies
        wrenches = np.zeros((n, 6))
        if self._plant.is_loaded:
            wrenches = self._equations.wrenches(t, *self._joints(state))
        system = kkt(state, tau, wrenches, bias=np.zeros((n, 6)))  # which couplings alone need
        if self._stabilization == "baumgarte":
            alpha = 1 / (BAUMGARTE_STEPS * self._step)
            rate = apply(system.constraint_jacobian, stacked(state.velocity))
            # φ̈ + 2 α φ̇ + α² φ = 0 in place of φ̈ = 0: deviations die out, critically damped
            zeta = system.zeta - 2 * alpha * rate - alpha**2 * stacked(state.constraint_residual())
            system = replace(system, zeta=zeta)
        return per_body(system.solve_unchecked().acceleration)

    def _projected(self, pose: Pose) -> Pose:
        """The nearest pose with φ = 0, and the nearest velocity with φ̇ = 0."""
        for _ in range(MAX_NEWTON_PROJECTIONS):
            state = self._state(pose)
            residual = state.constraint_residual()
            phi_q, _ = constraints(state)
            change = per_body(_least(state, phi_q, -stacked(residual)))
            quaternion = pose.quaternion + _times(pose.quaternion, change[:, ANGULAR]) / 2
            quaternion /= np.linalg.norm(quaternion, axis=-1, keepdims=True)
            pose = pose._replace(position=pose.position + change[:, LINEAR], quaternion=quaternion)
            if np.abs(residual).max() < LAST_STEP_RESIDUAL:
                break
        state = self._state(pose)
        phi_q, _ = constraints(state)
        change = per_body(_least(state, phi_q, -apply(phi_q, stacked(pose.velocity))))
        return pose._replace(velocity=pose.velocity + change)

    def _torque(self, t: float, state: MaximalState) -> Array:
        if self._source.function is None:
            return self._tau
        return self._equations.clamped(self._source.tau_at(t, *self._joints(state)))

    def _state(self, pose: Pose) -> MaximalState:
        from scipy.spatial.transform import Rotation

        rotation = Rotation.from_quat(pose.quaternion).as_matrix()
        return MaximalState(self._plant.model, pose.position, rotation, pose.velocity)

    def _joints(self, state: MaximalState) -> tuple[Array, Array]:
        """q and v as the bodies show them, the angles without jumps."""
        q, v = read_joints(state)
        turning = np.array([not joint.is_prismatic for joint in self._plant.model.joints])
        # bodies show angles up to whole turns: those nearest to the last step are taken
        turns = np.round((self._q - q) / (2 * np.pi)) * turning
        return q + 2 * np.pi * turns, v


def _least(state: MaximalState, phi_q: Array, right: Array) -> Array:
    """The least change x (6n,), in the norm of A, with φ_q x = right."""
    nothing = np.zeros(phi_q.shape[-1])
    return KKTSystem(mass_terms(state), phi_q, nothing, right).solve_unchecked().acceleration


def _moved(begin: Pose, rates: list[Pose], weights: Array, h: float) -> Pose:
    """The pose plus h times the weighted rates."""
    pose = begin
    for weight, rate in zip((h * weights).tolist(), rates, strict=False):
        pose = Pose(
            pose.position + weight * rate.position,
            pose.quaternion + weight * rate.quaternion,
            pose.velocity + weight * rate.velocity,
            pose.work + weight * rate.work,
        )
    return pose


def _times(quaternion: Array, vector: Array) -> Array:
    """The quaternion product with vectors (n, 3), as quaternions without real part."""
    u, w = quaternion[:, :3], quaternion[:, 3:]
    return np.concatenate([w * vector + np.cross(u, vector), -(u * vector).sum(axis=-1, keepdims=True)], axis=-1)
