"""The robot on a moving base that moves as prescribed."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.model import PinocchioModel
from crosscheck.reference.reference_values import CarriedValues
from graphdyn import BaseMotion
from graphdyn.layout import Array


def carried(robot: PinocchioModel, q: Array, v: Array, a: Array, tau: Array, motion: BaseMotion) -> CarriedValues:
    """A free joint in front of the robot, whose position, velocity and acceleration are imposed.

    q, v, a, tau (N, n); motion with N rows, or one for all
    """
    native, moving_base = _on_moving_base(robot.native)
    data, rows = native.createData(), []
    columns = robot.columns + moving_base.nv
    ids = [native.getJointId(name) for name in robot.model.joint_names]
    for k in range(len(q)):
        placement, velocity, acceleration = _imposed(motion, k)
        full_q = np.concatenate([pin.SE3ToXYZQUAT(placement), robot.configuration(q[k])])
        full_v, full_a = (
            np.concatenate([at_base, robot.there(x[k])]) for at_base, x in ((velocity, v), (acceleration, a))
        )
        required = pin.rnea(native, data, full_q, full_v, full_a)[columns]
        wrenches = np.array([data.f[j].vector for j in ids])
        mass = pin.crba(native, data, full_q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(native, data, full_q, full_v)
        pushed = bias[columns] + mass[np.ix_(columns, np.arange(moving_base.nv))] @ acceleration
        rows.append((required, wrenches, np.linalg.solve(mass[np.ix_(columns, columns)], tau[k] - pushed)))
    return CarriedValues(*(np.array(column) for column in zip(*rows, strict=True)))


def _on_moving_base(robot: pin.Model) -> tuple[pin.Model, pin.JointModelFreeFlyer]:
    moving_base = pin.JointModelFreeFlyer()
    front = pin.Model()
    front.gravity = robot.gravity
    front.addJoint(0, moving_base, pin.SE3.Identity(), "moving_base")
    front.addFrame(pin.Frame("moving_base", 1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    whole = pin.appendModel(front, robot, front.getFrameId("moving_base"), pin.SE3.Identity())
    whole.gravity = robot.gravity
    return whole, moving_base


def _imposed(motion: BaseMotion, k: int) -> tuple[pin.SE3, Array, Array]:
    """Placement, spatial velocity and spatial acceleration of the moving base in its own axes (6,), of row k."""
    rotation, translation, velocity, acceleration = (
        (x if x.ndim == trailing else x[k])
        for x, trailing in (
            (motion.rotation, 2),
            (motion.translation, 1),
            (motion.velocity, 1),
            (motion.acceleration, 1),
        )
    )
    linear, angular = velocity[:3], velocity[3:]
    at_point = acceleration[:3] - np.cross(angular, linear)  # spatial: without the term ω × ṗ of a moving point
    turn = rotation.T
    return (
        pin.SE3(rotation, translation),
        np.concatenate([turn @ linear, turn @ angular]),
        np.concatenate([turn @ at_point, turn @ acceleration[3:]]),
    )
