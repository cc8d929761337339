"""What Pinocchio computes for one robot, in the order and the axes of graphdyn."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import repeat
from pathlib import Path

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.native import (
    UNIVERSE,
    PinocchioRefuses,
    built,
    held,
    kept_standard_error,
    moved,
    read,
    se3,
    with_kinds_for_axes,
    write_position,
)
from crosscheck.reference.reference_values import BareCalls
from crosscheck.reference.subject import tip
from graphdyn import Placement, RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns
from urdf import Reading
from urdf.reading import AS_IT_STANDS, held_positions


class PinocchioModel:
    """One robot in Pinocchio, used with graphdyn's joint order and plain joint angles.

    native, data: Pinocchio's; model: the same robot here
    ids: Pinocchio's number of each joint; columns: its place in vectors of joint velocities
    said: what Pinocchio's reader wrote about errors in a file that it read nevertheless
    """

    said: tuple[str, ...] = ()

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

    @classmethod
    def from_urdf(cls, path: Path, model: RobotModel, reading: Reading = AS_IT_STANDS) -> PinocchioModel:
        """Pinocchio's own reading of the file. Raises PinocchioRefuses.

        Joints that stand still in urdf.load do so here: locked ones, and those that only such joints drive.

        The reader's output on standard error is not shown but kept in said.

        A .xacro file is expanded. Of a chain, all other joints are locked, and its base link is the ground.
        """
        if reading.repair:
            raise PinocchioRefuses("the file is repaired first, and Pinocchio reads it as it stands")
        problem, cut = None, reading.chain is not None
        with kept_standard_error() as written:
            try:
                native = read(path, reading.xacro)
                others = set(native.names[1:]) - set(model.joint_names)
                still = held_positions(path, reading) if others else {}
                at = {name: still.get(name, 0.0) for name in others if cut or name in still}
                native = held(native, at)
            except Exception as error:  # Pinocchio raises bare C++ exceptions of several types
                problem = error
        said = tuple(" ".join(line.split()) for line in written if line.startswith("Error"))
        if problem is not None:
            raise PinocchioRefuses(f"Pinocchio cannot read {path}: {str(problem).strip()}", said) from problem
        pinocchio = cls(native, model)
        pinocchio.frame_ids([frame.name for frame in model.frames])
        if cut:
            there = native.frames[native.getFrameId(model.base_name, pin.BODY)].placement
            pinocchio = pinocchio.turned(Placement(there.rotation, there.translation).inverse(), model.gravity)
        pinocchio.said = said
        return pinocchio

    @classmethod
    def from_model(cls, model: RobotModel) -> PinocchioModel:
        """Pinocchio's model of the RobotModel, built body by body through its API."""
        return cls(built(model), model).turned(model.base, model.gravity)

    def turned(self, base: Placement, gravity: Array) -> PinocchioModel:
        """The same robot with its ground frame moved by the placement base, under another gravity."""
        return PinocchioModel(moved(self.native, base), self.model.with_gravity(gravity))

    def frame_placements(self, q: Array, names: Sequence[str]) -> tuple[Array, Array]:
        """Rotations (N, m, 3, 3) and positions (N, m, 3) of links by name. Raises PinocchioRefuses if unknown."""
        ids = self.frame_ids(names)
        rotations, positions = [], []
        for row in q:
            pin.framesForwardKinematics(self.native, self.data, self.configuration(row))
            # copied: these are views of data, which the next state overwrites
            rotations.append(np.array([self.data.oMf[k].rotation for k in ids]))
            positions.append(np.array([self.data.oMf[k].translation for k in ids]))
        return np.array(rotations), np.array(positions)

    def rnea(self, q: Array, v: Array, a: Array) -> Array:
        """τ (N, n) of N states."""
        return self.joint_torques("rnea", q, v, a)

    def inverse_dynamics(
        self, q: Array, v: Array, a: Array, external_wrenches: Array | None = None
    ) -> tuple[Array, Array]:
        """rnea's τ (N, n) and joint wrenches, data.f (N, n, 6), at N states."""
        none = self.forces(np.zeros((q.shape[-1], 6)))
        loads = repeat(none, len(q)) if external_wrenches is None else map(self.forces, external_wrenches)
        torques, wrenches = [], []
        for q_k, v_k, a_k, forces in zip(q, v, a, loads, strict=True):
            state = self.configuration(q_k), self.there(v_k), self.there(a_k)
            torques.append(pin.rnea(self.native, self.data, *state, forces)[self.columns])
            wrenches.append(self.joint_wrenches())
        return np.array(torques).reshape(q.shape), np.array(wrenches).reshape(*q.shape, 6)

    def joint_torques(self, function: str, q: Array, *rates: Array) -> Array:
        """The torque or force of each joint (N, n) that a function of Pinocchio returns at N states.

        function: its name; q, rates: its arguments q, or q and v, or q, v and a   (N, n)
        """
        compute = getattr(pin, function)
        rows = [
            compute(self.native, self.data, self.configuration(q_k), *map(self.there, rates_k))
            for q_k, *rates_k in zip(q, *rates, strict=True)
        ]
        return np.array(rows).reshape(q.shape)[..., self.columns]

    def torque_regressor(self, q: Array, v: Array, a: Array) -> Array:
        """computeJointTorqueRegressor at N states (N, n, 10n)."""
        rows = [
            self.regressor_of(self.configuration(q_k), self.there(v_k), self.there(a_k))
            for q_k, v_k, a_k in zip(q, v, a, strict=True)
        ]
        return np.array(rows).reshape(*q.shape, BODY_PARAMETERS * q.shape[-1])

    def bare_calls(self) -> BareCalls:
        """Pinocchio's own functions, without any code of this class. Raises PinocchioRefuses.

        They take arrays in Pinocchio's order, which must be that of graphdyn.
        """
        native = self.native
        if native.nq != native.nv or not np.array_equal(self.columns, np.arange(native.nv)):
            raise PinocchioRefuses(f"robot '{self.model.name}': Pinocchio has other coordinates, or another order")
        native, frame = with_kinds_for_axes(native), self.model.frame(tip(self.model))
        joint, kind = self.ids[frame.body - 1], pin.FrameType.OP_FRAME
        number = native.addFrame(pin.Frame("tip", joint, se3(frame.placement), kind))
        return BareCalls(
            model=native,
            data=native.createData(),
            rnea=pin.rnea,
            aba=pin.aba,
            torque_regressor=pin.computeJointTorqueRegressor,
            rnea_derivatives=pin.computeRNEADerivatives,
            aba_derivatives=pin.computeABADerivatives,
            tip=(number, pin.LOCAL_WORLD_ALIGNED),
            rnea_in_parallel=pin.rneaInParallel,
            aba_in_parallel=pin.abaInParallel,
            pool=lambda threads: pin.ModelPool(native, threads),
        )

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
