"""PyBullet: calculateInverseDynamics and calculateMassMatrix of the file as loadURDF reads it."""

import numpy as np
import pybullet
from robot_file import FILE_CAUSES, edited

PACKAGE = "pybullet"
CAUSES = FILE_CAUSES


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(*gravity, physicsClientId=client)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    body = pybullet.loadURDF(edited(file, undone), useFixedBase=True, flags=flags, physicsClientId=client)
    joints = [pybullet.getJointInfo(body, k, client) for k in range(pybullet.getNumJoints(body, client))]

    def inverse_dynamics(q, v, a):
        return np.array(pybullet.calculateInverseDynamics(body, list(q), list(v), list(a), physicsClientId=client))

    return {
        "joint_names": [joint[1].decode() for joint in joints if joint[2] != pybullet.JOINT_FIXED],
        "inverse_dynamics": inverse_dynamics,
        "mass_matrix": lambda q: np.array(pybullet.calculateMassMatrix(body, list(q), physicsClientId=client)),
    }
