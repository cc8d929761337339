"""What Pinocchio computes for one robot, in the order and the axes of graphdyn."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.moving_base import carried
from crosscheck.reference.pinocchio_model.native import (
    PinocchioRefuses,
    built,
    held,
    kept_standard_error,
    moved,
    read,
    se3,
)
from crosscheck.reference.pinocchio_model.ordered import OrderedModel
from crosscheck.reference.reference_values import BareCalls, CarriedValues
from crosscheck.reference.subject import tip
from graphdyn import BaseMotion, Placement, RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array
from urdf import Reading
from urdf.reading import AS_IT_STANDS


class PinocchioModel(OrderedModel):
    """One robot in Pinocchio, used with graphdyn's joint order and plain joint angles.

    said: what Pinocchio's reader wrote about errors in a file that it read nevertheless
    """

    said: tuple[str, ...] = ()

    @classmethod
    def from_urdf(cls, path: Path, model: RobotModel, reading: Reading = AS_IT_STANDS) -> PinocchioModel:
        """Pinocchio's own reading of the file, with joints locked as in urdf.load. Raises PinocchioRefuses.

        The reader's output on standard error is not shown but kept in said.

        A .xacro file is expanded. Of a chain, all other joints are locked, and its base link is the ground.
        """
        if reading.repair:
            raise PinocchioRefuses("the file is repaired first, and Pinocchio reads it as it stands")
        problem, cut = None, reading.chain is not None
        with kept_standard_error() as written:
            try:
                native = read(path, reading.xacro)
                alone = cut or reading.mimic == "locked"
                others = set(native.names[1:]) - set(model.joint_names) if alone else set()
                native = held(native, dict.fromkeys(others, 0.0) | reading.locked)
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

    def carried(self, q: Array, v: Array, a: Array, tau: Array, motion: BaseMotion) -> CarriedValues:
        """Values of the robot on a moving base that moves as prescribed: q, v, a, tau (N, n)."""
        return carried(self, q, v, a, tau, motion)

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
        external_wrenches = np.zeros((*q.shape, 6)) if external_wrenches is None else external_wrenches
        torques, wrenches = [], []
        for q_k, v_k, a_k, external in zip(q, v, a, external_wrenches, strict=True):
            state = self.configuration(q_k), self.there(v_k), self.there(a_k)
            torques.append(pin.rnea(self.native, self.data, *state, self.forces(external))[self.columns])
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
        native, frame = pin.Model(native), self.model.frame(tip(self.model))
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
