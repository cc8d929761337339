"""The noise of torque measurements where none is given."""

from __future__ import annotations

import numpy as np

from graphdyn import RobotModel, joint_torques
from graphdyn.layout import Array

TORQUE_NOISE_SHARE = 0.01
"""Standard deviation, as a part of the effort that the file states, or of the torque of the bodies."""

NOISE_STATES = 1000
"""Random states over which the torque of the bodies is looked at."""


def assumed_noise(model: RobotModel) -> tuple[Array, str]:
    """Standard deviations (nv,) [N m or N], and in words where they come from."""
    joints = [model.joints[k] for k in model.degrees_of_freedom.independent]
    efforts = np.array([joint.limits.effort or 0.0 for joint in joints])
    if np.all(efforts > 0):
        return TORQUE_NOISE_SHARE * efforts, f"{100 * TORQUE_NOISE_SHARE:g} % of the efforts of the file"
    q, v = model.random_state(np.random.default_rng(0), NOISE_STATES)
    sizes = np.sqrt(np.mean(joint_torques(model, q, v, np.zeros_like(q)) ** 2, axis=0))
    if np.all(sizes > 0):
        return (
            TORQUE_NOISE_SHARE * sizes,
            f"{100 * TORQUE_NOISE_SHARE:g} % of the torque that the bodies of the file take in random states",
        )
    return np.ones(len(joints)), "1 N m or N, because the file states neither efforts nor masses"
