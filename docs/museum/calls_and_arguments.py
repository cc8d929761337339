"""Calls, arguments, special states"""

import numpy as np
from exhibit import exhibit
from plain_codes import Link, NewtonEuler, Reader, Spatial, cross, rotation_about, skew

BOTH = ("arm", "ur5")


@exhibit("OpenRAVE", 2023, "rdiankov/openrave/pull/1260", truth="v = 0|at rest", robots=BOTH)
def inertia_skipped_at_rest(path):
    """Where all velocities are zero a shortcut leaves out a torque that does not depend on them: there the rotor's
    inertia, here that of the last link about its axis."""
    code = NewtonEuler(Reader().arm(path))
    last = code.arm[-1]
    rotor = last.axis @ last.inertial.tensor @ last.axis

    def inverse_dynamics(q, v, a):
        skipped = 0.0 if v.any() else rotor * a[-1]
        return code.inverse_dynamics(q, v, a) - skipped * np.eye(len(q))[-1]

    return inverse_dynamics


@exhibit("Geometry", 2022, "tomstewart89/Geometry/issues/13", truth="every position is within", robots=BOTH)
def small_angles_by_the_wrong_limit(path):
    """Below an angle of 1e-5 the axis is the rotation vector itself, and the angle is one: 0.84 of the rotation."""

    class Faulty(Link):
        def placed(self, q):
            if self.slides or abs(q) >= 1e-5:
                return super().placed(q)
            s = skew(self.axis * q)
            return self.rotation @ (np.eye(3) + np.sin(1.0) * s + (1 - np.cos(1.0)) * s @ s), self.translation

    return NewtonEuler([Faulty(**vars(link)) for link in Reader().arm(path)]).inverse_dynamics


@exhibit("mjlab", 2025, "mujocolab/mjlab/pull/443", truth="not finite", robots=BOTH)
def zero_angle_divided_by(path):
    """A rotation vector is divided by its angle: at zero the answer is NaN."""

    class Faulty(Link):
        def placed(self, q):
            if self.slides:
                return super().placed(q)
            with np.errstate(invalid="ignore"):
                return self.rotation @ rotation_about(self.axis * q / np.abs(q), np.abs(q)), self.translation

    return NewtonEuler([Faulty(**vars(link)) for link in Reader().arm(path)]).inverse_dynamics


@exhibit(
    "Genesis",
    2026,
    "Genesis-Embodied-AI/genesis-world/pull/3121",
    truth="call before",
    judged_as="kinetic_energy",
    robots=BOTH,
)
def mass_matrix_of_the_step_before(path):
    """The kinetic energy takes the stored mass matrix, which is that of the configuration before."""
    code, stored = Spatial(Reader().arm(path)), []

    def kinetic_energy(q, v):
        stored.append(code.mass_matrix(q))
        return v @ stored[-2 if len(stored) > 1 else -1] @ v / 2

    return kinetic_energy


@exhibit("Bullet", 2026, "bulletphysics/bullet3/issues/4809", truth="first call", judged_as="mass_matrix", robots=BOTH)
def model_cached_for_ever(path):
    """Dynamics are computed from a cache that later changes do not clear: there of masses, here of positions."""
    code, stored = Spatial(Reader().arm(path)), []

    def mass_matrix(q):
        stored[1:] = []
        stored.append(code.mass_matrix(q))
        return stored[0]

    return mass_matrix


@exhibit(
    "Isaac Lab",
    2026,
    "isaac-sim/IsaacLab/issues/4999",
    truth="order of|exchanged|permut",
    judged_as="mass_matrix",
    robots=BOTH,
)
def rows_of_other_joints(path):
    """Rows and columns of the mass matrix are taken by numbers that do not count the joints before."""
    right = Spatial(Reader().arm(path)).mass_matrix
    return lambda q: np.roll(right(q), (2, 2), (0, 1))


@exhibit("Unity URDF importer", 2021, "Unity-Technologies/URDF-Importer/pull/44", truth="degrees", robots=BOTH)
def radians_converted_again(path):
    """Positions and velocities are converted from degrees to radians, though they are in radians."""
    right = NewtonEuler(Reader().arm(path)).inverse_dynamics
    return lambda q, v, a: right(np.deg2rad(q), np.deg2rad(v), a)


@exhibit(
    "WB-Toolbox",
    2019,
    "robotology/wb-toolbox/issues/174",
    truth="zero|held|constant|ignored",
    judged_as="gravity_torque",
)
def joints_that_are_not_listed_stay_at_zero(path):
    """A user lists some of the joints; the others count as being at zero."""
    right = NewtonEuler(Reader().arm(path)).gravity_torque
    return lambda q: right(np.where(np.arange(len(q)) < 4, q, 0.0))


@exhibit(
    "Robotics Toolbox for Python",
    2020,
    "petercorke/robotics-toolbox-python/issues/134",
    truth=r"mass of body '(hand|wrist_3_link)'|m by|body '(hand|wrist_3_link)'",
    robots=BOTH,
)
def payload_in_place_of_the_last_link(path):
    """Setting a payload replaces mass and center of mass of the last link: one of 0 kg leaves its tensor alone."""
    arm = Reader().arm(path)
    arm[-1] = arm[-1].but(mass=0.0, center=np.zeros(3))
    return NewtonEuler(arm).inverse_dynamics


@exhibit(
    "biorbd",
    2023,
    "pyomeca/biorbd/issues/340",
    truth="center|external wrench",
    robots=BOTH,
    external_wrenches=True,
)
def point_of_the_force_ignored(path):
    """The point at which an external force acts is not used: here it acts at the center of mass."""
    return pushed(
        path, lambda link, rotation, wrench: (wrench[:3], wrench[3:] + cross(link.inertial.center, wrench[:3]))
    )


@exhibit("RBDL", 2022, "rbdl/rbdl/issues/67", truth="world axes", robots=BOTH, external_wrenches=True)
def wrench_of_a_sensor_as_in_the_world(path):
    """A user passes what a sensor on the link measures; the library takes it in axes of the base."""
    return pushed(path, lambda link, rotation, wrench: (rotation.T @ wrench[:3], rotation.T @ wrench[3:]))


def pushed(path, taken):
    """Inverse dynamics with external wrenches; taken(link, its rotation in the world, wrench) gives force, moment."""

    class Pushed(NewtonEuler):
        def wrench(self, link, *motion):
            force, moment = super().wrench(link, *motion)
            number = next(k for k, known in enumerate(self.arm) if known is link)
            outer, turning = taken(link, self.turns[number], self.wrenches[number])
            return force - outer, moment - turning

    code = Pushed(Reader().arm(path))

    def inverse_dynamics(q, v, a, wrenches):
        code.wrenches, code.turns = wrenches, []
        for link, x in zip(code.arm, q, strict=True):
            inside = code.turns[link.inside] if link.inside >= 0 else np.eye(3)
            code.turns.append(inside @ link.placed(x)[0])
        return code.inverse_dynamics(q, v, a)

    return inverse_dynamics
