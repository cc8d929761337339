"""Forms of the equations as the paper prints them where they are wrong (docs/deviations.md). Revolute joints only.

Each takes the correct system and puts one error back; only `crosscheck.paper.errata` uses them.

The paper's printed errors, each put back alone into the correct model, and its effect (docs/deviations.md).

The reference is Pinocchio: aba for accelerations, rnea for joint forces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import urdf
from crosscheck.quantities.states import ACCELERATION_RANGE, Case, turned, unit_turn
from crosscheck.quantities.system import kkt_batch
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from graphdyn import KKTSystem, MaximalState, Placement, RobotModel, inverse_dynamics, kr500, maximal_state
from graphdyn.equations import (
    bias_acceleration,
    cardano_drift,
    cardano_form,
    constraints,
    project_accelerations,
    rate_map,
)
from graphdyn.layout import ANGULAR, LINEAR, Array, body_rows, joint_rows, per_body, stacked
from graphdyn.model import apply, cos_beta, rotation_about, skew, solve


def without_d_transposed(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """A1: Eq. (111) with A and B of Eq. (37), whose rotational rows are moments, beside φ_qᵀλ conjugate to θ."""
    form = cardano_form(state, twist)
    return KKTSystem(
        mass=twist.mass @ rate_map(state),
        constraint_jacobian=form.constraint_jacobian,
        force=twist.force - apply(twist.mass, cardano_drift(state)),
        zeta=form.zeta,
    )


def with_unit_d33(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """A4: entry (3,3) of Ḋ equal to 1 in B (Eq. 34, 37), while ζ keeps the right one."""
    form = cardano_form(state, twist)
    excess = np.zeros_like(state.velocity)
    excess[..., 5] = state.cardano_rates[..., 2]  # Ḋ_33 γ̇
    moment = apply(twist.mass, stacked(excess))
    return KKTSystem(
        mass=form.mass,
        constraint_jacobian=form.constraint_jacobian,
        force=form.force - apply(np.swapaxes(rate_map(state), -1, -2), moment),
        zeta=form.zeta,
    )


def world_axis_rows(state: MaximalState) -> Array:
    """A2: φ_q (…, 5n, 6n) with the axis rows of Eq. (71), (72), world x and y components of p_i - p_j."""
    phi_q, _ = constraints(state)
    model, rotation = state.model, state.vertices.rotation
    for j, joint in enumerate(model.joints, start=1):
        axis = rotation[..., joint.inside, :, :] @ (joint.placement.rotation @ joint.axis)
        for body, sign in ((joint.inside, -1.0), (j, 1.0)):  # d(R p)/dt = ω × p = -p̃ R ω^(body)
            if body > 0:
                rows = phi_q[..., joint_rows(j), body_rows(body)]
                rows[..., 3:, ANGULAR] = (sign * skew(axis) @ rotation[..., body, :, :])[..., :2, :]
    return phi_q


ERRATA = {
    "A1": "Eq. (35), (37), (111): moments in body axes beside φ_qᵀλ in Cardano angles; the rotational rows need Dᵀ.",
    "A2": "Eq. (71)-(104): the world x and y rows of p_i - p_j are dependent for a horizontal axis.",
    "A3": "Eq. (29), (33): Cardano angles lose a freedom at cos β = 0; here in the otherwise correct Cardano form.",
    "A4": "Eq. (34): entry (3,3) of Ḋ is 0, printed 1 (put back in B alone).",
    "A5": "Eq. (24): F_i = F_i^g + F̂_i^e; the middle member prints a minus.",
    "A6": "Eq. (42): the row of the identification matrix is z̈ + g, as in (44), not z̈ - g.",
}

MIN_LOCK_COSINE = 0.05
"""Smallest |cos β| of the states at which A1 and A4 are measured, so that they do not include A3."""

COSINES = (1e-2, 1e-3, 1e-4, 1e-6)
"""Values of |cos β| at which A3 is measured."""

N_EFFECTS = 2 * (len(ERRATA) - 1 + len(COSINES))
"""Number of effects that `measure` returns: one per arm and erratum, for A3 one per value of |cos β|."""


@dataclass(frozen=True, eq=False)
class Effect:
    """One erratum on one robot: the measured errors, and those of the corrected form.

    erratum: its number in docs/deviations.md; robot: on which it was measured
    measure: what was measured, in words; errors are relative and have no unit, ranks are counted in rows
    errors, corrected_errors: relative, or missing rows of A2; one per state, or per mass of A6   (N,)
    cosine: |cos β| at which A3 was measured
    """

    erratum: str
    robot: str
    measure: str
    errors: Array
    corrected_errors: Array
    cosine: float | None = None

    @property
    def median(self) -> float:
        """Median of the printed form's error."""
        return float(np.quantile(self.errors, 0.5))

    @property
    def upper(self) -> float:
        """90 % quantile of the printed form's error."""
        return float(np.quantile(self.errors, 0.9))

    @property
    def largest(self) -> float:
        """Largest error of the printed form."""
        return float(self.errors.max())

    @property
    def corrected(self) -> float:
        """Largest error of the corrected form."""
        return float(self.corrected_errors.max())


def measure(samples: int, seed: int = 0, progress: Callable[[Effect], None] = lambda _: None) -> list[Effect]:
    """Effects of all errata on KR500 and UR5, at random states.

    progress: called with each effect as soon as it is measured
    """
    effects = []
    for model in (kr500(), urdf.load("ur5")):
        for effect in _measure(model, samples, seed):
            effects.append(effect)
            progress(effect)
    return effects


def _measure(model: RobotModel, samples: int, seed: int) -> Iterator[Effect]:
    rng = np.random.default_rng(seed)

    def effect(erratum: str, what: str, printed: Array, corrected: Array, cosine: float | None = None) -> Effect:
        return Effect(erratum, model.name, what, printed, corrected, cosine)

    states = _Sample(_draw(model, rng, samples))
    right = states.error_of(states.twist)
    yield effect("A1", "error of a", states.error_of(without_d_transposed(states.state, states.twist)), right)
    yield effect("A2", "missing rank of φ_q", *_missing_ranks(states))
    for cosine in COSINES:
        near = [_Sample(_near_lock(model, rng, cosine)) for _ in range(max(samples // 10, 1))]
        printed = [one.error_of(cardano_form(one.state, one.twist)) for one in near]
        yield effect(
            "A3",
            f"error of a at |cos β| = {cosine:g}",
            np.concatenate(printed),
            np.concatenate([one.error_of(one.twist) for one in near]),
            cosine,
        )
    yield effect("A4", "error of a", states.error_of(with_unit_d33(states.state, states.twist)), right)
    yield effect("A5", "error of r̈ from joint forces", *_force_sign(states))
    yield effect("A6", "error of identified masses", *_gravity_sign(states))


class _Sample:
    """The correct system at the states of a case, and Pinocchio's answer."""

    def __init__(self, case: Case):
        self.case, model = case, case.model
        self.tau = inverse_dynamics(model, case.q, case.v, case.a).tau if case.tau is None else case.tau
        self.state = maximal_state(model, case.q, case.v)
        self.twist = kkt_batch(model, case.q, case.v, self.tau)
        self.reference = PinocchioAnswers(PinocchioModel.from_model(model), model, case.q, case.v, case.a, self.tau)

    def error_of(self, system: KKTSystem) -> Array:
        """‖δa‖∞ / ‖a‖∞ against aba of the accelerations that a system gives (N,)."""
        acceleration = solve(system.matrix, system.rhs)[..., : 6 * self.case.model.n_bodies]
        if system is not self.twist:  # in (r̈, θ̈)
            acceleration = apply(rate_map(self.state), acceleration) + cardano_drift(self.state)
        bias = bias_acceleration(self.case.model, self.case.q, self.case.v)
        a = project_accelerations(self.state, per_body(acceleration), bias)
        error: Array = np.abs(a - self.reference.a).max(axis=-1) / np.abs(self.reference.a).max(axis=-1)
        return error


def _missing_ranks(sample: _Sample) -> tuple[Array, Array]:
    full = 5 * sample.case.model.n_bodies
    return full - np.linalg.matrix_rank(world_axis_rows(sample.state)), full - np.asarray(
        sample.twist.constraint_rank()
    )


def _force_sign(sample: _Sample) -> tuple[Array, Array]:
    """m r̈ = F^g ± F̂^e (Eq. 22, 24) with the joint forces of rnea: errors of r̈ with minus and with plus."""
    model, reference = sample.case.model, sample.reference
    force = np.einsum("...iab,...ib->...ia", reference.rotation, reference.joint_wrenches[..., LINEAR])
    resultant = -np.einsum("ik,...ka->...ia", model.graph.incidence(), force)  # Eq. (14)
    true = reference.acceleration[..., LINEAR]

    def error(sign: float) -> Array:
        deviation = model.gravity + sign * resultant / _masses(model)[:, None] - true
        relative: Array = np.abs(deviation).max(axis=(-2, -1)) / np.abs(true).max(axis=(-2, -1))
        return relative

    return error(-1.0), error(1.0)


def _gravity_sign(sample: _Sample) -> tuple[Array, Array]:
    """Relative error of every mass from the vertical force balance (z̈ ± g) m = F_3: with z̈ - g and with z̈ + g."""
    model = sample.case.model
    vertical, g, mass = sample.reference.acceleration[..., 2], -model.gravity[2], _masses(model)
    force = mass * (vertical + g)

    def error(rows: Array) -> Array:
        relative: Array = np.abs((rows * force).sum(axis=0) / (rows**2).sum(axis=0) / mass - 1)
        return relative

    return error(vertical - g), error(vertical + g)


def _masses(model: RobotModel) -> Array:
    return np.array([body.mass for body in model.bodies])


def _draw(model: RobotModel, rng: np.random.Generator, size: int) -> Case:
    """Random states and torques, every body clear of gimbal lock."""
    q, v = model.random_state(rng, size)
    while (locked := cos_beta(maximal_state(model, q).rotation).min(axis=-1) < MIN_LOCK_COSINE).any():
        q[locked], v[locked] = model.random_state(rng, int(locked.sum()))
    return _case(model, Placement(), q, v, rng)


def _near_lock(model: RobotModel, rng: np.random.Generator, cosine: float) -> Case:
    """One random state, the world turned so that one random body has this |cos β| and the others are clear of lock."""
    while True:
        q, v = model.random_state(rng, 1)
        body = int(rng.integers(model.n_bodies))
        third = maximal_state(model, q[0]).rotation[body, :, 2]
        tilt = Placement(rotation_about(np.array([0.0, 1.0, 0.0]), np.arcsin(cosine)))
        turn = tilt @ unit_turn(third)
        others = np.delete(cos_beta(maximal_state(turned(model, turn), q[0]).rotation), body)
        if np.all(others > MIN_LOCK_COSINE):
            return _case(turned(model, turn), turn, q, v, rng)


def _case(model: RobotModel, turn: Placement, q: Array, v: Array, rng: np.random.Generator) -> Case:
    a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
    tau = inverse_dynamics(model, q, v, a).tau * rng.uniform(0.5, 1.5, q.shape)
    return Case("errata", model, turn, q, v, a, tau, np.zeros((*q.shape, 6)))
