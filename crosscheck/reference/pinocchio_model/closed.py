"""Robots with loops in Pinocchio: its constrained dynamics, with points that are held together.

Carpentier, Budhiraja and Mansard, "Proximal and sparse resolution of constrained dynamic equations", Robotics: Science
and Systems, 2021.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.model import PinocchioModel
from crosscheck.reference.pinocchio_model.native import se3
from graphdyn import Chord
from graphdyn.layout import Array

POINT_CHORD_KINDS = ("hinge", "ball", "weld")
"""Chords that can be held by points; a slide and a distance cannot."""

CLOSURE_ACCURACY, MAX_CLOSURE_ITERATIONS = 1e-14, 30
"""Accuracy and iterations of the proximal method, whose accuracy only ends it early."""

POINT_DISTANCES = (0.01, 0.1, 1.0)
"""Distances of a chord's further points [m], in the order in which they are tried."""

CLOSURE_MUS = (1e-10, 1e-8, 1e-12)
"""Values of μ, tried at each distance. With redundant rows and μ = 0 Pinocchio is silently wrong; with links of 7 mg on
a delta robot it is NaN for most of these."""

MAX_CORRECTION = 1e-4
"""Largest correction of an answer, relative to it: what the proximal method leaves open is below 1e-5, wrong answers
are off by themselves."""

REFINEMENTS = 3
"""Each leaves some 1e-6 of the error that it finds; what remains is the rounding of the residuals."""

POINT_RANK_TOLERANCE = 1e-8
"""Singular values of the Jacobian of the points below this part of the largest count as zero: far above rounding, far
below those of points a hundredth of a link apart."""


@dataclass(frozen=True, eq=False)
class ClosedState:
    """A state of a tree with chords, in Pinocchio's order.

    q, v: its configuration and velocities; tau: joint torques; external_wrenches: on the bodies, in graphdyn's order
    """

    q: Array
    v: Array
    tau: Array
    external_wrenches: Array


def closed_dynamics(
    robot: PinocchioModel, chords: tuple[Chord, ...], q: Array, v: Array, tau: Array, external_wrenches: Array
) -> tuple[Array, Array]:
    """Accelerations (n,) and joint wrenches data.f (n, 6) at one state of a tree with chords.

    Of redundant constraints the joint wrenches are those of the smallest forces at the points. Where constraintDynamics
    finds no answer, as with links without mass, the corrections start from zero.
    """
    state = ClosedState(robot.configuration(q), robot.there(v), robot.there(tau), external_wrenches)
    mass, free_torques = _mass(robot, state), state.tau - _torques_of_loads(robot, state)
    for apart in POINT_DISTANCES:
        held = _Held.at(robot, tuple(_points(robot, chords, apart)), state, mass)
        for mu in CLOSURE_MUS:
            a, forces = _solved(robot, held.points, mu, state, free_torques)
            if np.isfinite(a).all():
                refined, wrenches, correction = held.refined(a, forces)
                if correction <= MAX_CORRECTION * np.abs(a).max():
                    return refined, wrenches
    return held.refined(np.zeros_like(state.v), np.zeros((len(held.points), 3)))[:2]


def _mass(robot: PinocchioModel, state: ClosedState) -> Array:
    upper = np.triu(pin.crba(robot.native, robot.data, state.q))
    return np.asarray(upper + np.triu(upper, 1).T)


def _torques_of_loads(robot: PinocchioModel, state: ClosedState) -> Array:
    """What the external wrenches take at the joints (nv,), as torques that would hold them."""
    native, still = robot.native, np.zeros(robot.native.nv)
    loaded = pin.rnea(native, robot.data, state.q, still, still, robot.forces(state.external_wrenches))
    return np.asarray(loaded - pin.rnea(native, robot.data, state.q, still, still))


def _solved(
    robot: PinocchioModel,
    points: tuple[pin.RigidConstraintModel, ...],
    mu: float,
    state: ClosedState,
    torques: Array,
) -> tuple[Array, Array]:
    """Accelerations (nv,) and forces at the points, on body i (n_points, 3), under torques (nv,) without loads."""
    native = robot.native
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for point in points:
        models.append(point)
        datas.append(point.createData())
    data = native.createData()
    pin.initConstraintDynamics(native, data, models, datas)
    settings = pin.ProximalSettings(CLOSURE_ACCURACY, mu, MAX_CLOSURE_ITERATIONS)
    a = pin.constraintDynamics(native, data, state.q, state.v, torques, models, datas, settings)
    return np.array(a), np.array([found.contact_force.linear for found in datas])


@dataclass(frozen=True, eq=False)
class _Held:
    """Points held together at a state: M, J⁺ (nv, 3 n_points) and the motions that keep J v = 0 (nv, f)."""

    robot: PinocchioModel
    points: tuple[pin.RigidConstraintModel, ...]
    state: ClosedState
    mass: Array
    inverse: Array
    free: Array

    @classmethod
    def at(
        cls, robot: PinocchioModel, points: tuple[pin.RigidConstraintModel, ...], state: ClosedState, mass: Array
    ) -> _Held:
        left, values, right = np.linalg.svd(_jacobian(robot, points, state.q))
        rank = int(np.count_nonzero(values > POINT_RANK_TOLERANCE * values[0]))
        inverse = (right[:rank].T / values[:rank]) @ left[:, :rank].T
        return cls(robot, points, state, mass, inverse, right[rank:].T)

    def refined(self, a: Array, forces: Array) -> tuple[Array, Array, float]:
        """Accelerations and joint wrenches after REFINEMENTS corrections, and the largest entry of the first one.

        M δa - Jᵀ δf = τ - rnea(q, v, a, f) and J δa = -(what the points accelerate apart), with Pinocchio's M, J, rnea.
        """
        corrections = list[float]()
        for _ in range(REFINEMENTS):
            apart, missing = self._residuals(a, forces)
            start = -self.inverse @ apart
            pushed = self.free.T @ (missing - self.mass @ start)
            step = start + self.free @ np.linalg.solve(self.free.T @ self.mass @ self.free, pushed)
            corrections.append(float(np.abs(step).max()))
            a, forces = a + step, forces + (self.inverse.T @ (self.mass @ step - missing)).reshape(-1, 3)
        self._residuals(a, forces)  # leaves the joint wrenches of these
        return a[self.robot.columns], self.robot.joint_wrenches(), corrections[0]

    def _residuals(self, a: Array, forces: Array) -> tuple[Array, Array]:
        """How the points accelerate apart (3 n_points,), and which torques are missing (nv,)."""
        robot, state = self.robot, self.state
        apart, loads = _moved_apart(robot, self.points, state, a), _loads(robot, self.points, state, forces)
        return apart, state.tau - pin.rnea(robot.native, robot.data, state.q, state.v, a, loads)


def _ends(robot: PinocchioModel, point: pin.RigidConstraintModel) -> tuple[pin.SE3, pin.SE3]:
    """Placements of the point's two ends in the world."""
    at = robot.data.oMi
    return at[point.joint1_id] * point.joint1_placement, at[point.joint2_id] * point.joint2_placement


def _moved_apart(
    robot: PinocchioModel, points: tuple[pin.RigidConstraintModel, ...], state: ClosedState, a: Array
) -> Array:
    """Acceleration of every point of body i relative to that of body j, in axes of i (3 n_points,)."""
    pin.forwardKinematics(robot.native, data := robot.data, state.q, state.v, a)
    apart = []
    for point in points:
        on_i, on_j = (
            pin.classicAcceleration(data.v[joint], data.a[joint], placement)
            for joint, placement in (
                (point.joint1_id, point.joint1_placement),
                (point.joint2_id, point.joint2_placement),
            )
        )
        i, j = _ends(robot, point)
        apart.append(on_i - i.rotation.T @ j.rotation @ on_j)
    return np.concatenate(apart)


def _jacobian(robot: PinocchioModel, points: tuple[pin.RigidConstraintModel, ...], q: Array) -> Array:
    """Jacobian of the velocities at which the points move apart, in axes of i (3 n_points, nv)."""
    pin.computeJointJacobians(robot.native, robot.data, q)
    rows = []
    for point in points:
        point.calc(robot.native, robot.data, held := point.createData())
        rows.append(pin.getConstraintJacobian(robot.native, robot.data, point, held))
    return np.vstack(rows)


def _loads(
    robot: PinocchioModel, points: tuple[pin.RigidConstraintModel, ...], state: ClosedState, forces: Array
) -> pin.StdVec_Force:
    """All forces on the bodies: the external ones, and those at the points."""
    pin.forwardKinematics(robot.native, robot.data, state.q)
    loads = robot.forces(state.external_wrenches)
    for point, linear in zip(points, forces, strict=True):
        on_i, (i, j) = pin.Force(linear, np.zeros(3)), _ends(robot, point)
        loads[point.joint1_id] += point.joint1_placement.act(on_i)
        loads[point.joint2_id] -= point.joint2_placement.act(j.actInv(i.act(on_i)))
    return loads


def _points(robot: PinocchioModel, chords: tuple[Chord, ...], apart: float) -> Iterator[pin.RigidConstraintModel]:
    """The constraints that hold each chord's points together."""
    for chord in chords:
        (joint_i, at_i), (joint_j, at_j) = (
            (robot.ids[body - 1] if body else 0, _on_body(robot, body, se3(placement)))
            for body, placement in ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j))
        )
        for point in _held_together(chord, apart):
            there = pin.SE3(np.eye(3), point)
            yield pin.RigidConstraintModel(
                pin.ContactType.CONTACT_3D,
                robot.native,
                joint_i,
                at_i * there,
                joint_j,
                at_j * there,
                pin.ReferenceFrame.LOCAL,
            )


def _held_together(chord: Chord, apart: float) -> list[Array]:
    """Points that both bodies share, in axes of the chord [m]: the origin, and others apart from it.

    Not six constraints for a weld, which are NaN where a closing body has no mass.
    """
    further = {"hinge": [chord.triad[:, 2]], "ball": [], "weld": [chord.triad[:, 0], chord.triad[:, 1]]}
    return [np.zeros(3), *(apart * direction for direction in further[chord.kind])]


def _on_body(robot: PinocchioModel, body: int, placement: pin.SE3) -> pin.SE3:
    """Placement on the body; on the ground from the robot's mounting, which Pinocchio's universe does not have."""
    return placement if body else se3(robot.model.base) * placement
