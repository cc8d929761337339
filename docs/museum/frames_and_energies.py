"""Frames, energies, centers of mass"""

import numpy as np
from exhibit import exhibit
from plain_codes import GRAVITY, Kinematics, Reader, cross, rotation_of_rpy

TOOL = rotation_of_rpy(0, 0.4, 0), np.array([0.02, 0.0, 0.12])
"""Of the joint 'grip' in arm.urdf."""

OF_TOOL = {"frame": "tool"}


def kinematics(path):
    return Kinematics(Reader().arm(path), TOOL)


@exhibit(
    "Bullet",
    2017,
    "bulletphysics/bullet3/pull/1345",
    truth="frame 'hand'",
    judged_as="frame_jacobian",
    **OF_TOOL,
)
def jacobian_of_another_point(path):
    """The linear rows are those of the origin of the link, not of the given point in it."""
    code = kinematics(path)
    return lambda q: code.jacobian_of(q, len(q) - 1, code.places(q)[-1][1])


@exhibit("Klampt", 2021, "krishauser/Klampt/issues/110", truth="angular", judged_as="frame_jacobian", **OF_TOOL)
def angular_rows_of_zeros(path):
    """The angular rows of the Jacobian are zero."""
    code = kinematics(path)
    return lambda q: code.frame_jacobian(q) * np.repeat([1, 0], 3)[:, None]


@exhibit(
    "RVC3 for MATLAB", 2025, "petercorke/RVC3-MATLAB/issues/18", truth="linear", judged_as="frame_jacobian", **OF_TOOL
)
def ones_for_the_unit_matrix(path):
    """The printed code has ones(3) where eye(3) belongs: every linear row is the sum of the three."""
    code = kinematics(path)
    return lambda q: (
        np.block([[np.ones((3, 3)), np.zeros((3, 3))], [np.zeros((3, 3)), np.eye(3)]]) @ code.frame_jacobian(q)
    )


@exhibit(
    "control-toolbox",
    2020,
    "ethz-adrl/control-toolbox/issues/171",
    truth="order is 'angular first'",
    judged_as="frame_jacobian",
    conventions={"order": "linear first"},
    **OF_TOOL,
)
def rows_in_the_other_order(path):
    """A user expects linear rows first; the library has angular rows first."""
    code = kinematics(path)
    return lambda q: np.roll(code.frame_jacobian(q), 3, axis=0)


@exhibit(
    "Pinocchio",
    2019,
    "stack-of-tasks/pinocchio/issues/901",
    truth="reference is 'world'",
    judged_as="frame_jacobian",
    conventions={"reference": "local_world_aligned"},
    **OF_TOOL,
)
def jacobian_at_the_origin_of_the_world(path):
    """A user takes WORLD for the velocity of the frame in world axes; it is that of the point at the world's origin."""
    code = kinematics(path)
    return lambda q: code.jacobian_of(q, len(q) - 1, np.zeros(3))


@exhibit(
    "DART",
    2015,
    "dartsim/dart/issues/294",
    "duburcqa/jiminy/pull/584",
    truth="acceleration is 'spatial'",
    judged_as="frame_acceleration",
    conventions={"acceleration": "classical"},
    **OF_TOOL,
)
def spatial_for_classical_acceleration(path):
    """What is called linear acceleration is the linear part of the spatial one: ω × ṗ is missing. Jiminy's constraints
    had the same."""
    code = kinematics(path)

    def frame_acceleration(q, v, a):
        velocity = code.frame_jacobian(q) @ v
        return code.frame_acceleration(q, v, a) - np.concatenate([cross(velocity[3:], velocity[:3]), np.zeros(3)])

    return frame_acceleration


@exhibit(
    "Robotics Toolbox for MATLAB",
    2024,
    "petercorke/robotics-toolbox-matlab/issues/131",
    truth="degrees|57|0\\.0174|π/180",
    judged_as="frame_placement",
    **OF_TOOL,
)
def radians_converted_to_degrees(path):
    """The option for degrees calls todegrees where toradians belongs."""
    code = kinematics(path)
    return lambda q: code.frame_placement(np.rad2deg(q))


@exhibit("DART", 2022, "dartsim/dart/issues/1681", truth="link origin|center", judged_as="potential_energy")
def height_of_the_link_origin(path):
    """The potential energy takes the height of the link's frame, not of its center of mass."""
    code = kinematics(path)

    def potential_energy(q):
        return -sum(x.inertial.mass * GRAVITY @ at for x, (_, at) in zip(code.arm, code.places(q), strict=True))

    return potential_energy


@exhibit(
    "WBC",
    2022,
    "ARC-OPT/wbc/issues/31",
    truth="link origin|centers? of mass",
    judged_as="center_of_mass",
    lines_unseen=True,
)
def center_of_mass_of_origins(path):
    """The center of mass is wrong with KDL and right with two other libraries; here it is that of the link origins."""
    code = kinematics(path)

    def center_of_mass(q):
        masses = np.array([link.inertial.mass for link in code.arm])
        return masses @ np.array([at for _, at in code.places(q)]) / masses.sum()

    return center_of_mass
