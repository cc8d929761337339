"""Pinocchio's answers at N states, in the order and the axes of graphdyn, each computed when it is first needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.derivation import second_derivatives
from crosscheck.reference.pinocchio_model.model import PinocchioModel
from crosscheck.reference.pinocchio_model.reactions import reaction_derivatives
from crosscheck.reference.reference_values import at_centers, multipliers_of
from crosscheck.reference.subject import compared_frames
from graphdyn import Placement, RobotModel
from graphdyn.layout import Array

_AXES = {"world": pin.WORLD, "local": pin.LOCAL, "local_world_aligned": pin.LOCAL_WORLD_ALIGNED}


@dataclass(frozen=True, eq=False)
class NativeState:
    """One state in Pinocchio's order and coordinates. forces: external wrenches, zeros where there are none"""

    q: Array
    v: Array
    a: Array
    tau: Array
    forces: pin.StdVec_Force


class PinocchioAnswers:
    """What one of Pinocchio's models answers at N states.

    model: the same robot, on the same base; q, v, a, tau: (N, n); loads: external wrenches, None for none   (N, n, 6)
    frame: the only one that functions of frames speak of; None for all that are compared
    """

    def __init__(
        self,
        robot: PinocchioModel,
        model: RobotModel,
        q: Array,
        v: Array,
        a: Array,
        tau: Array,
        loads: Array | None = None,
        frame: str | None = None,
    ):
        self.robot, self.model, self.loads, self.frame = robot, model, loads, frame
        self.q, self.v, self.a_given, self.tau_given = q, v, a, tau

    @cached_property
    def rooted(self) -> PinocchioModel:
        """The robot with its first joint at the world's origin.

        Pinocchio computes about that point, and would lose the digits of the distance. Taken for all that does not
        depend on where the robot is.
        """
        first_joint = self.robot.native.jointPlacements[self.robot.ids[0]].translation
        return self.robot.turned(Placement(np.eye(3), -first_joint), self.robot.model.gravity)

    @cached_property
    def weightless(self) -> PinocchioModel:
        """The robot without gravity, whose torques at rest are M a: with v for a, the momenta M v."""
        return self.robot.turned(Placement(), np.zeros(3))

    def each(self, compute: Callable[[PinocchioModel, NativeState], Any], robot: PinocchioModel | None = None) -> Array:
        """An answer of every state (N, …). robot: as it is if left out"""
        return np.array([compute(robot or self.robot, state) for state in self._states])

    @cached_property
    def _states(self) -> list[NativeState]:
        robot, loads = self.robot, np.zeros((*self.q.shape, 6)) if self.loads is None else self.loads
        return [
            NativeState(
                robot.configuration(q), robot.there(v), robot.there(a), robot.there(tau), robot.forces(external)
            )
            for q, v, a, tau, external in zip(self.q, self.v, self.a_given, self.tau_given, loads, strict=True)
        ]

    @cached_property
    def _inverse(self) -> tuple[Array, Array]:
        return self.required(self.a_given)

    @property
    def tau(self) -> Array:
        """rnea, with the loads   (N, n)."""
        return self._inverse[0]

    @property
    def joint_wrenches(self) -> Array:
        """data.f after it   (N, n, 6)."""
        return self._inverse[1]

    def required(self, a: Array) -> tuple[Array, Array]:
        """rnea's τ (N, n) and data.f (N, n, 6) at other accelerations a (N, n), with the loads."""
        return self.robot.inverse_dynamics(self.q, self.v, a, self.loads)

    @cached_property
    def _motion(self) -> tuple[Array, Array, Array, Array]:
        def of_one(robot: PinocchioModel, state: NativeState) -> tuple[Array, Array, Array, Array]:
            data = robot.data
            pin.forwardKinematics(robot.native, data, state.q, state.v, state.a)
            links = [data.oMi[k] for k in robot.ids]
            placed = np.array([x.rotation for x in links]), np.array([x.translation for x in links])
            return *placed, robot.spatial(data.v), robot.spatial(data.a)

        rows = zip(*(of_one(self.robot, state) for state in self._states), strict=True)
        rotation, position, velocity, acceleration = (np.array(row) for row in rows)
        return rotation, position, *at_centers(self._centers, rotation, velocity, acceleration)

    @property
    def rotation(self) -> Array:
        """Rotation of the link frames in the world   (N, n, 3, 3)."""
        return self._motion[0]

    @property
    def position(self) -> Array:
        """Position of the link frames in the world   (N, n, 3)."""
        return self._motion[1]

    @property
    def velocity(self) -> Array:
        """ṙ of the centers of mass in world axes, ω in body axes   (N, n, 6)."""
        return self._motion[2]

    @property
    def acceleration(self) -> Array:
        """r̈ of the centers of mass in world axes, ω̇ in body axes   (N, n, 6)."""
        return self._motion[3]

    @cached_property
    def a(self) -> Array:
        """aba at the given torques, with the loads   (N, n)."""
        return self.each(lambda r, x: pin.aba(r.native, r.data, x.q, x.v, x.tau, x.forces)[r.columns])

    @cached_property
    def a_wrenches(self) -> Array:
        """data.f at a, the solution of forward dynamics   (N, n, 6)."""
        return self.required(self.a)[1]

    @cached_property
    def a_body_accelerations(self) -> Array:
        """Accelerations of the bodies at a, the solution of forward dynamics   (N, n, 6)."""
        solved = PinocchioAnswers(self.robot, self.model, self.q, self.v, self.a, self.tau_given)
        return solved.acceleration

    def multipliers(self, wrenches: Array) -> Array:
        """The five of every joint (N, n, 5), of joint wrenches (N, n, 6)."""
        found: Array = multipliers_of(self.model, self.rotation, wrenches)
        return found

    @cached_property
    def mass_matrix(self) -> Array:
        """crba   (N, n, n)."""
        return self.each(lambda r, x: r.symmetric(pin.crba(r.native, r.data, x.q)))

    @cached_property
    def body_regressor(self) -> Array:
        """jointBodyRegressor   (N, n, 6, 10)."""

        def of_one(robot: PinocchioModel, state: NativeState) -> list[Array]:
            pin.rnea(robot.native, robot.data, state.q, state.v, state.a)
            return [np.array(pin.jointBodyRegressor(robot.native, robot.data, k)) for k in robot.ids]

        return self.each(of_one)

    @cached_property
    def accelerations_by_parameters(self) -> Array:
        """-M⁻¹ × the regressor at a   (N, n, 10n)."""

        def of_one(robot: PinocchioModel, state: NativeState) -> Array:
            a = np.array(pin.aba(robot.native, robot.data, state.q, state.v, state.tau))
            inverse = robot.symmetric(pin.computeMinverse(robot.native, robot.data, state.q))
            return -inverse @ robot.regressor_of(state.q, state.v, a)

        return self.each(of_one, self.rooted)

    @cached_property
    def momentum_about_origin(self) -> Array:
        """Σ of the spatial momenta of the bodies, each moved to the world's origin   (N, 6)."""

        def of_one(robot: PinocchioModel, state: NativeState) -> Array:
            native, data = robot.native, robot.data
            pin.forwardKinematics(native, data, state.q, state.v)
            total = sum((data.oMi[k].act(native.inertias[k] * data.v[k]) for k in robot.ids), pin.Force.Zero())
            return np.array(total.vector)

        return self.each(of_one)

    @cached_property
    def center_of_mass_velocity(self) -> Array:
        """vcom of centerOfMass   (N, 3)."""

        def of_one(robot: PinocchioModel, state: NativeState) -> Array:
            pin.centerOfMass(robot.native, robot.data, state.q, state.v)
            return np.array(robot.data.vcom[0])

        return self.each(of_one, self.rooted)

    @cached_property
    def second_derivatives(self) -> Mapping[str, Array]:
        """Second derivatives of the torques (N, n, n, n), by the names of their quantities."""
        states = zip(self.q, self.v, self.a_given, strict=True)
        rows = [second_derivatives(self.rooted, *state) for state in states]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    @cached_property
    def reaction_derivatives(self) -> Mapping[str, Array]:
        """Reaction derivatives of multipliers (N, n, 5, n) and joint wrenches (N, n, 6, n), by the names of their
        quantities."""
        return reaction_derivatives(self.rooted, self.q, self.v, self.a_given)

    def of_frames(self, function: str, reference: str) -> Array:
        """One of Pinocchio's functions of a frame, of the frame, or of those that are compared (N, m, …)."""
        names = (self.frame,) if self.frame else compared_frames(self.robot.model)
        compute = getattr(pin, function)

        def of_one(robot: PinocchioModel, state: NativeState) -> Array:
            native, data = robot.native, robot.data
            pin.computeJointJacobiansTimeVariation(native, data, state.q, state.v)  # the Jacobians, too
            pin.forwardKinematics(native, data, state.q, state.v, state.a)
            pin.updateFramePlacements(native, data)
            found = [compute(native, data, k, _AXES[reference]) for k in robot.frame_ids(names)]
            return np.array([x.vector if isinstance(x, pin.Motion) else robot.columns_of(x) for x in found])

        found = self.each(of_one, self.robot if reference == "world" else self.rooted)
        return found[:, 0] if self.frame else found

    @property
    def _centers(self) -> Array:
        """Centers of mass (n, 3) in link axes.

        Pinocchio loses the center of a body with zero or tiny mass, because it divides m c by at least eps; then ours
        is used, so that the same point is compared.
        """
        inertias = [self.robot.native.inertias[k] for k in self.robot.ids]
        return np.array(
            [
                inertia.lever if inertia.mass > np.finfo(float).eps else body.center_of_mass
                for inertia, body in zip(inertias, self.robot.model.bodies, strict=True)
            ]
        )
