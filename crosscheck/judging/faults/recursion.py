"""Newton-Euler recursion of many codes at once, each with its own numbers, arguments and answers.

Luh, Walker and Paul, "On-line computational scheme for mechanical manipulators", 1980, in link axes. graphdyn has
faster ones; in this one every number and every term that a code can have wrong is a number of its own, per code.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from graphdyn import RobotModel
from graphdyn.layout import Array

State = tuple[Array, Array, Array]
"""q, v, a (R, n)."""

MAX_ROWS_AT_ONCE = 60_000
"""Rows of all codes together that are computed at once: a hundred megabytes."""


@dataclass(frozen=True, eq=False)
class Numbers:
    """All that the recursion is computed from. Factors other than 1 are faults.

    rotations (n, 3, 3), translations (n, 3), axes (n, 3): of the joints, in link axes of the inside body, in joint axes
    masses (n,), centers (n, 3), tensors (n, 3, 3): of the bodies, tensors about the center of mass, in link axes
    gravity: (3,) in axes of the ground
    weight: on m g of a body (n,); carried: on the inside body's ω in that of body j (n,)
    cross: on ω × q̇ p (n,); centripetal: on ω × (ω × r) (n,), up to O_j and in body j; sliding: on 2 ω × ṡ (n,)
    gyroscopic: on ω × J ω (n,)
    """

    rotations: Array
    translations: Array
    axes: Array
    masses: Array
    centers: Array
    tensors: Array
    gravity: Array
    weight: Array
    carried: Array
    cross: Array
    centripetal: Array
    sliding: Array
    gyroscopic: Array


Recursion = Callable[["DynamicsCode", Numbers, State], Array]
"""(code, numbers (…, 1, 1), q, v, a (n, 1, R)) → torques (n, 1, R)."""


@dataclass(frozen=True, eq=False)
class DynamicsCode:
    """A dynamics code: τ = answer(recursion(arguments(q, v, a)), q, v, a), the changes one after the other.

    inside: number of the inside body of each joint, 0 for the ground; prismatic: whether the joint slides
    recursion: gives the torques in place of the one below, or another function
    """

    inside: tuple[int, ...]
    prismatic: tuple[bool, ...]
    numbers: Numbers
    arguments: tuple[Callable[[Array, Array, Array], State], ...] = ()
    answers: tuple[Callable[[Array, State], Array], ...] = ()
    recursion: Recursion | None = None

    @classmethod
    def of(cls, model: RobotModel) -> DynamicsCode:
        """A code without fault."""
        joints, bodies, n = model.joints, model.bodies, model.n_bodies
        factors = ("weight", "carried", "cross", "centripetal", "sliding", "gyroscopic")
        numbers = Numbers(
            rotations=np.array([joint.placement.rotation for joint in joints]),
            translations=np.array([joint.placement.translation for joint in joints]),
            axes=np.array([joint.axis for joint in joints]),
            masses=np.array([body.mass for body in bodies]),
            centers=np.array([body.center_of_mass for body in bodies]),
            tensors=np.array([body.inertia for body in bodies]),
            gravity=model.base.rotation.T @ model.gravity,
            **{name: np.ones(n) for name in factors},
        )
        return cls(tuple(joint.inside for joint in joints), tuple(joint.is_prismatic for joint in joints), numbers)

    def but(self, **numbers: Array) -> DynamicsCode:
        """The code with other numbers."""
        return dataclasses.replace(self, numbers=Numbers(**{**vars(self.numbers), **numbers}))

    def taking(self, arguments: Callable[[Array, Array, Array], State]) -> DynamicsCode:
        """The code with its arguments changed before anything else."""
        return dataclasses.replace(self, arguments=(arguments, *self.arguments))

    def giving(self, answer: Callable[[Array, State], Array]) -> DynamicsCode:
        """The code with its answer changed after everything else; answer(tau, (q, v, a))."""
        return dataclasses.replace(self, answers=(*self.answers, answer))


def torques_of(codes: Sequence[DynamicsCode], state: State) -> Array:
    """Torques (K, R, n) of K codes for one robot at R states (R, n) each, or what their recursions give in place of
    torques. Complex numbers give complex torques."""
    size = max(1, MAX_ROWS_AT_ONCE // len(state[0]))
    found = []
    for _, group in groupby(codes, key=lambda code: code.recursion):
        alike = list(group)
        found += [_torques(alike[k : k + size], state) for k in range(0, len(alike), size)]
    return np.concatenate(found)


def numbers_of(codes: Sequence[DynamicsCode]) -> Numbers:
    """The numbers of K codes side by side (…, K, 1)."""
    fields = [field.name for field in dataclasses.fields(Numbers)]
    return Numbers(**{x: np.stack([getattr(code.numbers, x) for code in codes], axis=-1)[..., None] for x in fields})


def _torques(codes: Sequence[DynamicsCode], state: State) -> Array:
    given = []
    for code in codes:
        arguments = state
        for change in code.arguments:
            arguments = change(*arguments)
        given.append(arguments)
    q, v, a = (np.moveaxis(np.stack(x), -1, 0) for x in zip(*given, strict=True))
    recursion = codes[0].recursion or torque_recursion
    tau = np.moveaxis(recursion(codes[0], numbers_of(codes), (q, v, a)), 0, -1)
    if not any(code.answers for code in codes):
        return tau
    answered = []
    for code, own in zip(codes, tau, strict=True):
        for answer in code.answers:
            own = answer(own, state)
        answered.append(own)
    return np.stack(answered)


def torque_recursion(code: DynamicsCode, x: Numbers, state: State) -> Array:
    """Torques (n, K, R) from numbers (…, K, 1) and states (n, K, R)."""
    forces, moments = wrenches(code, x, state)
    vectors = (forces[j] if slides else moments[j] for j, slides in enumerate(code.prismatic))
    return np.stack(np.broadcast_arrays(*((p * vector).sum(axis=0) for p, vector in zip(x.axes, vectors, strict=True))))


def wrenches(code: DynamicsCode, x: Numbers, state: State) -> tuple[list[Array], list[Array]]:
    """Forces and moments of the joints about the link origins, in link axes (3, K, R), from numbers (…, K, 1)."""
    q, v, a = state
    nothing = np.zeros((3, 1, 1))
    omega, alpha, linear, gravity = [nothing], [nothing], [nothing], [x.gravity]
    turns: list[Array] = []
    arms: list[Array] = []
    forces: list[Array] = []
    moments: list[Array] = []
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p = x.axes[j]
        turn, arm = joint_placement(code, x, q, j)
        carried = x.carried[j] * turned_back(turn, omega[inside])
        spin, slide = (0.0 * p, p * v[j]) if slides else (p * v[j], 0.0 * p)
        omega.append(carried + spin)
        alpha.append(
            turned_back(turn, alpha[inside]) + x.cross[j] * crossed(carried, spin) + (0.0 if slides else p * a[j])
        )
        w = omega[inside]
        moved = linear[inside] + crossed(alpha[inside], arm) + x.centripetal[j] * crossed(w, crossed(w, arm))
        linear.append(
            turned_back(turn, moved) + 2 * x.sliding[j] * crossed(carried, slide) + (p * a[j] if slides else 0.0)
        )
        gravity.append(turned_back(turn, gravity[inside]))
        w, c, tensor = omega[-1], x.centers[j], x.tensors[j]
        at_center = linear[-1] + crossed(alpha[-1], c) + x.centripetal[j] * crossed(w, crossed(w, c))
        force = x.masses[j] * (at_center - x.weight[j] * gravity[-1])
        moment = turned(tensor, alpha[-1]) + x.gyroscopic[j] * crossed(w, turned(tensor, w)) + crossed(c, force)
        for kept, x_j in ((turns, turn), (arms, arm), (forces, force), (moments, moment)):
            kept.append(x_j)
    for j in reversed(range(len(code.inside))):
        i = code.inside[j] - 1
        if i >= 0:
            push = turned(turns[j], forces[j])
            forces[i] = forces[i] + push
            moments[i] = moments[i] + turned(turns[j], moments[j]) + crossed(arms[j], push)
    return forces, moments


def joint_placement(code: DynamicsCode, x: Numbers, q: Array, j: int) -> tuple[Array, Array]:
    """Rotation (3, 3, …) from the link outside of a joint to the inside link, and the link origin there (3, …)."""
    p, rotation, translation = x.axes[j], x.rotations[j], x.translations[j]
    if code.prismatic[j]:
        return rotation, translation + turned(rotation, p * q[j])
    return times(rotation, turned_about(p, q[j])), translation


def turned_about(p: Array, angle: Array) -> Array:
    """Rotation (3, 3, …) about p (3, …) by the angle: Rodrigues."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = p[0] + 0 * s, p[1] + 0 * s, p[2] + 0 * s
    k = 1 - c
    return np.array(
        [
            [c + k * x * x, k * x * y - s * z, k * x * z + s * y],
            [k * x * y + s * z, c + k * y * y, k * y * z - s * x],
            [k * x * z - s * y, k * y * z + s * x, c + k * z * z],
        ]
    )


def times(x: Array, y: Array) -> Array:
    """Product of two matrices (3, 3, …)."""
    product: Array = (x[:, :, None] * y[None]).sum(axis=1)
    return product


def turned(matrix: Array, x: Array) -> Array:
    """A matrix (3, 3, …) times x (3, …)."""
    product: Array = matrix[:, 0] * x[0] + matrix[:, 1] * x[1] + matrix[:, 2] * x[2]
    return product


def turned_back(matrix: Array, x: Array) -> Array:
    """The transposed matrix times x."""
    product: Array = matrix[0] * x[0] + matrix[1] * x[1] + matrix[2] * x[2]
    return product


def crossed(x: Array, y: Array) -> Array:
    """x × y of vectors (3, …)."""
    return np.array([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]])
