"""A model of Pinocchio, and how arrays in the order of graphdyn get in and out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.native import UNIVERSE, PinocchioRefuses, write_position
from graphdyn import RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns


class OrderedModel:
    """One robot in Pinocchio, used with graphdyn's joint order and plain joint angles.

    native, data: Pinocchio's; model: the same robot here
    ids: Pinocchio's number of each joint; columns: its place in vectors of joint velocities
    """

    def __init__(self, native: pin.Model, model: RobotModel):
        self.native, self.model = native, model
        self.data = native.createData()
        if UNIVERSE in model.joint_names:
            raise PinocchioRefuses(
                f"robot '{model.name}': Pinocchio calls the ground '{UNIVERSE}' and confuses it with the joint of this "
                "name; rename the joint"
            )
        expected, known = set(model.joint_names), set(native.names[1:])
        if expected != known:
            raise PinocchioRefuses(
                f"robot '{model.name}': Pinocchio has other joints; only here: {sorted(expected - known)}, "
                f"only there: {sorted(known - expected)}"
            )
        self.ids = [native.getJointId(name) for name in model.joint_names]
        self._joints = [native.joints[k] for k in self.ids]
        self.columns = np.array([joint.idx_v for joint in self._joints])
        native.gravity = pin.Motion(np.array(model.gravity), np.zeros(3))

    def configuration(self, q: Array) -> Array:
        """Pinocchio's q (nq,) of one state: continuous joints as (cos, sin), others as they are."""
        full = np.empty(self.native.nq)
        for joint, value in zip(self._joints, q, strict=True):
            write_position(joint, full, value)
        return full

    def there(self, values: Array) -> Array:
        """A joint-space vector in Pinocchio's order."""
        full = np.empty(self.native.nv)
        full[self.columns] = values
        return full

    def square(self, matrix: Array) -> Array:
        """A joint-space matrix (n, n) in our order; a copy, because the bindings answer views of data."""
        full = np.reshape(matrix, (self.native.nv, self.native.nv))
        return np.array(full[np.ix_(self.columns, self.columns)])

    def symmetric(self, upper: Array) -> Array:
        """A symmetric joint-space matrix (n, n) in our order, of which Pinocchio computes the upper triangle."""
        full = np.reshape(upper, (self.native.nv, self.native.nv))
        return self.square(np.triu(full) + np.triu(full, 1).T)

    def columns_of(self, matrix: Array) -> Array:
        """A matrix (6, n) with a column per joint, in our order; the bindings flatten matrices of one column."""
        return np.array(np.reshape(matrix, (-1, self.native.nv))[:, self.columns])

    def torques(self, values: Array) -> Array:
        """A joint-space vector in our order."""
        return np.array(np.reshape(values, -1)[self.columns])

    def forces(self, external: Array) -> pin.StdVec_Force:
        """External wrenches (n, 6) as Pinocchio takes them, one for each of its joints."""
        forces = pin.StdVec_Force()
        forces.extend(pin.Force.Zero() for _ in range(self.native.njoints))
        for k, wrench in zip(self.ids, external, strict=True):
            forces[k] = pin.Force(np.array(wrench))
        return forces

    def joint_wrenches(self) -> Array:
        """data.f (n, 6) of the last call of rnea."""
        return np.array([self.data.f[k].vector for k in self.ids])

    def spatial(self, vectors: pin.StdVec_Motion) -> Array:
        """data.v or data.a of the bodies (n, 6), in link axes at the link origins."""
        return np.array([vectors[k].vector for k in self.ids])

    def regressor_of(self, q: Array, v: Array, a: Array) -> Array:
        """(n, 10n) of one state in Pinocchio's order and coordinates; the bindings flatten matrices of one row."""
        flat = pin.computeJointTorqueRegressor(self.native, self.data, q, v, a)
        full = np.reshape(flat, (self.native.nv, BODY_PARAMETERS * self.native.nv))
        regressor: Array = full[np.ix_(self.columns, self._parameter_columns())]
        return regressor

    def parameters_of(self, row: Array) -> Array:
        """A number per inertial parameter (10n,) in our order."""
        return np.array(np.ravel(row)[self._parameter_columns()])

    def frame_ids(self, names: Sequence[str]) -> list[int]:
        """Numbers of the frames of links. Raises PinocchioRefuses for an unknown name."""
        unknown = [name for name in names if not self.native.existFrame(name, pin.BODY)]
        if unknown:
            raise PinocchioRefuses(f"Pinocchio has no link '{unknown[0]}'")
        return [self.native.getFrameId(name, pin.BODY) for name in names]

    def _parameter_columns(self) -> Array:
        """Column numbers of Pinocchio's regressor in graphdyn's body order."""
        every = np.arange(BODY_PARAMETERS * self.native.nv)
        return np.concatenate([every[parameter_columns(k)] for k in self.ids])
