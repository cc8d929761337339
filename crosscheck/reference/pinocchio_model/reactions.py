"""Derivatives of joint wrenches and multipliers.

Pinocchio has none. A free joint in series with every joint, held still, turns the wrench of the joint into torques of
its own, whose derivatives are those of the wrench. The multipliers are linear in the wrenches.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.model import PinocchioModel
from crosscheck.reference.pinocchio_model.native import write_position
from crosscheck.reference.reference_values import multipliers_of
from graphdyn.equations import COMPLEX_STEP_SIZE
from graphdyn.layout import ANGULAR, BODY_DOF, Array


def reaction_derivatives(robot: PinocchioModel, q: Array, v: Array, a: Array) -> dict[str, Array]:
    """∂λ (N, n, 5, n) and ∂(joint wrenches) (N, n, 6, n) by q, v and a: q, v, a (N, n).

    robot: best at the world's origin, about which Pinocchio differentiates
    """
    loosened = _Loosened(robot)
    rows = [loosened.wrench_derivatives(*state) for state in zip(q, v, a, strict=True)]
    wrenches, by_q, by_v, by_a = (np.array(column) for column in zip(*rows, strict=True))
    rotation, turning = _rotations(robot, q)
    found = {"dwrenches_dq": by_q, "dwrenches_dv": by_v, "dwrenches_da": by_a}
    for name, change in found.copy().items():
        stepped = rotation + (1j * COMPLEX_STEP_SIZE * turning if name == "dwrenches_dq" else 0)
        per_joint = np.moveaxis(change, -1, 0)
        multipliers = multipliers_of(robot.model, stepped, wrenches + 1j * COMPLEX_STEP_SIZE * per_joint)
        found[name.replace("wrenches", "multipliers")] = np.moveaxis(multipliers.imag / COMPLEX_STEP_SIZE, 0, -1)
    return found


class _Loosened:
    """The robot with a free joint behind every joint."""

    def __init__(self, robot: PinocchioModel):
        native = pin.Model()
        native.gravity = robot.native.gravity
        own, free = [0], [0]  # numbers in this model by those in the robot's
        for k in range(1, robot.native.njoints):
            inside, name = free[robot.native.parents[k]], robot.native.names[k]
            own.append(native.addJoint(inside, robot.native.joints[k], robot.native.jointPlacements[k], name))
            free.append(native.addJoint(own[k], pin.JointModelFreeFlyer(), pin.SE3.Identity(), f"{name} (free)"))
            native.inertias[free[k]] = robot.native.inertias[k]
        self._native, self._data = native, native.createData()
        self._joints = [native.joints[own[k]] for k in robot.ids]
        self._columns = np.array([joint.idx_v for joint in self._joints])
        first = np.array([native.joints[free[k]].idx_v for k in robot.ids])
        self._rows = first[:, None] + np.arange(BODY_DOF)

    def wrench_derivatives(self, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array, Array]:
        """The joint wrenches (n, 6), and their derivatives by q, v, a (n, 6, n), of one state."""
        native, data = self._native, self._data
        full_q, full_v, full_a = pin.neutral(native), np.zeros(native.nv), np.zeros(native.nv)
        for joint, value in zip(self._joints, q, strict=True):
            write_position(joint, full_q, value)
        full_v[self._columns], full_a[self._columns] = v, a
        by_q, by_v, mass = pin.computeRNEADerivatives(native, data, full_q, full_v, full_a)
        mass = np.triu(mass) + np.triu(mass, 1).T
        wrenches = pin.rnea(native, data, full_q, full_v, full_a)[self._rows]
        return wrenches, *(np.array(matrix[self._rows[..., None], self._columns]) for matrix in (by_q, by_v, mass))


def _rotations(robot: PinocchioModel, q: Array) -> tuple[Array, Array]:
    """R_0j (N, n, 3, 3) of the links, and their derivatives by every joint (n, N, n, 3, 3)."""
    native, data = robot.native, robot.data
    rotations, turning = [], []
    for row in q:
        pin.computeJointJacobians(native, data, robot.configuration(row))
        rotations.append(np.array([data.oMi[k].rotation for k in robot.ids]))
        jacobians = [pin.getJointJacobian(native, data, k, pin.LOCAL_WORLD_ALIGNED) for k in robot.ids]
        angular = np.array([robot.columns_of(jacobian)[ANGULAR] for jacobian in jacobians])  # (body, 3, joint)
        axes = np.swapaxes(rotations[-1], -1, -2)  # rows: the axes of each body
        turned = np.cross(np.moveaxis(angular, -1, 0)[:, :, None, :], axes)  # ω × each of them, per joint
        turning.append(np.swapaxes(turned, -1, -2))
    return np.array(rotations), np.moveaxis(np.array(turning), 1, 0)
