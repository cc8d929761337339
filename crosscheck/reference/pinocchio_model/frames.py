"""Motion of frames, in every reference.

Center of mass and momentum of all bodies together.

Regressors of energies and momenta, and derivatives by the inertial parameters.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from crosscheck.reference.frame_choices import FRAME_REFERENCES, compared_frames
from crosscheck.reference.pinocchio_model.ordered import OrderedModel
from graphdyn.layout import Array

_AXES = {"world": pin.WORLD, "local": pin.LOCAL, "local_world_aligned": pin.LOCAL_WORLD_ALIGNED}


def frame_placements(robot: OrderedModel, q: Array, names: Sequence[str]) -> tuple[Array, Array]:
    """Rotations (N, m, 3, 3) and positions (N, m, 3) of links by name. Raises PinocchioRefuses if unknown."""
    ids = robot.frame_ids(names)
    rotations, positions = [], []
    for row in q:
        pin.framesForwardKinematics(robot.native, robot.data, robot.configuration(row))
        # copied: these are views of data, which the next state overwrites
        rotations.append(np.array([robot.data.oMf[k].rotation for k in ids]))
        positions.append(np.array([robot.data.oMf[k].translation for k in ids]))
    return np.array(rotations), np.array(positions)


def frame_motion(robot: OrderedModel, rooted: OrderedModel, q: Array, v: Array, a: Array) -> dict[str, Array]:
    """Jacobians (3, m, 6, n), velocities and accelerations (3, m, 6) of the compared frames, per reference.

    q, v, a: of one state, in Pinocchio's order
    rooted: the robot moved to the world's origin, about which Pinocchio computes; taken where a reference does not
        speak of that point
    """
    ids = robot.frame_ids(compared_frames(robot.model))
    described = []
    for reference in FRAME_REFERENCES:
        of = robot if reference == "world" else rooted
        native, data, axes = of.native, of.data, _AXES[reference]
        pin.computeJointJacobiansTimeVariation(native, data, q, v)  # the Jacobians, too
        pin.forwardKinematics(native, data, q, v, a)
        pin.updateFramePlacements(native, data)
        at = [(native, data, k, axes) for k in ids]
        described.append(
            {
                "frame_jacobian": [of.columns_of(pin.getFrameJacobian(*place)) for place in at],
                "frame_velocity": [pin.getFrameVelocity(*place).vector for place in at],
                "frame_acceleration": [pin.getFrameClassicalAcceleration(*place).vector for place in at],
                "frame_acceleration_spatial": [pin.getFrameAcceleration(*place).vector for place in at],
                "frame_jacobian_derivative": [of.columns_of(pin.getFrameJacobianTimeVariation(*place)) for place in at],
            }
        )
    return {name: np.array([row[name] for row in described]) for name in described[0]}


def momenta(robot: OrderedModel, rooted: OrderedModel, q: Array, v: Array) -> dict[str, Array]:
    """Of one state, q and v in Pinocchio's order; world axes, linear first.

    rooted: the robot moved to the world's origin, about which Pinocchio computes; taken where the place does not matter
    """
    row = {"center_of_mass": np.array(pin.centerOfMass(robot.native, robot.data, q))}
    row["momentum_about_origin"] = _momentum_about_origin(robot, q, v)
    native, data = rooted.native, rooted.data
    pin.centerOfMass(native, data, q, v)
    row["center_of_mass_velocity"] = np.array(data.vcom[0])
    row["center_of_mass_jacobian"] = rooted.columns_of(pin.jacobianCenterOfMass(native, data, q))
    row["centroidal_momentum"] = np.array(pin.computeCentroidalMomentum(native, data, q, v).vector)
    row["centroidal_map"] = rooted.columns_of(pin.computeCentroidalMap(native, data, q))
    return row


def _momentum_about_origin(robot: OrderedModel, q: Array, v: Array) -> Array:
    """Σ of the spatial momenta of the bodies, each moved to the world's origin."""
    native, data = robot.native, robot.data
    pin.forwardKinematics(native, data, q, v)
    total = sum((data.oMi[k].act(native.inertias[k] * data.v[k]) for k in robot.ids), pin.Force.Zero())
    return np.array(total.vector)


def parameter_values(
    robot: OrderedModel, rooted: OrderedModel, weightless: OrderedModel, q: Array, v: Array, tau: Array
) -> dict[str, Array]:
    """Of one state, q, v, tau in Pinocchio's order.

    rooted: the robot moved to the world's origin, about which Pinocchio computes
    weightless: the robot without gravity, whose torques at rest are M a: with v for a, the momenta M v
    """
    native, data = robot.native, robot.data
    a = np.array(pin.aba(rooted.native, rooted.data, q, v, tau))
    inverse = rooted.symmetric(pin.computeMinverse(rooted.native, rooted.data, q))
    return {
        "kinetic_energy_regressor": robot.parameters_of(pin.computeKineticEnergyRegressor(native, data, q, v)),
        "potential_energy_regressor": robot.parameters_of(pin.computePotentialEnergyRegressor(native, data, q)),
        "momentum_regressor": weightless.regressor_of(q, np.zeros_like(v), v),
        "da_dpi": -inverse @ rooted.regressor_of(q, v, a),
    }
