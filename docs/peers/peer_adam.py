"""adam: mass_matrix and bias_force of a floating-base robot; rows and columns of the base are left out."""

import numpy as np
from adam.numpy import KinDynComputations
from robot_file import FILE_CAUSES, edited

import urdf

PACKAGE = "adam-robotics"
CAUSES = FILE_CAUSES


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    names = list(urdf.load(file).joint_names)
    robot = KinDynComputations(edited(file, undone), names, gravity=np.concatenate([gravity, np.zeros(3)]))

    def mass_matrix(q):
        return np.asarray(robot.mass_matrix(np.eye(4), q))[6:, 6:]

    def inverse_dynamics(q, v, a):
        bias = np.asarray(robot.bias_force(np.eye(4), q, np.zeros(6), v)).ravel()[6:]
        return mass_matrix(q) @ a + bias

    return {"joint_names": names, "inverse_dynamics": inverse_dynamics, "mass_matrix": mass_matrix}
