"""Recursions"""

import numpy as np
from exhibit import exhibit
from plain_codes import NewtonEuler, Reader, Spatial, cross, motion_cross

BOTH = ("arm", "ur5")


@exhibit(
    "Robotics Toolbox for Python",
    2021,
    "petercorke/robotics-toolbox-python/issues/266",
    "petercorke/robotics-toolbox-python/pull/268",
    truth="not turned|turned but for|ω̇ × r",
    robots=BOTH,
)
def acceleration_turned_in_part(path):
    """A parenthesis is missing: Rᵀ turns ω̇ × r alone, not the other accelerations of the joint."""

    class Faulty(NewtonEuler):
        def of_point(self, rotation, arm, omega, alpha, acceleration):
            return rotation.T @ cross(alpha, arm) + cross(omega, cross(omega, arm)) + acceleration

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit(
    "Robotics Toolbox for Python",
    2023,
    "petercorke/robotics-toolbox-python/issues/404",
    truth="c × F|r × f|arm of the force",
    robots=BOTH,
)
def arm_of_the_force_of_another_point(path):
    """The force of a link acts at the distance of the next joint in place of its center of mass."""

    class Faulty(NewtonEuler):
        def inverse_dynamics(self, q, v, a):
            self.next = [*(link.translation for link in self.arm[1:]), np.zeros(3)]
            return super().inverse_dynamics(q, v, a)

        def wrench(self, link, *motion):
            force, moment = super().wrench(link, *motion)
            number = next(k for k, known in enumerate(self.arm) if known is link)
            return force, moment + cross(self.next[number] - link.inertial.center, force)

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit(
    "Robotics Toolbox for Python",
    2026,
    "petercorke/robotics-toolbox-python/pull/691",
    truth="passed on|transform",
    robots=BOTH,
)
def force_through_the_transform_of_motions(path):
    """Forces go back through the transform of motions from the inside link to this one."""

    class Faulty(Spatial):
        def passed_on(self, transform, force):
            return transform @ force

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit(
    "inverse-dynamics-rne", 2020, "auralius/inverse-dynamics-rne/issues/2", truth="ω × (I|J) ?ω|gyroscopic", robots=BOTH
)
def velocity_of_the_first_link(path):
    """The gyroscopic moment is ω × (J ω₁), with the velocity of the first link."""

    class Faulty(NewtonEuler):
        def wrench(self, link, omega, alpha, acceleration):
            self.first = omega if link is self.arm[0] else self.first
            force, moment = super().wrench(link, omega, alpha, acceleration)
            return force, moment + cross(omega, link.inertial.tensor @ (self.first - omega))

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("cisst", 2025, "jhu-cisst/cisst/pull/106", truth="tensors? .*(axes|turned)", robots=BOTH)
def tensor_in_axes_of_the_world(path):
    """Moments are computed in world axes with tensors in link axes."""

    class Faulty(NewtonEuler):
        def inverse_dynamics(self, q, v, a):
            turns = []
            for link, x in zip(self.arm, q, strict=True):
                turns.append((turns[link.inside] if link.inside >= 0 else np.eye(3)) @ link.placed(x)[0])
            seen = [
                link.but(tensor=turn.T @ link.inertial.tensor @ turn)
                for link, turn in zip(self.arm, turns, strict=True)
            ]
            return NewtonEuler(seen).inverse_dynamics(q, v, a)

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit(
    "RigidBodyDynamics.jl",
    2016,
    "JuliaRobotics/RigidBodyDynamics.jl/pull/2",
    "roboticslab-uc3m/kinematics-dynamics/issues/200",
    truth="gravity",
    robots=BOTH,
)
def gravity_upwards(path):
    """Gravity has the other sign. Users of KDL pass it as (0, 0, 9.81) as well."""

    class Faulty(NewtonEuler):
        gravity = -NewtonEuler.gravity

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("iDynTree", 2015, "gbionics/idyntree/issues/81", truth="gravity", robots=BOTH, lines_unseen=True)
def gravity_converted_wrongly(path):
    """Gravity is converted wrongly to an acceleration of the base: here to an angular one."""

    class Faulty(NewtonEuler):
        def base(self):
            return np.zeros(3), -self.gravity, np.zeros(3)

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("Drake", 2016, "RobotLocomotion/drake/issues/2201", truth="acceleration", robots=BOTH, lines_unseen=True)
def accelerations_of_the_joint_alone(path):
    """Torques are wrong where accelerations are not zero: here each moves its own link alone, and is not carried on."""

    class Faulty(Spatial):
        def inverse_dynamics(self, q, v, a):
            forces = [
                inertia @ subspace * rate
                for inertia, subspace, rate in zip(self.inertias, self.subspaces, a, strict=True)
            ]
            transforms, tau = self.transforms(q), np.empty(len(q))
            for j in reversed(range(len(q))):
                tau[j] = self.subspaces[j] @ forces[j]
                if self.arm[j].inside >= 0:
                    forces[self.arm[j].inside] = forces[self.arm[j].inside] + transforms[j].T @ forces[j]
            return tau + super().inverse_dynamics(q, v, 0 * a)

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("Drake", 2015, "RobotLocomotion/drake/issues/923", truth="v ?× ?S|ω × q̇ p|velocity terms", robots=BOTH)
def velocity_product_not_computed(path):
    """J̇ v, the accelerations that velocities alone cause, is zero unless it is asked for."""

    class Faulty(Spatial):
        def carried(self, transform, subspace, v, a, velocity, acceleration):
            return transform @ velocity + subspace * v, transform @ acceleration + subspace * a

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("OpenRAVE", 2024, "rdiankov/openrave/pull/1481", truth="joint 'reach'")
def torque_of_a_slide_turned_again(path):
    """The force of a sliding joint is projected on its axis turned once more by the joint's frame."""

    class Faulty(NewtonEuler):
        def joint_torque(self, link, force, moment):
            return link.rotation @ link.axis @ force if link.slides else link.axis @ moment

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("Robotics Toolbox for MATLAB", 2014, "petercorke/robotics-toolbox-matlab/issues/6", truth="joint 'turn'")
def first_torque_about_the_base(path):
    """The transform of the base is added to the arm of the first joint: its torque is about the base's origin."""

    class Faulty(NewtonEuler):
        def joint_torque(self, link, force, moment):
            arm = link.rotation.T @ link.translation if link is self.arm[0] else np.zeros(3)
            return super().joint_torque(link, force, moment + cross(arm, force))

    return Faulty(Reader().arm(path)).inverse_dynamics


@exhibit("DART", 2020, "dartsim/dart/issues/1450", truth="diagonal .*added to the mass matrix|damping", robots=BOTH)
def damping_times_acceleration(path):
    """Implicit damping is in the inverse dynamics: damping · q̈ · time step is added."""
    right, damping, step = NewtonEuler(Reader().arm(path)).inverse_dynamics, np.array([5, 4, 3, 2, 1, 0.5]), 1e-3
    return lambda q, v, a: right(q, v, a) + damping * a * step


@exhibit(
    "urdf2casadi for MATLAB",
    2020,
    "robotology/urdf2casadi-matlab/pull/10",
    truth="cross product|v ×",
    judged_as="coriolis_matrix",
    robots=BOTH,
)
def cross_product_of_motions_for_forces(path):
    """The matrix B of a body has the cross product of motions where that of forces belongs."""

    class Faulty(Spatial):
        def velocity_terms(self, inertia, velocity):
            right = super().velocity_terms(inertia, velocity)
            return right + (motion_cross(velocity) @ inertia + motion_cross(velocity).T @ inertia) / 2

    return Faulty(Reader().arm(path)).coriolis_matrix


@exhibit(
    "Simbody",
    2015,
    "simbody/simbody/issues/334",
    truth="tensor|composite",
    judged_as="mass_matrix",
    robots=BOTH,
    lines_unseen=True,
)
def composite_bodies_shifted_from_their_origins(path):
    """A spatial inertia whose center of mass is off its origin is shifted wrongly: here as if the tensor were about the
    center. Composite inertias are wrong with it."""

    class Faulty(Spatial):
        def moved(self, inertia, rotation, arm):
            mass, first = inertia[5, 5], np.array([inertia[2, 4], inertia[0, 5], inertia[1, 3]])
            turned, center = rotation @ inertia[:3, :3] @ rotation.T, rotation @ first / mass
            return self.inertia(mass, center + arm, turned)

    return Faulty(Reader().arm(path)).mass_matrix


@exhibit("roki", 2022, "mi-lib/roki/issues/19", truth="constant|bias", judged_as="mass_matrix", robots=BOTH)
def columns_with_an_external_force(path):
    """Columns of the mass matrix are inverse dynamics at v = 0, g = 0 and a unit acceleration; a force on the last link
    is not subtracted."""
    arm, force = Reader().arm(path), np.array([0.0, 5.0, 2.0])

    class Pushed(NewtonEuler):
        gravity = np.zeros(3)

        def wrench(self, link, *motion):
            own, moment = super().wrench(link, *motion)
            return own - force * (link is self.arm[-1]), moment

    code = Pushed(arm)
    return lambda q: np.stack([code.inverse_dynamics(q, 0 * q, unit) for unit in np.eye(len(q))], axis=1)


@exhibit(
    "tiny-differentiable-simulator",
    2021,
    "erwincoumans/tiny-differentiable-simulator/issues/76",
    truth="triangle|transposed|one side",
    judged_as="mass_matrix",
    robots=BOTH,
)
def one_block_transposed(path):
    """A block of the mass matrix is written, its transpose on the other side of the diagonal is not."""
    right = Spatial(Reader().arm(path)).mass_matrix
    return lambda q: np.triu(right(q))


@exhibit(
    "differentiable-robot-model",
    2022,
    "facebookresearch/differentiable-robot-model/pull/31",
    truth="first (row|state|call)|batch",
    judged_as="forward_dynamics",
    robots=BOTH,
    batched=True,
)
def inertia_of_the_first_of_a_batch(path):
    """A batch of states is solved with the articulated inertias of its first state."""
    code = Spatial(Reader().arm(path))

    def forward_dynamics(q, v, tau):
        bias = np.array([code.inverse_dynamics(x, y, 0 * y) for x, y in zip(q, v, strict=True)])
        return np.linalg.solve(code.mass_matrix(q[0]), (tau - bias).T).T

    return forward_dynamics
