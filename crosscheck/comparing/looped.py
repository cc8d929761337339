"""Robots with loops: graphdyn's constrained dynamics beside Pinocchio's.

All other quantities are those of the tree, whose joints are free: derivatives, regressors, energies and the rest do not
know of loops in Pinocchio.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import largest
from crosscheck.quantities.states import ACCELERATION_RANGE, LOAD, Case
from crosscheck.quantities.tolerances import CLOSED, CLOSED_WRENCH, EPS
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.pinocchio_model.closed import POINT_CHORD_KINDS, closed_dynamics
from graphdyn import (
    InvalidInput,
    Placement,
    RobotModel,
    assemble,
    inverse_dynamics,
    joint_torques,
)
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model import LOOP_RANK_TOLERANCE, loop_spaces, rotation_about

MAX_LOOPED_STATES = 20
"""Largest number of states: closing loops takes long, and the other quantities have looked at the tree."""

ROUNDING_APART = 40 * EPS
"""Relative rounding of the accelerations at which the points of a chord move apart: sums over all joints of a loop."""


def why_not_closed(model: RobotModel) -> str | None:
    """Why Pinocchio cannot be asked about these loops."""
    unknown = sorted({chord.kind for chord in model.chords} - set(POINT_CHORD_KINDS))
    if unknown:
        return f"Pinocchio has no constraint for a {' or '.join(unknown)} that keeps its digits"
    return None


def looped_case(model: RobotModel, samples: int, seed: int) -> Case:
    """Random closed states of a robot without couplings, with torques at all joints and loads on the bodies.

    Every other state has the torques of a slow motion, and small accelerations. Else a load on a link of some
    milligrams accelerates it to 1e9 rad/s², and wrenches drown in the rounding of what the chords accelerate apart.
    """
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, min(samples, MAX_LOOPED_STATES))
    _, v, a = assemble(model, q, v, rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape))
    weight = sum(body.mass for body in model.bodies) * np.linalg.norm(model.gravity)
    wrenches = LOAD * weight * rng.uniform(-1, 1, (len(q), model.n_bodies, 6))
    tau = joint_torques(model.opened, q, v, a) * rng.uniform(0, 2, q.shape)
    balanced = slice(1, None, 2)
    loaded = inverse_dynamics(model.opened, q[balanced], v[balanced], a[balanced], wrenches[balanced])
    tau[balanced] = loaded.tau
    return Case("loops", model, Placement(), q, v, a, tau, wrenches)


def looped_errors(case: Case, ours: ScaledStates, pinocchio: PinocchioModel) -> dict[str, Array]:
    """Errors (N,) of each quantity by name. ours: the same states; pinocchio: its model of the tree"""
    a, wrenches = _closed(case, ours.tau, pinocchio)
    sensitivity = ClosedSensitivity.at(case, ours.mass)
    forces = sensitivity.forces(a, ours.tau, wrenches)
    accelerations, multipliers = sensitivity.accelerations(a, forces), sensitivity.multipliers(a, forces)
    forward, pins = ours.by_methods("forward_dynamics", loaded=True), _along_pins(case, wrenches)
    determined = [np.nan_to_num(answer.joint_wrenches - pins, nan=0.0) for answer in forward]
    required = inverse_dynamics(case.model.opened, case.q, case.v, a, case.external_wrenches)
    summed = sensitivity.forces(a, ours.tau, required.joint_wrenches)
    errors = {
        "closed_backward_error": sensitivity.along_closed_motions(required.tau - ours.tau, summed),
        "closed_forward_dynamics": np.maximum.reduce([largest(answer.a - a) / accelerations for answer in forward]),
        "closed_joint_wrenches": np.maximum.reduce([largest(difference) / multipliers for difference in determined]),
    }
    with suppress(InvalidInput):  # no motors, or motors that leave a motion free
        tau = ours.answer("inverse_dynamics", loaded=True).tau
        moved, _ = _closed(case, tau, pinocchio)
        forces = sensitivity.forces(case.a, tau, wrenches)
        errors["closed_inverse_dynamics"] = largest(moved - case.a) / sensitivity.accelerations(case.a, forces)
    return errors


@dataclass(frozen=True, eq=False)
class ClosedSensitivity:
    """How far a relative rounding of its terms moves the solution of M a + Jᵀλ = f, J a = γ, at N states.

    The tree's own M may be singular, where links have no mass; Zᵀ M Z with the closed motions Z is not.

    mass: M; jacobian: J; condition: of the rows of J that hold something   (N, n, n), (N, m, n), (N,)
    row_condition: ‖∣J⁺∣ ∣J∣‖∞, whatever the units of rows (Skeel, J. ACM 26, 1979)   (N,)
    squares: ‖v‖∞², the terms of γ                                          (N,)
    gap: how far from closed the state is: forces act that far from each other   (N,)
    free: 1 - J⁺J: of a velocity, the nearest closed motion               (N, n, n)
    response: ∣R∣ with R = Z (Zᵀ M Z)⁻¹ Zᵀ: accelerations by torques       (N, n, n)
    shared: ‖M R‖∞: of a torque, what the chords take up                    (N,)
    effective: ‖J⁺ᵀ (M - M R M) J⁺‖∞: multipliers by accelerations of the rows   (N,)
    """

    mass: Array
    jacobian: Array
    condition: Array
    row_condition: Array
    squares: Array
    gap: Array
    free: Array
    response: Array
    shared: Array
    effective: Array

    @classmethod
    def at(cls, case: Case, mass: Array) -> ClosedSensitivity:
        loops = case.model.loops
        jacobian = loops.jacobian(loops.links(case.q))
        inverse = np.linalg.pinv(jacobian, rcond=LOOP_RANK_TOLERANCE)
        held = inverse @ jacobian
        free = np.eye(case.model.nv) - held
        filled = free @ mass @ free + held * np.linalg.norm(mass, axis=(-2, -1), keepdims=True)
        moved = np.linalg.solve(filled, free)
        transmitted = np.swapaxes(inverse, -1, -2) @ (mass - mass @ moved @ mass) @ inverse
        condition, row_condition = 1 / loop_spaces(jacobian).distance, _norm(np.abs(inverse) @ np.abs(jacobian))
        squares, gap, norms = largest(case.v) ** 2, largest(loops.gaps(case.q)), map(_norm, (mass @ moved, transmitted))
        return cls(mass, jacobian, condition, row_condition, squares, gap, free, np.abs(moved), *norms)

    def forces(self, a: Array, tau: Array, wrenches: Array) -> Array:
        """Largest of the forces that are summed in each row of M a + Jᵀλ = f (N, n)."""
        summed = [np.abs(tau), np.abs(wrenches).max(axis=-1), _applied(np.abs(self.mass), np.abs(a))]
        forces: Array = np.maximum.reduce(summed)
        return forces

    def along_closed_motions(self, tau: Array, forces: Array) -> Array:
        """Largest torque (N,) along closed motions, relative to the forces (N, n) that are summed in it.

        Chords cannot balance it. Where links are light, errors of a that accelerations() must allow for show here.
        """
        summed = _applied(np.abs(self.free), forces)
        return largest(_applied(self.free, tau) / np.where(summed > 0, summed, 1.0))

    def accelerations(self, a: Array, forces: Array) -> Array:
        """Scale of errors of a (N,), where forces (N, n) are the largest that are summed."""
        driven = largest(_applied(self.response, forces))
        held = self.condition * (largest(a) + self.squares)
        return held + (self.row_condition + self.gap / CLOSED.bound) * driven

    def multipliers(self, a: Array, forces: Array) -> Array:
        """Scale of errors of λ and of joint wrenches (N,)."""
        apart = largest(_applied(np.abs(self.jacobian), np.abs(a) + self.squares[:, None]))
        inherited = self.effective * apart * (ROUNDING_APART / CLOSED_WRENCH.bound)
        return (self.condition + self.gap / CLOSED_WRENCH.bound) * (1 + self.shared) * largest(forces) + inherited


def _applied(matrices: Array, vectors: Array) -> Array:
    """Products (N, m) of each matrix (N, m, n) with its vector (N, n)."""
    products: Array = np.einsum("kij,kj->ki", matrices, vectors)
    return products


def _norm(matrices: Array) -> Array:
    """‖·‖∞ of each matrix (N, …)."""
    sums: Array = np.abs(matrices).sum(axis=-1).max(axis=-1, initial=0.0)
    return sums


def _closed(case: Case, tau: Array, pinocchio: PinocchioModel) -> Iterator[Array]:
    """Pinocchio's accelerations (N, n) and joint wrenches (N, n, 6)."""
    states = zip(case.q, case.v, tau, case.external_wrenches, strict=True)
    rows = [closed_dynamics(pinocchio, case.model.chords, *state) for state in states]
    return (np.array(column) for column in zip(*rows, strict=True))


def _along_pins(case: Case, wrenches: Array) -> Array:
    """Pinocchio's joint wrenches (N, n, 6), in link axes, along t_1, t_2, p of each joint, fixed in the inside body."""
    model, along = case.model, np.empty_like(wrenches)
    positions = model.joint_positions(case.q)
    for k, joint in enumerate(model.joints):
        triad = np.stack([*joint.axis_normals, joint.axis])
        angle = np.zeros(len(positions)) if joint.is_prismatic else positions[:, k]
        turned = triad @ rotation_about(joint.axis, angle)
        for part in (LINEAR, ANGULAR):
            along[:, k, part] = np.einsum("kab,kb->ka", turned, wrenches[:, k, part])
    return along
