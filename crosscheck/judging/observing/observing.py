"""The experiments with a function under test: its gravity, inertia and velocity terms as torques."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from crosscheck.judging.observing.function_under_test import FunctionUnderTest
from crosscheck.judging.states import EquationTerms, TrialStates, split, usual_acceleration
from graphdyn import RobotModel
from graphdyn.layout import Array


def observe(tested: FunctionUnderTest, model: RobotModel, trial: TrialStates, torque: Array) -> EquationTerms | None:
    """The experiments with a function under test; None where its answers are no part of the equations of motion.

    torque: usual size per joint (n,), for forward dynamics, which gives M⁻¹ and from it the same terms
    Raises numpy.linalg.LinAlgError where forward dynamics give a singular M⁻¹.
    """
    acceleration = usual_acceleration(model, trial)
    shown = tested.known.shows
    if shown == "accelerations":
        return _of_accelerations(tested, trial, torque, acceleration)
    if shown == "torques per parameter":
        return split(lambda q, v, a: tested(q, v, a) @ model.inertial_parameters, trial, acceleration)
    if shown == "torques":
        return split(tested, trial, acceleration)
    return _PARTS[shown](tested, trial) if shown else None


def _of_accelerations(
    tested: FunctionUnderTest, trial: TrialStates, torque: Array, acceleration: float
) -> EquationTerms:
    response = split(lambda q, v, a: tested(q, v, a * torque), trial, 1.0)  # a (q, v, τ), one torque at a time
    assert response.gravity is not None
    assert response.inertia is not None
    assert response.velocity is not None
    assert response.doubled is not None
    mass = np.linalg.inv(np.swapaxes(response.inertia, -1, -2) / torque)

    def required(acceleration: Array) -> Array:
        needed: Array = -np.einsum("kij,kj->ki", mass, acceleration)
        return needed

    return EquationTerms(
        required(response.gravity),
        np.swapaxes(mass, -1, -2),
        required(response.velocity),
        required(response.doubled),
        acceleration,
    )


def _of_bias(tested: FunctionUnderTest, trial: TrialStates) -> EquationTerms:
    q, v = (np.concatenate(x) for x in ([trial.q] * 3, [0 * trial.v, trial.v, 2 * trial.v]))
    rest, moving, fast = np.split(tested(q, v), 3)
    return EquationTerms(gravity=rest, velocity=moving - rest, doubled=fast - rest)


def _of_coriolis(tested: FunctionUnderTest, trial: TrialStates) -> EquationTerms:
    q, v = np.concatenate([trial.q, trial.q]), np.concatenate([trial.v, 2 * trial.v])
    once, twice = np.split(np.einsum("kij,kj->ki", tested(q, v), v), 2)
    return EquationTerms(velocity=once, doubled=twice)


def _of_quadratic_form(tested: FunctionUnderTest, trial: TrialStates) -> EquationTerms:
    """M_ij = T(e_i + e_j) - T(e_i) - T(e_j)."""
    size, n = trial.q.shape
    unit = np.eye(n)
    pairs = (unit[:, None] + unit[None, :]).reshape(-1, n)
    sums = tested(np.repeat(trial.q, n * n, axis=0), np.tile(pairs, (size, 1))).reshape(size, n, n)
    singles = np.einsum("kii->ki", sums) / 4  # T(2 e_i) = 4 T(e_i)
    return EquationTerms(inertia=sums - singles[:, :, None] - singles[:, None, :])


_PARTS: Mapping[str, Callable[[FunctionUnderTest, TrialStates], EquationTerms]] = {
    "inertia": lambda tested, trial: EquationTerms(inertia=np.swapaxes(tested(trial.q), -1, -2)),
    "inverse of the inertia": lambda tested, trial: EquationTerms(
        inertia=np.swapaxes(np.linalg.inv(tested(trial.q)), -1, -2)
    ),
    "gravity": lambda tested, trial: EquationTerms(gravity=tested(trial.q)),
    "gravity and velocity terms": _of_bias,
    "velocity terms as a matrix": _of_coriolis,
    "inertia as a quadratic form": _of_quadratic_form,
}
"""Observations by what a function shows of the equations of motion (crosscheck.quantities.quantity.Shown)."""
