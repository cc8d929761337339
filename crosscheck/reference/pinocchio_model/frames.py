"""Placements and motions of frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

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


def frame_values(
    robot: OrderedModel, function: str, names: Sequence[str], reference: str, q: Array, v: Array, a: Array
) -> Array:
    """What one of Pinocchio's functions of a frame answers for several (m, 6) or (m, 6, n).

    q, v, a: of one state, in Pinocchio's order
    """
    native, data, compute = robot.native, robot.data, getattr(pin, function)
    pin.computeJointJacobiansTimeVariation(native, data, q, v)  # the Jacobians, too
    pin.forwardKinematics(native, data, q, v, a)
    pin.updateFramePlacements(native, data)
    found = [compute(native, data, k, _AXES[reference]) for k in robot.frame_ids(names)]
    return np.array([x.vector if isinstance(x, pin.Motion) else robot.columns_of(x) for x in found])
