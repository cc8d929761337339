"""Pinocchio as its user calls it: right functions under test, one per function of the table, for one robot and
frame."""

import numpy as np
import pinocchio as pin

import graphdyn
import urdf

REFERENCES = {
    "local": pin.LOCAL,
    "world": pin.WORLD,
    "local_world_aligned": pin.LOCAL_WORLD_ALIGNED,
}


class PinocchioCode:
    """A robot of the catalog whose joints are all plain angles, in Pinocchio's own order; one frame of it."""

    def __init__(self, robot: str, frame: str):
        (entry,) = (entry for entry in urdf.robots() if entry.name == robot)
        self.robot, self.frame = robot, frame
        self.model = urdf.load(robot)
        self.native = pin.buildModelFromUrdf(str(entry.path))
        self.data = self.native.createData()
        self.id = self.native.getFrameId(frame, pin.BODY)
        self.names = list(self.native.names[1:])
        assert self.native.nq == self.native.nv

    def of_frame(self, reference: str):
        """The four functions of the frame by one reference."""
        return {
            "frame_jacobian": lambda q: pin.computeFrameJacobian(
                self.native, self.data, q, self.id, REFERENCES[reference]
            ),
            "frame_jacobian_derivative": lambda q, v: self._jacobian_rate(q, v, REFERENCES[reference]),
            "frame_velocity": lambda q, v: self._moved(q, v, 0 * v, pin.getFrameVelocity, reference),
            "frame_acceleration": lambda q, v, a: self._moved(q, v, a, pin.getFrameClassicalAcceleration, reference),
        }

    def spatial_acceleration(self, reference: str):
        return lambda q, v, a: self._moved(q, v, a, pin.getFrameAcceleration, reference)

    def functions(self):
        """Right functions but for those of the frame, by name."""
        native, data = self.native, self.data
        return {
            "inverse_dynamics": lambda q, v, a: pin.rnea(native, data, q, v, a),
            "forward_dynamics": lambda q, v, tau: pin.aba(native, data, q, v, tau),
            "bias_torque": lambda q, v: pin.nonLinearEffects(native, data, q, v),
            "gravity_torque": lambda q: pin.computeGeneralizedGravity(native, data, q),
            "static_torque": lambda q, wrenches: pin.computeStaticTorque(native, data, q, forces(wrenches)),
            "power": lambda q, v, a: pin.rnea(native, data, q, v, a) * v,
            "joint_wrenches": self.joint_wrenches,
            "mass_matrix": lambda q: full(pin.crba(native, data, q)),
            "mass_matrix_inverse": lambda q: full(pin.computeMinverse(native, data, q)),
            "coriolis_matrix": lambda q, v: pin.computeCoriolisMatrix(native, data, q, v),
            "frame_placement": self.placement,
            "center_of_mass": lambda q: pin.centerOfMass(native, data, q),
            "center_of_mass_velocity": lambda q, v: self._center_rate(q, v),
            "center_of_mass_jacobian": lambda q: pin.jacobianCenterOfMass(native, data, q),
            "momentum": lambda q, v: pin.computeCentroidalMomentum(native, data, q, v).vector,
            "centroidal_map": lambda q: pin.computeCentroidalMap(native, data, q),
            "kinetic_energy": lambda q, v: pin.computeKineticEnergy(native, data, q, v),
            "potential_energy": lambda q: pin.computePotentialEnergy(native, data, q),
            "dtau_dq": lambda q, v, a: pin.computeRNEADerivatives(native, data, q, v, a)[0],
            "dtau_dv": lambda q, v, a: pin.computeRNEADerivatives(native, data, q, v, a)[1],
            "da_dq": lambda q, v, tau: pin.computeABADerivatives(native, data, q, v, tau)[0],
            "da_dv": lambda q, v, tau: pin.computeABADerivatives(native, data, q, v, tau)[1],
            "joint_torque_regressor": self.regressor,
            "base_regressor": self.base_regressor(),
            "kinetic_energy_regressor": lambda q, v: pin.computeKineticEnergyRegressor(native, data, q, v),
            "potential_energy_regressor": lambda q: pin.computePotentialEnergyRegressor(native, data, q),
        }

    def joint_wrenches(self, q, v, a):
        pin.rnea(self.native, self.data, q, v, a)
        return np.array([f.vector for f in self.data.f[1:]])

    def placement(self, q):
        pin.framesForwardKinematics(self.native, self.data, q)
        return self.data.oMf[self.id].homogeneous

    def regressor(self, q, v, a):
        return pin.computeJointTorqueRegressor(self.native, self.data, q, v, a)

    def base_regressor(self, left_out=0):
        """Columns of W combined at random, as many as its rank but for those left out."""
        rng = np.random.default_rng(5)
        samples = rng.uniform(-2, 2, (60, 3, self.native.nv))
        _, sizes, directions = np.linalg.svd(np.concatenate([self.regressor(*state) for state in samples]))
        rank = int((sizes > 1e-10 * sizes[0]).sum())
        basis = directions[:rank].T @ np.linalg.qr(rng.normal(size=(rank, rank)))[0][:, left_out:]
        return lambda q, v, a: self.regressor(q, v, a) @ basis

    def _center_rate(self, q, v):
        pin.centerOfMass(self.native, self.data, q, v)
        return self.data.vcom[0]

    def _jacobian_rate(self, q, v, reference):
        pin.computeJointJacobiansTimeVariation(self.native, self.data, q, v)
        pin.updateFramePlacements(self.native, self.data)
        return pin.getFrameJacobianTimeVariation(self.native, self.data, self.id, reference)

    def _moved(self, q, v, a, read, reference):
        pin.forwardKinematics(self.native, self.data, q, v, a)
        pin.updateFramePlacements(self.native, self.data)
        return read(self.native, self.data, self.id, REFERENCES[reference]).vector


def forces(wrenches):
    """External wrenches (n, 6) as Pinocchio takes them, the ground first."""
    found = pin.StdVec_Force()
    found.extend([pin.Force.Zero(), *(pin.Force(row) for row in wrenches)])
    return found


def full(upper):
    return np.triu(upper) + np.triu(upper, 1).T


def own_functions(model: graphdyn.RobotModel):
    """graphdyn's, of what Pinocchio has no function for."""
    return {
        "multipliers": lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).multipliers,
        "body_regressor": lambda q, v, a: graphdyn.body_regressor(model, q, v, a),
        "momentum_regressor": lambda q, v: graphdyn.momentum_regressor(model, q, v),
        "forward_dynamics_parameter_derivatives": lambda q, v, tau: graphdyn.forward_dynamics_parameter_derivatives(
            model, q, v, tau
        ),
        **{
            f"d{of}_d{x}": lambda q, v, a, name=f"d{of}_d{x}": getattr(
                graphdyn.reaction_derivatives(model, q, v, a), name
            )
            for of in ("multipliers", "wrenches")
            for x in "qva"
        },
    }
