"""The reference implementation: the same robot in Pinocchio. The only file that imports it.

There are two routes: Pinocchio reads the URDF file itself (which checks our import), or its model is built from our
RobotModel through its API (which checks our dynamics). Results are returned in the order and the axes of graphdyn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from crosscheck.referee.reference_values import (
    BareCalls,
    CarriedValues,
    DerivedValues,
    RefereeValues,
    at_centers,
)
from crosscheck.referee.standard_error import kept_standard_error
from crosscheck.referee.subject import tip
from graphdyn import BaseMotion, Body, GraphDynError, Placement, RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns
from urdf._opening import content_of

VERSION: str = pin.__version__


GROUND = "universe"
"""Name of joint 0 in every model of Pinocchio, which finds joints by name."""


class PinocchioRefuses(GraphDynError, ValueError):
    """Pinocchio cannot build this file, or builds a robot with other joints or links.

    said: what its reader wrote about the file
    """

    def __init__(self, problem: str, said: tuple[str, ...] = ()):
        self.said = said
        super().__init__(problem)


class PinocchioModel:
    """One robot in Pinocchio, used with graphdyn's joint order and plain joint angles.

    said: what Pinocchio's reader wrote about errors in a file that it read nevertheless
    """

    said: tuple[str, ...] = ()

    def __init__(self, native: pin.Model, model: RobotModel):
        self._native, self._model = native, model
        self._data = native.createData()
        if GROUND in model.joint_names:
            raise PinocchioRefuses(
                f"robot '{model.name}': Pinocchio calls the ground '{GROUND}' and confuses it with the joint of this "
                "name; rename the joint"
            )
        expected, known = set(model.joint_names), set(native.names[1:])
        if expected != known:
            raise PinocchioRefuses(
                f"robot '{model.name}': Pinocchio has other joints; only here: {sorted(expected - known)}, "
                f"only there: {sorted(known - expected)}"
            )
        self._ids = [native.getJointId(name) for name in model.joint_names]
        self._joints = [native.joints[k] for k in self._ids]
        self._columns = np.array([joint.idx_v for joint in self._joints])
        native.gravity = pin.Motion(np.array(model.gravity), np.zeros(3))

    @classmethod
    def from_urdf(cls, path: Path, model: RobotModel, lock: Mapping[str, float], cut: bool = False) -> PinocchioModel:
        """Pinocchio's own reading of the file, with joints locked as in urdf.load. Raises PinocchioRefuses.

        The reader's output on standard error is not shown but kept in said.

        A .xacro file is expanded. cut: the model is a chain; all other joints are locked, its base link is the ground.
        """
        problem = None
        with kept_standard_error() as written:
            try:
                xacro = path.suffix.lower() == ".xacro"
                native = (
                    pin.buildModelFromXML(content_of(path).decode()) if xacro else pin.buildModelFromUrdf(str(path))
                )
                others = set(native.names[1:]) - set(model.joint_names) if cut else set()
                native = _held(native, dict.fromkeys(others, 0.0) | dict(lock))
            except Exception as error:  # Pinocchio raises bare C++ exceptions of several types
                problem = error
        said = tuple(" ".join(line.split()) for line in written if line.startswith("Error"))
        if problem is not None:
            raise PinocchioRefuses(f"Pinocchio cannot read {path}: {str(problem).strip()}", said) from problem
        referee = cls(native, model)
        referee._frame_ids([frame.name for frame in model.frames])
        if cut:
            there = native.frames[native.getFrameId(model.base_name, pin.BODY)].placement
            referee = referee.turned(Placement(there.rotation, there.translation).inverse(), model.gravity)
        referee.said = said
        return referee

    @classmethod
    def from_model(cls, model: RobotModel) -> PinocchioModel:
        """Pinocchio's model of the RobotModel, built body by body through its API."""
        native = pin.Model()
        native.name = model.name
        ids = {0: 0}

        def add_outside(i: int) -> None:  # depth first: Pinocchio's algorithms rely on that order
            for j in model.graph.outside(i):
                joint, body = model.joints[j - 1], model.bodies[j - 1]
                # a continuous joint is a plain angle here: the (cos, sin) joint takes no axis in the Python bindings
                kind = pin.JointModelPrismaticUnaligned if joint.is_prismatic else pin.JointModelRevoluteUnaligned
                ids[j] = native.addJoint(ids[i], kind(np.array(joint.axis)), _se3(joint.placement), joint.name)
                native.appendBodyToJoint(ids[j], _inertia(body), pin.SE3.Identity())
                add_outside(j)

        add_outside(0)
        return cls(native, model).turned(model.base, model.gravity)

    def turned(self, base: Placement, gravity: Array) -> PinocchioModel:
        """The same robot with its ground frame moved by the placement base, under another gravity."""
        native = pin.Model(self._native)
        for k in range(1, native.njoints):
            if native.parents[k] == 0:
                native.jointPlacements[k] = _se3(base) * native.jointPlacements[k]
        for k, frame in enumerate(native.frames):
            if frame.parentJoint == 0:
                native.frames[k].placement = _se3(base) * frame.placement
        return PinocchioModel(native, self._model.with_gravity(gravity))

    def carried(self, q: Array, v: Array, a: Array, tau: Array, motion: BaseMotion) -> CarriedValues:
        """The robot on a carriage: a free joint in front whose position, velocity and acceleration are imposed.

        q, v, a, tau (N, n); motion with N rows, or one for all
        """
        native, carriage = self._on_carriage()
        data, rows = native.createData(), []
        columns = self._columns + carriage.nv
        ids = [native.getJointId(name) for name in self._model.joint_names]
        for k in range(len(q)):
            placement, velocity, acceleration = _imposed(motion, k)
            full_q = np.concatenate([pin.SE3ToXYZQUAT(placement), self.configuration(q[k])])
            full_v, full_a = (
                np.concatenate([at_base, self._there(x[k])]) for at_base, x in ((velocity, v), (acceleration, a))
            )
            required = pin.rnea(native, data, full_q, full_v, full_a)[columns]
            wrenches = np.array([data.f[j].vector for j in ids])
            mass = pin.crba(native, data, full_q)
            mass = np.triu(mass) + np.triu(mass, 1).T
            bias = pin.nonLinearEffects(native, data, full_q, full_v)
            pushed = bias[columns] + mass[np.ix_(columns, np.arange(carriage.nv))] @ acceleration
            rows.append((required, wrenches, np.linalg.solve(mass[np.ix_(columns, columns)], tau[k] - pushed)))
        return CarriedValues(*(np.array(column) for column in zip(*rows, strict=True)))

    def _on_carriage(self) -> tuple[pin.Model, pin.JointModelFreeFlyer]:
        carriage = pin.JointModelFreeFlyer()
        front = pin.Model()
        front.gravity = self._native.gravity
        front.addJoint(0, carriage, pin.SE3.Identity(), "carriage")
        front.addFrame(pin.Frame("carriage", 1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
        whole = pin.appendModel(front, self._native, front.getFrameId("carriage"), pin.SE3.Identity())
        whole.gravity = self._native.gravity
        return whole, carriage

    def frame_placements(self, q: Array, names: Sequence[str]) -> tuple[Array, Array]:
        """Rotations (N, m, 3, 3) and positions (N, m, 3) of links by name. Raises PinocchioRefuses if unknown."""
        ids = self._frame_ids(names)
        rotations, positions = [], []
        for row in q:
            pin.framesForwardKinematics(self._native, self._data, self.configuration(row))
            # copied: these are views of data, which the next state overwrites
            rotations.append(np.array([self._data.oMf[k].rotation for k in ids]))
            positions.append(np.array([self._data.oMf[k].translation for k in ids]))
        return np.array(rotations), np.array(positions)

    def _frame_ids(self, names: Sequence[str]) -> list[int]:
        unknown = [name for name in names if not self._native.existFrame(name, pin.BODY)]
        if unknown:
            raise PinocchioRefuses(f"Pinocchio has no link '{unknown[0]}'")
        return [self._native.getFrameId(name, pin.BODY) for name in names]

    def configuration(self, q: Array) -> Array:
        """Pinocchio's q (nq,) of one state: continuous joints as (cos, sin), others as they are."""
        full = np.empty(self._native.nq)
        for joint, value in zip(self._joints, q, strict=True):
            _write(joint, full, value)
        return full

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
            state = self.configuration(q_k), self._there(v_k), self._there(a_k)
            torques.append(pin.rnea(self._native, self._data, *state, self._forces(external))[self._columns])
            wrenches.append(self._joint_wrenches())
        return np.array(torques).reshape(q.shape), np.array(wrenches).reshape(*q.shape, 6)

    def joint_torques(self, function: str, q: Array, *rates: Array) -> Array:
        """The torque or force of each joint (N, n) that a function of Pinocchio returns at N states.

        function: its name; q, rates: its arguments q, or q and v, or q, v and a   (N, n)
        """
        compute = getattr(pin, function)
        rows = [
            compute(self._native, self._data, self.configuration(q_k), *map(self._there, rates_k))
            for q_k, *rates_k in zip(q, *rates, strict=True)
        ]
        return np.array(rows).reshape(q.shape)[..., self._columns]

    def torque_regressor(self, q: Array, v: Array, a: Array) -> Array:
        """computeJointTorqueRegressor at N states (N, n, 10n)."""
        rows = [
            self._torque_regressor(self.configuration(q_k), self._there(v_k), self._there(a_k))
            for q_k, v_k, a_k in zip(q, v, a, strict=True)
        ]
        return np.array(rows).reshape(*q.shape, BODY_PARAMETERS * q.shape[-1])

    def bare_calls(self) -> BareCalls:
        """Pinocchio's own functions, without any code of this class. Raises PinocchioRefuses.

        They take arrays in Pinocchio's order, which must be that of graphdyn.
        """
        native = self._native
        if native.nq != native.nv or not np.array_equal(self._columns, np.arange(native.nv)):
            raise PinocchioRefuses(f"robot '{self._model.name}': Pinocchio has other coordinates, or another order")
        native, frame = pin.Model(native), self._model.frame(tip(self._model))
        joint, kind = self._ids[frame.body - 1], pin.FrameType.OP_FRAME
        number = native.addFrame(pin.Frame("tip", joint, _se3(frame.placement), kind))
        return BareCalls(
            model=native,
            data=native.createData(),
            rnea=pin.rnea,
            aba=pin.aba,
            torque_regressor=pin.computeJointTorqueRegressor,
            rnea_derivatives=pin.computeRNEADerivatives,
            aba_derivatives=pin.computeABADerivatives,
            mass_matrix_inverse=pin.computeMinverse,
            coriolis_matrix=pin.computeCoriolisMatrix,
            kinetic_energy=pin.computeKineticEnergy,
            frame_jacobian=pin.computeFrameJacobian,
            tip=(number, pin.LOCAL_WORLD_ALIGNED),
            rnea_in_parallel=pin.rneaInParallel,
            aba_in_parallel=pin.abaInParallel,
            pool=lambda threads: pin.ModelPool(native, threads),
        )

    def evaluate(self, q: Array, v: Array, a: Array, tau: Array, external_wrenches: Array) -> RefereeValues:
        """All reference values at N states: q, v, a, tau (N, n), external_wrenches (N, n, 6)."""
        rows = [self._evaluate_one(*state) for state in zip(q, v, a, tau, external_wrenches, strict=True)]
        values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        rotation, velocity = values["rotation"], values["velocity"]
        # still spatial vectors; moved to the centers of mass for all states at once
        centers = self._centers()
        _, forward = at_centers(centers, rotation, velocity, values["a_body_accelerations"])
        values["velocity"], values["acceleration"] = at_centers(centers, rotation, velocity, values["acceleration"])
        return RefereeValues(**{**values, "a_body_accelerations": forward})

    def _evaluate_one(self, q: Array, v: Array, a: Array, tau: Array, external: Array) -> dict[str, Array]:
        native, data, columns = self._native, self._data, self._columns
        q, v, a, tau = self.configuration(q), self._there(v), self._there(a), self._there(tau)
        forces = self._forces(external)
        row = {}
        row["tau_external"] = pin.rnea(native, data, q, v, a, forces)[columns]
        row["joint_wrenches_external"] = self._joint_wrenches()
        row["tau"] = pin.rnea(native, data, q, v, a)[columns]
        row["joint_wrenches"] = self._joint_wrenches()
        mass = np.triu(np.reshape(pin.crba(native, data, q), (native.nv, native.nv)))
        mass = mass + np.triu(mass, 1).T
        row["mass_matrix"] = mass[np.ix_(columns, columns)]
        row["torque_regressor"] = self._torque_regressor(q, v, a)
        pin.rnea(native, data, q, v, a)
        row["body_regressor"] = np.array([pin.jointBodyRegressor(native, data, k) for k in self._ids])
        pin.forwardKinematics(native, data, q, v, a)
        row["rotation"] = np.array([data.oMi[k].rotation for k in self._ids])
        row["position"] = np.array([data.oMi[k].translation for k in self._ids])
        row["velocity"], row["acceleration"] = self._spatial(data.v), self._spatial(data.a)
        a = self._aba(q, v, tau, forces)
        row["a_external"] = a[columns]
        pin.rnea(native, data, q, v, a, forces)
        row["a_wrenches_external"] = self._joint_wrenches()
        a = self._aba(q, v, tau)
        row["a"] = a[columns]
        pin.rnea(native, data, q, v, a)
        row["a_wrenches"] = self._joint_wrenches()
        pin.forwardKinematics(native, data, q, v, a)
        row["a_body_accelerations"] = self._spatial(data.a)
        return row

    def derive(self, q: Array, v: Array, a: Array, tau: Array) -> DerivedValues:
        """Derivatives, energies and matrices at N states: q, v, a, tau (N, n).

        All but the potential energy are those of the robot moved to the world's origin: Pinocchio computes them about
        that point, and would lose the digits of the distance.
        """
        rooted = self.turned(Placement(np.eye(3), -self._first_joint()), self._model.gravity)
        rows = [rooted._derive_one(*state) for state in zip(q, v, a, tau, strict=True)]
        values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        potential = [pin.computePotentialEnergy(self._native, self._data, self.configuration(q_k)) for q_k in q]
        return DerivedValues(**values, potential_energy=np.array(potential))

    def _first_joint(self) -> Array:
        """Where the first joint is in the world (3,) [m]."""
        return np.array(self._native.jointPlacements[self._ids[0]].translation)

    def _derive_one(self, q: Array, v: Array, a: Array, tau: Array) -> dict[str, Array]:
        native, data = self._native, self._data
        q, v, a, tau = self.configuration(q), self._there(v), self._there(a), self._there(tau)
        own = np.ix_(self._columns, self._columns)

        def here(matrix: Array) -> Array:  # a copy: the bindings answer views of data
            return np.array(np.reshape(matrix, (native.nv, native.nv))[own])

        def symmetric(upper: Array) -> Array:
            full = np.reshape(upper, (native.nv, native.nv))
            return here(np.triu(full) + np.triu(full, 1).T)

        row = {}
        dtau_dq, dtau_dv, _ = pin.computeRNEADerivatives(native, data, q, v, a)
        row["dtau_dq"], row["dtau_dv"] = here(dtau_dq), here(dtau_dv)
        da_dq, da_dv, da_dtau = pin.computeABADerivatives(native, data, q, v, tau)
        row["da_dq"], row["da_dv"], row["da_dtau"] = here(da_dq), here(da_dv), symmetric(da_dtau)
        row["mass_matrix_inverse"] = symmetric(pin.computeMinverse(native, data, q))
        row["coriolis_matrix"] = here(pin.computeCoriolisMatrix(native, data, q, v))
        row["kinetic_energy"] = np.array(pin.computeKineticEnergy(native, data, q, v))
        return row

    def _torque_regressor(self, q: Array, v: Array, a: Array) -> Array:
        """(n, 10n) of one state in Pinocchio's order and coordinates; the bindings flatten matrices of one row."""
        flat = pin.computeJointTorqueRegressor(self._native, self._data, q, v, a)
        full = np.reshape(flat, (self._native.nv, BODY_PARAMETERS * self._native.nv))
        regressor: Array = full[np.ix_(self._columns, self._parameter_columns())]
        return regressor

    def _aba(self, q: Array, v: Array, tau: Array, forces: pin.StdVec_Force | None = None) -> Array:
        arguments = (self._native, self._data, q, v, tau)
        a = pin.aba(*arguments) if forces is None else pin.aba(*arguments, forces)
        return np.array(a)

    def _forces(self, external: Array) -> pin.StdVec_Force:
        """External wrenches (n, 6) as Pinocchio takes them, one for each of its joints."""
        forces = pin.StdVec_Force()
        forces.extend(pin.Force.Zero() for _ in range(self._native.njoints))
        for k, wrench in zip(self._ids, external, strict=True):
            forces[k] = pin.Force(np.array(wrench))
        return forces

    def _joint_wrenches(self) -> Array:
        return np.array([self._data.f[k].vector for k in self._ids])

    def _spatial(self, vectors: pin.StdVec_Motion) -> Array:
        """data.v or data.a of the bodies (n, 6), in link axes at the link origins."""
        return np.array([vectors[k].vector for k in self._ids])

    def _centers(self) -> Array:
        """Centers of mass (n, 3) in link axes.

        Pinocchio loses the center of a body with zero or tiny mass, because it divides m c by at least eps; then ours
        is used, so that the same point is compared.
        """
        inertias = [self._native.inertias[k] for k in self._ids]
        return np.array(
            [
                inertia.lever if inertia.mass > np.finfo(float).eps else body.center_of_mass
                for inertia, body in zip(inertias, self._model.bodies, strict=True)
            ]
        )

    def _there(self, values: Array) -> Array:
        """A joint-space vector in Pinocchio's order."""
        full = np.empty(self._native.nv)
        full[self._columns] = values
        return full

    def _parameter_columns(self) -> Array:
        """Column numbers of Pinocchio's regressor in graphdyn's body order."""
        every = np.arange(BODY_PARAMETERS * self._native.nv)
        return np.concatenate([every[parameter_columns(k)] for k in self._ids])


def _se3(placement: Placement) -> pin.SE3:
    return pin.SE3(np.array(placement.rotation), np.array(placement.translation))


def _inertia(body: Body) -> pin.Inertia:
    """From mass, center and tensor; from the ten parameters where Pinocchio refuses a tensor that is not positive."""
    if np.linalg.eigvalsh(body.inertia)[0] < 0:
        return pin.Inertia.FromDynamicParameters(np.array(body.parameters))
    return pin.Inertia(body.mass, np.array(body.center_of_mass), np.array(body.inertia))


def _write(joint: pin.JointModel, full: Array, value: float) -> None:
    """Write one joint position into Pinocchio's q; a continuous joint takes two entries, (cos, sin)."""
    full[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))


def _held(native: pin.Model, lock: Mapping[str, float]) -> pin.Model:
    reference = pin.neutral(native)
    for name, value in lock.items():
        _write(native.joints[native.getJointId(name)], reference, value)
    return pin.buildReducedModel(native, [native.getJointId(name) for name in lock], reference) if lock else native


def _imposed(motion: BaseMotion, k: int) -> tuple[pin.SE3, Array, Array]:
    """Placement, spatial velocity and spatial acceleration of the carriage in its own axes (6,), of row k."""
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
