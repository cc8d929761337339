"""DART: computeInverseDynamics and getMassMatrix of the file as DartLoader reads it."""

import dartpy
from robot_file import FILE_CAUSES, edited

PACKAGE = "dartpy"
CAUSES = FILE_CAUSES


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    loader = dartpy.utils.DartLoader()
    options = loader.getOptions()
    options.mDefaultRootJointType = dartpy.utils.DartLoader.RootJointType.FIXED
    loader.setOptions(options)
    robot = loader.parseSkeleton(edited(file, undone))
    robot.setGravity(gravity)

    def inverse_dynamics(q, v, a):
        robot.setPositions(q)
        robot.setVelocities(v)
        robot.setAccelerations(a)
        robot.computeInverseDynamics()
        return robot.getForces()

    def forward_dynamics(q, v, tau):
        robot.setPositions(q)
        robot.setVelocities(v)
        robot.setForces(tau)
        robot.computeForwardDynamics()
        return robot.getAccelerations()

    def mass_matrix(q):
        robot.setPositions(q)
        return robot.getMassMatrix()

    return {
        "joint_names": [robot.getDof(k).getName() for k in range(robot.getNumDofs())],
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
        "mass_matrix": mass_matrix,
    }
