"""Klampt: torquesFromAccel, getGravityForces and getMassMatrix of the file as WorldModel.loadRobot reads it."""

import numpy as np
from klampt import WorldModel
from robot_file import FILE_CAUSES, edited, joint_above

PACKAGE = "klampt"
CAUSES = FILE_CAUSES


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge. Fixed joints are degrees of freedom that stay at zero."""
    world = WorldModel()
    if world.loadRobot(edited(file, undone)) is None:
        raise ValueError("Klampt cannot load the file")
    first = world.robot(0)
    driven = [first.driver(k).getAffectedLink() for k in range(first.numDrivers())]

    def spread(values):
        every = np.zeros(first.numLinks())
        every[driven] = values
        return every

    def inverse_dynamics(q, v, a):
        robot = world.robot(0)  # it must not outlive its world
        robot.setConfig(spread(q))
        robot.setVelocity(spread(v))
        torques = np.array(robot.torquesFromAccel(spread(a))) + robot.getGravityForces(list(gravity))
        return torques[driven]

    def mass_matrix(q):
        robot = world.robot(0)
        robot.setConfig(spread(q))
        return np.array(robot.getMassMatrix())[np.ix_(driven, driven)]

    return {
        "joint_names": [joint_above(file)[first.link(k).getName()] for k in driven],
        "inverse_dynamics": inverse_dynamics,
        "mass_matrix": mass_matrix,
    }
