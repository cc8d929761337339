"""Robotics Toolbox for Python: rne and inertia of the file as Robot.URDF reads it."""

import numpy as np
import roboticstoolbox
from robot_file import FILE_CAUSES, edited

import urdf

PACKAGE = "roboticstoolbox-python"
NEGATIVE_AXES = "velocities and torques about negative axes"
CAUSES = (NEGATIVE_AXES, *FILE_CAUSES)


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    robot = roboticstoolbox.Robot.URDF(edited(file, undone))
    names = [link._joint_name for link in robot.links if link.isjoint]
    sign = np.ones(robot.n)
    if NEGATIVE_AXES in undone:
        axes = {joint.name: joint.axis for joint in urdf.load(file).joints}
        sign = np.array([-1.0 if min(axes[name]) < -0.5 else 1.0 for name in names])

    def inverse_dynamics(q, v, a):
        return sign * np.asarray(robot.rne(q, sign * v, sign * a, gravity=gravity)).ravel()

    return {
        "joint_names": names,
        "inverse_dynamics": inverse_dynamics,
        "mass_matrix": lambda q: sign[:, None] * np.asarray(robot.inertia(q)) * sign,
    }
