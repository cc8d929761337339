"""Motion of frames, in every reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from crosscheck.referee.frame_choices import REFERENCES, compared_frames
from crosscheck.referee.pinocchio_model.ordered import OrderedModel
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
    for reference in REFERENCES:
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
