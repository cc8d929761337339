"""Reading a robot's file"""

import numpy as np
from exhibit import exhibit
from plain_codes import Inertial, NewtonEuler, Reader, rotation_about, rotation_of_rpy, shifted


def torques(reader, path):
    return NewtonEuler(reader.arm(path)).inverse_dynamics


@exhibit("MuJoCo", 2026, "google-deepmind/mujoco/issues/3559", "dartsim/dart/issues/47", truth="rpy of the inertial")
def inertial_rotation_lost(path):
    """The rotation of the inertial frame is lost: the tensor is taken in link axes as it stands in the file. DART had
    the same."""

    class Faulty(Reader):
        def tensor(self, mass, center, rotation, tensor):
            return tensor

    return torques(Faulty(), path)


@exhibit("o3de", 2022, "o3de/o3de-extras/issues/125", truth=("rpy|rotation", "xyz|center of mass|centers of mass"))
def inertial_origin_ignored(path):
    """The origin of an inertial is not read: the center of mass is at the link origin, the tensor in link axes."""

    class Faulty(Reader):
        def inertial(self, mass, center, rotation, tensor, is_placed):
            return Inertial(mass, 0 * center, tensor)

    return torques(Faulty(), path)


@exhibit("Newton", 2026, "newton-physics/newton/pull/2245", truth="R (J|I)|not rotated back|without .*transpose")
def inertia_turned_once(path):
    """The tensor is R J in place of R J Rᵀ."""

    class Faulty(Reader):
        def tensor(self, mass, center, rotation, tensor):
            return rotation @ tensor

    return torques(Faulty(), path)


@exhibit(
    "tiny-differentiable-simulator",
    2021,
    "erwincoumans/tiny-differentiable-simulator/pull/102",
    truth="transposed",
    lines_unseen=True,
)
def inertia_turned_back(path):
    """Inertial frames are turned the wrong way: Rᵀ J R in place of R J Rᵀ."""

    class Faulty(Reader):
        def tensor(self, mass, center, rotation, tensor):
            return rotation.T @ tensor @ rotation

    return torques(Faulty(), path)


@exhibit("RBDL", 2022, "ORB-HD/rbdl-orb/issues/88", truth="rpy (angles )?.*(opposite|reverse|other) order|order of rpy")
def rpy_of_joints_in_the_opposite_order(path):
    """Roll, pitch and yaw of joints are applied in the order z, y, x about fixed axes."""

    class Faulty(Reader):
        def rotation(self, roll, pitch, yaw):
            x, y, z = (rotation_about(axis, angle) for axis, angle in zip(np.eye(3), (roll, pitch, yaw), strict=True))
            return x @ y @ z

        def tensor(self, mass, center, rotation, tensor):
            return self.right @ tensor @ self.right.T

        def inertial(self, mass, center, rotation, tensor, is_placed):
            self.right = rpy_again(rotation)
            return super().inertial(mass, center, rotation, tensor, is_placed)

    return torques(Faulty(), path)


def rpy_again(rotation):
    """The right rotation of angles that were applied in the opposite order."""
    pitch = np.arcsin(rotation[0, 2])
    roll, yaw = np.arctan2(-rotation[1, 2], rotation[2, 2]), np.arctan2(-rotation[0, 1], rotation[0, 0])
    return rotation_of_rpy(roll, pitch, yaw)


@exhibit(
    "RigidBodyDynamics.jl",
    2018,
    "JuliaRobotics/RigidBodyDynamics.jl/issues/429",
    "JuliaRobotics/RigidBodyDynamics.jl/pull/138",
    truth=("rpy .*order", "inertial frames|tensors"),
)
def rpy_of_everything_in_the_opposite_order(path):
    """The rotation of rpy is that of the opposite order, for joints and inertial frames."""

    class Faulty(Reader):
        def rotation(self, roll, pitch, yaw):
            x, y, z = (rotation_about(axis, angle) for axis, angle in zip(np.eye(3), (roll, pitch, yaw), strict=True))
            return x @ y @ z

    return torques(Faulty(), path)


@exhibit("urdfdom_headers", 2015, "ros/urdfdom_headers/issues/18", truth="joint 'lift'")
def pitch_of_a_quarter_turn(path):
    """At a pitch of ±π/2 the rotation is another one: a half turn is added."""

    class Faulty(Reader):
        def rotation(self, roll, pitch, yaw):
            at_the_pole = abs(abs(pitch) - np.pi / 2) < 1e-9
            return rotation_of_rpy(roll + np.pi * at_the_pole, pitch, yaw)

    return torques(Faulty(), path)


@exhibit("Genesis", 2026, "Genesis-Embodied-AI/genesis-world/issues/3183", truth="tensor of body 'wrist'")
def inertia_without_origin_discarded(path):
    """An inertial without origin loses its tensor, and gets that of a box of its mass."""

    class Faulty(Reader):
        def inertial(self, mass, center, rotation, tensor, is_placed):
            box = mass / 12 * np.diag([0.1**2 + 0.1**2, 0.1**2 + 0.12**2, 0.1**2 + 0.12**2])
            return super().inertial(mass, center, rotation, tensor if is_placed else box, is_placed)

    return torques(Faulty(), path)


@exhibit("CRAM", 2026, "cram2/cognitive_robot_abstract_machine/pull/465", truth="mass.*(all|every)|other inertial")
def placeholders_for_inertials(path):
    """Inertials are never read: every link has 1 kg and a unit tensor."""

    class Faulty(Reader):
        def inertial(self, mass, center, rotation, tensor, is_placed):
            return Inertial(1.0, np.zeros(3), np.eye(3))

    return torques(Faulty(), path)


@exhibit("Brax", 2022, "google/brax/issues/240", truth="products of inertia")
def products_of_inertia_dropped(path):
    """Only the diagonal of the tensor is used."""

    class Faulty(Reader):
        def inertial(self, *read):
            right = super().inertial(*read)
            return Inertial(right.mass, right.center, np.diag(np.diag(right.tensor)))

    return torques(Faulty(), path)


@exhibit(
    "urdf2casadi",
    2020,
    "mahaarbo/urdf2casadi/issues/2",
    "jsk-ros-pkg/jsk_aerial_robot/pull/511",
    "mikedh/trimesh/pull/1074",
    truth="products of inertia",
)
def products_of_inertia_with_the_other_sign(path):
    """Products of inertia are taken with the other sign. So did a converter of SolidEdge files, and trimesh."""

    class Faulty(Reader):
        def matrix(self, xx, xy, xz, yy, yz, zz):
            return super().matrix(xx, -xy, -xz, yy, -yz, zz)

    return torques(Faulty(), path)


@exhibit("JSBSim", 2019, "JSBSim-Team/jsbsim/issues/235", truth="I_xz|xz")
def one_product_with_the_other_sign(path):
    """Only I_xz is reversed."""

    class Faulty(Reader):
        def matrix(self, xx, xy, xz, yy, yz, zz):
            return super().matrix(xx, xy, -xz, yy, yz, zz)

    return torques(Faulty(), path)


@exhibit("Robotics Toolbox for Python", 2022, "petercorke/robotics-toolbox-python/issues/300", truth="xz|order")
def last_products_exchanged(path):
    """The six numbers of a tensor are printed as xx, yy, zz, xy, xz, yz and read as xx, yy, zz, xy, yz, xz."""

    class Faulty(Reader):
        def matrix(self, xx, xy, xz, yy, yz, zz):
            return super().matrix(xx, xy, yz, yy, xz, zz)

    return torques(Faulty(), path)


@exhibit("Drake", 2022, "RobotLocomotion/drake/issues/17571", truth="tensors? .*(about|link origin|center of mass)")
def center_of_mass_set_alone(path):
    """Setting the center of mass leaves the inertia about the link origin as it was, with the center there."""

    class Faulty(Reader):
        def inertial(self, *read):
            right = super().inertial(*read)
            return Inertial(right.mass, right.center, right.tensor - shifted(right.mass, right.center))

    return torques(Faulty(), path)


@exhibit("Webots", 2022, "cyberbotics/webots/issues/4702", truth="tensors? .*(about|link origin|center of mass)")
def tensor_about_the_wrong_point(path):
    """The tensor is taken about the link origin in place of the center of mass."""

    class Faulty(Reader):
        def inertial(self, *read):
            right = super().inertial(*read)
            return Inertial(right.mass, right.center, right.tensor + shifted(right.mass, right.center))

    return torques(Faulty(), path)


@exhibit("pyb-sim-models", 2025, "utiasSTARS/pyb-sim-models/pull/4", truth="parallel|tensors? .*(about|link origin)")
def parallel_axis_with_the_other_sign(path):
    """To get from the link origin to the center of mass the parallel axis term is added, not subtracted."""

    class Faulty(Reader):
        def inertial(self, *read):
            right = super().inertial(*read)
            about_origin = right.tensor + shifted(right.mass, right.center)
            return Inertial(right.mass, right.center, about_origin + shifted(right.mass, right.center))

    return torques(Faulty(), path)


@exhibit(
    "RigidBodyDynamics.jl", 2017, "JuliaRobotics/RigidBodyDynamics.jl/pull/226", truth="first moment|divided by .*mass"
)
def center_of_mass_for_first_moment(path):
    """The center of mass stands where the mass times the center of mass belongs; tensors about the origin are right."""

    class Faulty(Reader):
        def inertial(self, *read):
            right = super().inertial(*read)
            about_origin, center = right.tensor + shifted(right.mass, right.center), right.center / right.mass
            return Inertial(right.mass, center, about_origin - shifted(right.mass, center))

    return torques(Faulty(), path)


@exhibit("SymPyBotics", 2019, "cdsousa/SymPyBotics/issues/25", truth=("first moment|divided by .*mass", "tensor"))
def parameters_of_another_meaning(path):
    """A user gives the center of mass for the first moment, and the tensor about it for that about the link origin."""

    class Faulty(Reader):
        def inertial(self, *read):
            right = super().inertial(*read)
            center = right.center / right.mass
            return Inertial(right.mass, center, right.tensor - shifted(right.mass, center))

    return torques(Faulty(), path)


@exhibit(
    "SDFormat", 2013, "gazebosim/sdformat/issues/22", "osrf/drcsim/issues/308", truth="tensor of body 'forearm'|bracket"
)
def fixed_link_joined_about_its_origin(path):
    """Tensors of two links that become one are shifted from their link origins, as if they were given about these."""

    class Faulty(Reader):
        def with_fixed(self, link, rotation, translation, fixed):
            if fixed.mass == 0:
                return link
            right, placed = link.joined(fixed.seen_from(rotation, translation)), fixed.seen_from(rotation, translation)
            tensor = link.tensor + placed.tensor + shifted(fixed.mass, translation)
            return Inertial(right.mass, right.center, tensor)

    return torques(Faulty(), path)


@exhibit("MuJoCo", 2025, "google-deepmind/mujoco/issues/2982", truth="tensor of body 'forearm'|bracket")
def fixed_link_joined_unturned(path):
    """The tensor of a fixed link is added in its own axes, its place is right."""

    class Faulty(Reader):
        def with_fixed(self, link, rotation, translation, fixed):
            placed = fixed.seen_from(rotation, translation)
            return link if fixed.mass == 0 else link.joined(Inertial(fixed.mass, placed.center, fixed.tensor))

    return torques(Faulty(), path)


@exhibit("Bullet", 2025, "bulletphysics/bullet3/pull/4683", truth="center of mass.* of links? .*'(hand|forearm)'")
def center_of_mass_of_the_parent_ignored(path):
    """Where a fixed link is joined, the center of mass of its parent counts as zero."""

    class Faulty(Reader):
        def with_fixed(self, link, rotation, translation, fixed):
            placed = fixed.seen_from(rotation, translation)
            return Inertial(link.mass, 0 * link.center, link.tensor).joined(placed)

    return torques(Faulty(), path)


@exhibit(
    "jsk_control", 2019, "jsk-ros-pkg/jsk_control/pull/714", truth="fixed link.* left out", judged_as="gravity_torque"
)
def mass_of_unlisted_links_left_out(path):
    """Links that are not in the robot's list, such as those on fixed joints, have no weight."""

    class Faulty(Reader):
        def with_fixed(self, link, rotation, translation, fixed):
            return link

    return NewtonEuler(Faulty().arm(path)).gravity_torque


@exhibit("COMPAS", 2021, "compas-dev/compas/issues/864", truth="joint 'reach'")
def axis_of_a_slide_not_normalized(path):
    """The axis of a sliding joint is taken as it stands: (0, 0, 2) doubles all its motions."""

    class Faulty(Reader):
        def axis(self, xyz):
            return xyz

    return torques(Faulty(), path)


@exhibit("fusion2urdf", 2020, "syuntoku14/fusion2urdf/pull/27", truth="0\\.01|100")
def axes_converted_like_lengths(path):
    """Axes are converted from centimeters to meters like positions: joints move a hundredth of the way."""

    right = torques(Reader(), path)
    return lambda q, v, a: right(q / 100, v / 100, a / 100) / 100


@exhibit("o3de", 2022, "RobotecAI/o3de-ros2-gem/issues/167", truth="ax[ei]s .*joint")
def every_axis_is_x(path):
    """Hinges turn about the x axis of their frames, whatever the file says."""

    class Faulty(Reader):
        def axis(self, xyz):
            return np.array([1.0, 0.0, 0.0])

    return torques(Faulty(), path)


def of_one_body(path, number, change):
    """The code of a file in which one body has another tensor: change(inertial)."""
    arm = Reader().arm(path)
    arm[number] = arm[number].but(tensor=change(arm[number].inertial))
    return NewtonEuler(arm).inverse_dynamics


@exhibit("Husky", 2016, "husky/husky/pull/35", truth="body 'wrist'|wrist_2_link")
def moments_of_a_wheel_exchanged(path):
    """In a robot's file, I_yy and I_zz of a wheel are exchanged, because its axis is y."""
    return of_one_body(
        path, 4, lambda right: right.tensor - np.diag([0, 1, -1]) * (right.tensor[1, 1] - right.tensor[2, 2])
    )


@exhibit("calc-inertia", 2022, "gstavrinos/calc-inertia/pull/8", truth="tensor of body 'hand'")
def tensor_without_mass(path):
    """The moments of a cylinder about its diameters lack the factor m."""

    def cylinder(right):
        radius, height = 0.04, 0.15
        across = (3 * radius**2 + height**2) / 12
        return np.diag([across, across, right.mass * radius**2 / 2])

    return of_one_body(path, 5, cylinder)


@exhibit("Open Mobile Manipulator", 2020, "panagelak/Open_Mobile_Manipulator/issues/2", truth="body 'hand'")
def box_with_two_equal_moments(path):
    """I_zz of a box is that of I_yy: m (x² + z²) / 12."""
    return of_one_body(path, 5, lambda right: right.tensor + np.diag([0, 0, right.tensor[1, 1] - right.tensor[2, 2]]))


@exhibit("Nav2 tutorials", 2021, "ros-navigation/navigation2_tutorials/issues/26", truth="body 'hand'")
def box_in_other_axes(path):
    """The moments of a box are written for other axes than those of its shape: x, y, z are rotated cyclically."""
    return of_one_body(path, 5, lambda right: np.roll(right.tensor, (1, 1), (0, 1)))
