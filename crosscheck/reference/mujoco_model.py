"""The RobotModel in MuJoCo, a second reference implementation. The only file that imports mujoco, when first needed.

Constraints, contacts, limits, damping and armature are switched off, which leaves rigid-body dynamics.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np

from graphdyn import Body, GraphDynError, RobotModel
from graphdyn.errors import not_installed
from graphdyn.layout import Array


class MujocoRefuses(GraphDynError):
    """MuJoCo is not installed, or cannot represent the robot."""


class MujocoModel:
    """One robot in MuJoCo, used with graphdyn's joint order."""

    def __init__(self, model: RobotModel):
        """Raises MujocoRefuses without the library, and for bodies without mass or with inconsistent inertia."""
        try:
            import mujoco
        except ImportError:
            raise MujocoRefuses(not_installed("mujoco", "mujoco")) from None
        self._mujoco = mujoco
        try:
            self._native = _spec(mujoco, model).compile()
        except ValueError as error:
            reason = " ".join(str(error).split())
            raise MujocoRefuses(f"MuJoCo cannot represent robot '{model.name}': {reason}") from error
        self._data = mujoco.MjData(self._native)
        joints = [self._native.joint(_joint_name(k)) for k in range(model.n_bodies)]
        self._columns = np.array([joint.dofadr[0] for joint in joints])

    def evaluate(self, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
        """τ of (q, v, a), a of (q, v, τ), and M at N states: q, v, a, tau (N, n)."""
        rows = [self._one(*state) for state in zip(q, v, a, tau, strict=True)]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    def _one(self, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
        mujoco, native, data, columns = self._mujoco, self._native, self._data, self._columns
        # one position per degree of freedom: hinge and slide
        data.qpos[columns], data.qvel[columns], data.qacc[columns] = q, v, a
        mujoco.mj_inverse(native, data)
        required = data.qfrc_inverse[columns].copy()
        data.qfrc_applied[columns] = tau
        mujoco.mj_forward(native, data)
        mass = np.empty((native.nv, native.nv))
        for column, unit in zip(mass, np.eye(native.nv), strict=True):  # symmetric: rows are columns
            mujoco.mj_mulM(native, data, column, unit)
        return {
            "inverse_dynamics": required,
            "forward_dynamics": data.qacc[columns].copy(),
            "mass_matrix": mass[np.ix_(columns, columns)],
        }

    def inverse_loop(self, q: Array, v: Array, a: Array, out: Array) -> Array:
        """mj_inverse at N states, as a user writes it: torques (N, n) in MuJoCo's order, which must be ours."""
        mj_inverse, native, data = self._mujoco.mj_inverse, self._native, self._data
        self._check_order()
        for k in range(len(q)):
            data.qpos[:] = q[k]
            data.qvel[:] = v[k]
            data.qacc[:] = a[k]
            mj_inverse(native, data)
            out[k] = data.qfrc_inverse
        return out

    def steps_loop(self, q: Array, v: Array, steps: int, width: float) -> Callable[[int], Array]:
        """run(count): these steps of mj_step, Runge-Kutta of order 4, from each of the first count states.

        What it returns: q and v at the end                 (count, 2 n)
        """
        mujoco, native = self._mujoco, copy.copy(self._native)
        self._check_order()
        native.opt.timestep, native.opt.integrator = width, mujoco.mjtIntegrator.mjINT_RK4
        data, mj_step, out = mujoco.MjData(native), mujoco.mj_step, np.empty((len(q), 2 * native.nv))

        def run(count: int) -> Array:
            for k in range(count):
                data.qpos[:] = q[k]
                data.qvel[:] = v[k]
                mj_step(native, data, steps)
                out[k, : native.nv], out[k, native.nv :] = data.qpos, data.qvel
            return out[:count]

        return run

    def rollout(self, q: Array, v: Array, tau: Array, threads: int) -> Callable[[int], Array]:
        """run(count): one step from each of the first count states, on several threads; accelerations (count, n).

        The step is one second long, so that the change of a velocity equals the acceleration.
        """
        from mujoco.rollout import Rollout

        mujoco, native = self._mujoco, copy.copy(self._native)
        self._check_order()
        native.opt.timestep = 1.0
        n, given = native.nv, mujoco.mjtState.mjSTATE_QFRC_APPLIED
        width = mujoco.mj_stateSize(native, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        start = np.concatenate([np.zeros((len(q), width - 2 * n)), q, v], axis=1)  # the time comes first
        state, sensors = np.empty((len(q), 1, width)), np.empty((len(q), 1, 0))
        data = [mujoco.MjData(native) for _ in range(threads)]
        pool = Rollout(nthread=threads if threads > 1 else 0)

        def run(count: int) -> Array:
            pool.rollout(
                native,
                data,
                start[:count],
                tau[:count, None],
                control_spec=int(given),
                nstep=1,
                skip_checks=False,
                state=state[:count],
                sensordata=sensors[:count],
            )
            change: Array = state[:count, 0, -n:] - start[:count, -n:]
            return change

        return run

    def _check_order(self) -> None:
        if not np.array_equal(self._columns, np.arange(self._native.nv)):
            raise MujocoRefuses("MuJoCo has the joints in another order")


def _spec(mujoco: Any, model: RobotModel) -> Any:
    """MuJoCo's description of the robot, with numbers as names: MuJoCo's must not contain '/'."""
    spec = mujoco.MjSpec()
    spec.option.gravity = np.array(model.gravity)
    spec.option.disableflags = (
        mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    )
    spec.compiler.degree = False
    bodies = [spec.worldbody]
    for k, (body, joint) in enumerate(zip(model.bodies, model.joints, strict=True)):
        placement = model.base @ joint.placement if joint.inside == 0 else joint.placement
        native = bodies[joint.inside].add_body(
            name=f"body_{k}", pos=placement.translation, quat=_quaternion(mujoco, placement.rotation)
        )
        _set_inertial(mujoco, native, body)
        kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.is_prismatic else mujoco.mjtJoint.mjJNT_HINGE
        native.add_joint(name=_joint_name(k), type=kind, axis=np.array(joint.axis))
        bodies.append(native)
    return spec


def _set_inertial(mujoco: Any, native: Any, body: Body) -> None:
    """Mass, center and tensor, in principal axes, the only form that MuJoCo has."""
    moments, axes = np.linalg.eigh(body.inertia)
    axes = axes * np.sign(np.linalg.det(axes))
    native.explicitinertial = True
    native.mass, native.ipos, native.inertia = body.mass, np.array(body.center_of_mass), moments
    native.iquat = _quaternion(mujoco, axes)


def _quaternion(mujoco: Any, rotation: Array) -> Array:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, rotation.ravel())
    return quaternion


def _joint_name(k: int) -> str:
    return f"joint_{k}"
