"""Textbook codes in plain NumPy, all right. An exhibit of the museum replaces one method, or one step of the reader.

Vectors are (3,), in link axes unless a name says otherwise. Spatial vectors are (6,), angular first.
"""

from dataclasses import dataclass, replace
from xml.etree import ElementTree

import numpy as np

GRAVITY = np.array([0.0, 0.0, -9.81])


def skew(x):
    """skew(x) @ y is x × y."""
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def cross(x, y):
    return skew(x) @ y


def rotation_about(axis, angle):
    """Rodrigues' formula for a unit axis."""
    s = skew(axis)
    return np.eye(3) + np.sin(angle) * s + (1 - np.cos(angle)) * s @ s


X, Y, Z = np.eye(3)


def rotation_of_rpy(roll, pitch, yaw):
    """About fixed axes: first x, then y, then z."""
    return rotation_about(Z, yaw) @ rotation_about(Y, pitch) @ rotation_about(X, roll)


def shifted(mass, arm):
    """What a mass at this distance adds to a tensor."""
    return mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))


@dataclass(frozen=True)
class Inertial:
    """Mass, center of mass, tensor about the center of mass in link axes."""

    mass: float
    center: np.ndarray
    tensor: np.ndarray

    def seen_from(self, rotation, translation):
        """In the axes of a link in which this one lies so."""
        return Inertial(self.mass, translation + rotation @ self.center, rotation @ self.tensor @ rotation.T)

    def joined(self, other):
        mass = self.mass + other.mass
        center = (self.mass * self.center + other.mass * other.center) / mass
        tensors = (part.tensor + shifted(part.mass, part.center - center) for part in (self, other))
        return Inertial(mass, center, sum(tensors))


@dataclass(frozen=True)
class Link:
    """A link and the joint before it. inside: number of the link before, -1 for the base."""

    inside: int
    slides: bool
    rotation: np.ndarray
    translation: np.ndarray
    axis: np.ndarray
    inertial: Inertial

    def placed(self, q):
        """R, r in the axes of the inside link."""
        if self.slides:
            return self.rotation, self.translation + self.rotation @ self.axis * q
        return self.rotation @ rotation_about(self.axis, q), self.translation

    def but(self, **inertial):
        return replace(self, inertial=replace(self.inertial, **inertial))


class Reader:
    """Reads a URDF file as its specification says; fixed links become part of the link that they are fixed to."""

    def rotation(self, roll, pitch, yaw):
        return rotation_of_rpy(roll, pitch, yaw)

    def axis(self, xyz):
        return xyz / np.linalg.norm(xyz)

    def matrix(self, xx, xy, xz, yy, yz, zz):
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def tensor(self, mass, center, rotation, tensor):
        """About the center of mass, in link axes."""
        return rotation @ tensor @ rotation.T

    def inertial(self, mass, center, rotation, tensor, is_placed):
        """is_placed: whether the file has an <origin>."""
        return Inertial(mass, center, self.tensor(mass, center, rotation, tensor))

    def without_inertial(self):
        return Inertial(0.0, np.zeros(3), np.zeros((3, 3)))

    def with_fixed(self, link, rotation, translation, fixed):
        return link if fixed.mass == 0 else link.joined(fixed.seen_from(rotation, translation))

    def arm(self, path):
        """The links in the order of the joints in the file, parents first."""
        robot = ElementTree.parse(path).getroot()
        inertials = {link.get("name"): self._inertial(link.find("inertial")) for link in robot.findall("link")}
        links, number, joints = [], {}, robot.findall("joint")
        for joint in reversed([joint for joint in joints if joint.get("type") == "fixed"]):
            inside, name = joint.find("parent").get("link"), joint.find("child").get("link")
            inertials[inside] = self.with_fixed(inertials[inside], *self._origin(joint), inertials[name])
        for joint in (joint for joint in joints if joint.get("type") != "fixed"):
            inside, name = joint.find("parent").get("link"), joint.find("child").get("link")
            number[name] = len(links)
            axis = self.axis(_numbers(joint.find("axis").get("xyz")))
            slides = joint.get("type") == "prismatic"
            links.append(Link(number.get(inside, -1), slides, *self._origin(joint), axis, inertials[name]))
        return links

    def _origin(self, element):
        origin = element.find("origin")
        xyz, rpy = ("0 0 0", "0 0 0") if origin is None else (origin.get(x, "0 0 0") for x in ("xyz", "rpy"))
        return self.rotation(*_numbers(rpy)), _numbers(xyz)

    def _inertial(self, element):
        if element is None:
            return self.without_inertial()
        rotation, center = self._origin(element)
        six = [float(element.find("inertia").get(f"i{x}")) for x in ("xx", "xy", "xz", "yy", "yz", "zz")]
        is_placed = element.find("origin") is not None
        return self.inertial(float(element.find("mass").get("value")), center, rotation, self.matrix(*six), is_placed)


def _numbers(text):
    return np.array([float(x) for x in text.split()])


class NewtonEuler:
    """Luh, Walker and Paul in link axes. gravity: in world axes."""

    gravity = GRAVITY

    def __init__(self, arm):
        self.arm = arm

    def inverse_dynamics(self, q, v, a):
        moving = []
        for link, *motion in zip(self.arm, q, v, a, strict=True):
            inside = moving[link.inside] if link.inside >= 0 else self.base()
            moving.append(self.carried(link, *link.placed(motion[0]), *motion[1:], *inside))
        wrenches = [list(self.wrench(link, *motion)) for link, motion in zip(self.arm, moving, strict=True)]
        tau = np.empty(len(q))
        for j in reversed(range(len(q))):
            link, (force, moment) = self.arm[j], wrenches[j]
            tau[j] = self.joint_torque(link, force, moment)
            if link.inside >= 0:
                passed = self.passed_on(*link.placed(q[j]), force, moment)
                wrenches[link.inside] = [x + y for x, y in zip(wrenches[link.inside], passed, strict=True)]
        return tau

    def base(self):
        """ω, ω̇ and the acceleration of the base, which stands for gravity."""
        return np.zeros(3), np.zeros(3), -self.gravity

    def carried(self, link, rotation, arm, v, a, omega, alpha, acceleration):
        """ω, ω̇ and the acceleration of the origin of a link."""
        acceleration = self.of_point(rotation, arm, omega, alpha, acceleration)
        omega, alpha, p = rotation.T @ omega, rotation.T @ alpha, link.axis
        if link.slides:
            return omega, alpha, acceleration + 2 * cross(omega, p * v) + p * a
        return omega + p * v, alpha + cross(omega, p * v) + p * a, acceleration

    def of_point(self, rotation, arm, omega, alpha, acceleration):
        return rotation.T @ (acceleration + cross(alpha, arm) + cross(omega, cross(omega, arm)))

    def wrench(self, link, omega, alpha, acceleration):
        """Force and moment about the link origin that a link needs."""
        c, inertial = link.inertial.center, link.inertial
        force = inertial.mass * (acceleration + cross(alpha, c) + cross(omega, cross(omega, c)))
        moment = inertial.tensor @ alpha + cross(omega, inertial.tensor @ omega)
        return force, moment + cross(c, force)

    def joint_torque(self, link, force, moment):
        return link.axis @ (force if link.slides else moment)

    def passed_on(self, rotation, arm, force, moment):
        """Force and moment about the inside link's origin, in its axes."""
        return rotation @ force, rotation @ moment + cross(arm, rotation @ force)

    def gravity_torque(self, q):
        return self.inverse_dynamics(q, 0 * q, 0 * q)

    def mass_matrix(self, q):
        still = self.gravity_torque(q)
        return np.stack([self.inverse_dynamics(q, 0 * q, unit) - still for unit in np.eye(len(q))], axis=1)


def motion_transform(rotation, arm):
    """X of a motion from the inside link to a link that lies so in it."""
    return np.block([[rotation.T, np.zeros((3, 3))], [-rotation.T @ skew(arm), rotation.T]])


def motion_cross(v):
    """v × of motions."""
    return np.block([[skew(v[:3]), np.zeros((3, 3))], [skew(v[3:]), skew(v[:3])]])


def force_cross(v):
    """v ×* of forces."""
    return -motion_cross(v).T


class Spatial:
    """Featherstone's recursion, and his composite bodies."""

    def __init__(self, arm):
        self.arm = arm
        self.subspaces = [np.concatenate([0 * x.axis, x.axis] if x.slides else [x.axis, 0 * x.axis]) for x in arm]
        self.inertias = [self.inertia(x.inertial.mass, x.inertial.center, x.inertial.tensor) for x in arm]

    def inertia(self, mass, center, tensor):
        """About the link origin."""
        c = skew(center)
        return np.block([[tensor + mass * c @ c.T, mass * c], [mass * c.T, mass * np.eye(3)]])

    def transforms(self, q):
        return [motion_transform(*link.placed(x)) for link, x in zip(self.arm, q, strict=True)]

    def inverse_dynamics(self, q, v, a):
        transforms, forces, moving = self.transforms(q), [], []
        for j, link in enumerate(self.arm):
            base = np.zeros(6), np.concatenate([np.zeros(3), -GRAVITY])
            velocity, acceleration = moving[link.inside] if link.inside >= 0 else base
            moving.append(self.carried(transforms[j], self.subspaces[j], v[j], a[j], velocity, acceleration))
            forces.append(self.force(self.inertias[j], *moving[j]))
        tau = np.empty(len(q))
        for j in reversed(range(len(q))):
            tau[j] = self.subspaces[j] @ forces[j]
            if self.arm[j].inside >= 0:
                forces[self.arm[j].inside] += self.passed_on(transforms[j], forces[j])
        return tau

    def carried(self, transform, subspace, v, a, velocity, acceleration):
        here = transform @ velocity + subspace * v
        return here, transform @ acceleration + subspace * a + motion_cross(here) @ subspace * v

    def force(self, inertia, velocity, acceleration):
        return inertia @ acceleration + force_cross(velocity) @ inertia @ velocity

    def passed_on(self, transform, force):
        return transform.T @ force

    def mass_matrix(self, q):
        transforms, composite, n = self.transforms(q), [x.copy() for x in self.inertias], len(q)
        matrix = np.zeros((n, n))
        for j in reversed(range(n)):
            if self.arm[j].inside >= 0:
                composite[self.arm[j].inside] += self.moved(composite[j], *self.arm[j].placed(q[j]))
            force, k = composite[j] @ self.subspaces[j], j
            matrix[j, j] = self.subspaces[j] @ force
            while self.arm[k].inside >= 0:
                force, k = transforms[k].T @ force, self.arm[k].inside
                matrix[j, k] = matrix[k, j] = self.subspaces[k] @ force
        return matrix

    def moved(self, inertia, rotation, arm):
        """An inertia in the axes and about the origin of the inside link."""
        transform = motion_transform(rotation, arm)
        return transform.T @ inertia @ transform

    def body_jacobians(self, q, v):
        """Per link J and its derivative, in link coordinates (6, n), and the velocity."""
        transforms, found = self.transforms(q), []
        for j, link in enumerate(self.arm):
            jacobian, derivative = found[link.inside][:2] if link.inside >= 0 else np.zeros((2, 6, len(q)))
            carried = transforms[j] @ jacobian
            drift = transforms[j] @ derivative - motion_cross(self.subspaces[j] * v[j]) @ carried
            jacobian = carried + np.outer(self.subspaces[j], np.eye(len(q))[j])
            found.append((jacobian, drift, jacobian @ v))
        return found

    def coriolis_matrix(self, q, v):
        """Echeandia and Wensing, 2021: the sum of Jᵀ (I J̇ + B J), J̇ seen from the ground."""
        terms = zip(self.inertias, self.body_jacobians(q, v), strict=True)
        return sum(
            j.T @ (i @ (derivative + motion_cross(velocity) @ j) + self.velocity_terms(i, velocity) @ j)
            for i, (j, derivative, velocity) in terms
        )

    def velocity_terms(self, inertia, velocity):
        """B with B v = v ×* I v."""
        turned = np.stack([force_cross(unit) @ inertia @ velocity for unit in np.eye(6)], axis=1)
        return (force_cross(velocity) @ inertia + turned - inertia @ motion_cross(velocity)) / 2


class Kinematics:
    """Places and velocities in the world. tool: R, r of the tool in the last link."""

    def __init__(self, arm, tool):
        self.arm, self.tool = arm, tool

    def places(self, q):
        """R, r of every link."""
        found = []
        for link, x in zip(self.arm, q, strict=True):
            turn, at = found[link.inside] if link.inside >= 0 else (np.eye(3), np.zeros(3))
            rotation, arm = link.placed(x)
            found.append((turn @ rotation, at + turn @ arm))
        return found

    def jacobian_of(self, q, body, point):
        """Linear, then angular rows of a point of a body, both in world axes (6, n)."""
        places, jacobian = self.places(q), np.zeros((6, len(q)))
        while body >= 0:
            turn, at = places[body]
            p = turn @ self.arm[body].axis
            jacobian[:, body] = np.concatenate([p, 0 * p] if self.arm[body].slides else [cross(p, point - at), p])
            body = self.arm[body].inside
        return jacobian

    def frame_placement(self, q):
        turn, at = self.places(q)[-1]
        return np.block([[turn @ self.tool[0], (at + turn @ self.tool[1])[:, None]], [np.zeros(3), 1.0]])

    def frame_jacobian(self, q):
        return self.jacobian_of(q, len(q) - 1, self.frame_placement(q)[:3, 3])

    def frame_acceleration(self, q, v, a):
        """Of the point that moves with the tool, in world axes."""
        state = np.zeros(3), np.zeros(3), np.zeros(3)
        recursion = NewtonEuler(self.arm)
        for link, *motion in zip(self.arm, q, v, a, strict=True):  # a chain
            state = recursion.carried(link, *link.placed(motion[0]), *motion[1:], *state)
        omega, alpha, acceleration = (self.places(q)[-1][0] @ x for x in state)
        arm = self.places(q)[-1][0] @ self.tool[1]
        return np.concatenate([acceleration + cross(alpha, arm) + cross(omega, cross(omega, arm)), alpha])

    def centers(self, q):
        places = zip(self.arm, self.places(q), strict=True)
        return [at + turn @ link.inertial.center for link, (turn, at) in places]

    def center_of_mass(self, q):
        masses = [link.inertial.mass for link in self.arm]
        return masses @ np.array(self.centers(q)) / sum(masses)

    def center_of_mass_jacobian(self, q):
        linear = (self.jacobian_of(q, k, x)[:3] for k, x in enumerate(self.centers(q)))
        masses = [link.inertial.mass for link in self.arm]
        return sum(mass * j for mass, j in zip(masses, linear, strict=True)) / sum(masses)

    def potential_energy(self, q):
        return -sum(link.inertial.mass * GRAVITY @ x for link, x in zip(self.arm, self.centers(q), strict=True))

    def kinetic_energy(self, q, v):
        return v @ Spatial(self.arm).mass_matrix(q) @ v / 2
