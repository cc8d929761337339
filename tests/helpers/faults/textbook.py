"""A textbook recursion, written for these tests alone, with places where things go wrong.

Luh, Walker and Paul, "On-line computational scheme for mechanical manipulators", 1980, in link axes; sliding joints
as in Siciliano et al., "Robotics: Modeling, Planning and Control", 2009, section 7.5.
"""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np


def cross(a, b):
    """a × b of two vectors (3,), of double precision in Python's own numbers, which are quicker."""
    (a1, a2, a3), (b1, b2, b3) = (a.tolist(), b.tolist()) if a.dtype == b.dtype == float else (a, b)
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def turned(p, angle):
    """The rotation about the unit axis p (3,) by an angle, of Rodrigues' formula."""
    (x, y, z), c, s = p.tolist(), math.cos(angle), math.sin(angle)
    k = 1 - c
    return np.array(
        [
            [c + k * x * x, k * x * y - s * z, k * x * z + s * y],
            [k * x * y + s * z, c + k * y * y, k * y * z - s * x],
            [k * x * z - s * y, k * y * z + s * x, c + k * z * z],
        ]
    )


@dataclass(frozen=True, eq=False)
class TextbookArm:
    """Plain arrays per joint and body, in the order of the joints. Factors other than 1 are faults.

    cross: on ω × q̇ p; centripetal: on ω × (ω × r); gyroscopic: on ω × I ω; slide: on 2 ω × ṡ; carried: on the inside
    body's ω in that of body j; weight: on m g. One number, or one per joint
    """

    inside: tuple[int, ...]
    prismatic: tuple[bool, ...]
    rotations: np.ndarray
    translations: np.ndarray
    axes: np.ndarray
    masses: np.ndarray
    centers: np.ndarray
    tensors: np.ndarray
    gravity: np.ndarray
    cross: float = 1.0
    centripetal: float = 1.0
    gyroscopic: float = 1.0
    slide: float = 1.0
    carried: float = 1.0
    weight: float = 1.0

    @classmethod
    def of(cls, model):
        """The same robot as a RobotModel on an unturned base."""
        bodies, joints = model.bodies, model.joints
        return cls(
            tuple(joint.inside for joint in joints),
            tuple(joint.kind == "prismatic" for joint in joints),
            np.array([joint.placement.rotation for joint in joints]),
            np.array([joint.placement.translation for joint in joints]),
            np.array([joint.axis for joint in joints]),
            np.array([body.mass for body in bodies]),
            np.array([body.center_of_mass for body in bodies]),
            np.array([body.inertia for body in bodies]),
            model.base.rotation.T @ model.gravity,
        )

    def but(self, **changes):
        return dataclasses.replace(self, **changes)

    def in_single_precision(self):
        """The same arm, its numbers and all that is computed from them rounded to 24 bits."""
        arrays = ("rotations", "translations", "axes", "masses", "centers", "tensors", "gravity")
        return self.but(**{name: getattr(self, name).astype(np.float32) for name in arrays})

    def inverse_dynamics(self, q, v, a):
        n, kind = len(q), self.centers.dtype
        q, v, a, zero = q.astype(kind), v.astype(kind), a.astype(kind), np.zeros(3, kind)
        factors = (self.cross, self.centripetal, self.gyroscopic, self.slide, self.carried, self.weight)
        cross_, centripetal, gyroscopic, slide, carry, weight = (np.broadcast_to(x, n).astype(kind) for x in factors)
        omega, alpha, acceleration, gravity = [zero], [zero], [zero], [self.gravity]
        turn, arm, force, moment = [], [], [], []
        for j in range(n):
            i, p = self.inside[j], self.axes[j]
            sliding = self.prismatic[j]
            about = turned(p, q[j]).astype(kind)
            turn.append(self.rotations[j] if sliding else self.rotations[j] @ about)
            arm.append(self.translations[j] + (self.rotations[j] @ p * q[j] if sliding else 0))
            back = turn[j].T
            carried = carry[j] * (back @ omega[i])
            gravity.append(back @ gravity[i])
            spin, push = (0.0, v[j]) if sliding else (v[j], 0.0)
            omega.append(carried + spin * p)
            alpha.append(back @ alpha[i] + (0 if sliding else a[j] * p) + cross_[j] * cross(carried, spin * p))
            r_dd = acceleration[i] + cross(alpha[i], arm[j])
            r_dd = r_dd + centripetal[j] * cross(omega[i], cross(omega[i], arm[j]))
            acceleration.append(back @ r_dd + (a[j] * p if sliding else 0) + 2 * slide[j] * cross(carried, push * p))
            w, c, tensor = omega[-1], self.centers[j], self.tensors[j]
            at_center = acceleration[-1] + cross(alpha[-1], c) + centripetal[j] * cross(w, cross(w, c))
            force.append(self.masses[j] * (at_center - weight[j] * gravity[-1]))
            spin_moment = tensor @ alpha[-1] + gyroscopic[j] * cross(w, tensor @ w)
            moment.append(spin_moment + cross(c, force[j]))
        tau = np.empty(n, kind)
        for j in reversed(range(n)):
            tau[j] = self.axes[j] @ (force[j] if self.prismatic[j] else moment[j])
            if (i := self.inside[j]) > 0:
                push = turn[j] @ force[j]
                force[i - 1] = force[i - 1] + push
                moment[i - 1] = moment[i - 1] + turn[j] @ moment[j] + cross(arm[j], push)
        return tau

    def mass_matrix(self, q):
        still = self.but(gravity=np.zeros(3))
        zero = np.zeros_like(q)
        return np.stack([still.inverse_dynamics(q, zero, e) for e in np.eye(len(q))], axis=-1)

    def forward_dynamics(self, q, v, tau):
        return np.linalg.solve(self.mass_matrix(q), tau - self.inverse_dynamics(q, v, np.zeros_like(q)))
