"""The experiments with a foreign function: its gravity, inertia and velocity terms as torques."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from crosscheck.judging.observing.function_under_test import ForeignFunction
from crosscheck.judging.states.experiments import Parts, TrialStates, split, usual_acceleration
from graphdyn import RobotModel
from graphdyn.layout import Array


def observe(foreign: ForeignFunction, model: RobotModel, trial: TrialStates, torque: Array) -> Parts | None:
    """The experiments with a foreign function; None where its answers are no part of the equations of motion.

    torque: usual size per joint (n,), for forward dynamics, which gives M⁻¹ and from it the same terms
    Raises numpy.linalg.LinAlgError where forward dynamics give a singular M⁻¹.
    """
    acceleration = usual_acceleration(model, trial)
    if foreign.name == "forward_dynamics":
        return _of_accelerations(foreign, trial, torque, acceleration)
    if foreign.name == "joint_torque_regressor":
        return split(lambda q, v, a: foreign(q, v, a) @ model.inertial_parameters, trial, acceleration)
    if foreign.name == "inverse_dynamics":
        return split(foreign, trial, acceleration)
    known = _PARTS.get(foreign.name)
    return None if known is None else known(foreign, trial)


def _of_accelerations(foreign: ForeignFunction, trial: TrialStates, torque: Array, acceleration: float) -> Parts:
    response = split(lambda q, v, a: foreign(q, v, a * torque), trial, 1.0)  # a (q, v, τ), one torque at a time
    assert response.gravity is not None
    assert response.inertia is not None
    assert response.velocity is not None
    assert response.doubled is not None
    mass = np.linalg.inv(np.swapaxes(response.inertia, -1, -2) / torque)

    def required(acceleration: Array) -> Array:
        needed: Array = -np.einsum("kij,kj->ki", mass, acceleration)
        return needed

    return Parts(
        required(response.gravity),
        np.swapaxes(mass, -1, -2),
        required(response.velocity),
        required(response.doubled),
        acceleration,
    )


def _of_bias(foreign: ForeignFunction, trial: TrialStates) -> Parts:
    q, v = (np.concatenate(x) for x in ([trial.q] * 3, [0 * trial.v, trial.v, 2 * trial.v]))
    rest, moving, fast = np.split(foreign(q, v), 3)
    return Parts(gravity=rest, velocity=moving - rest, doubled=fast - rest)


def _of_coriolis(foreign: ForeignFunction, trial: TrialStates) -> Parts:
    q, v = np.concatenate([trial.q, trial.q]), np.concatenate([trial.v, 2 * trial.v])
    once, twice = np.split(np.einsum("kij,kj->ki", foreign(q, v), v), 2)
    return Parts(velocity=once, doubled=twice)


def _of_kinetic_energy(foreign: ForeignFunction, trial: TrialStates) -> Parts:
    """M_ij = T(e_i + e_j) - T(e_i) - T(e_j)."""
    size, n = trial.q.shape
    unit = np.eye(n)
    pairs = (unit[:, None] + unit[None, :]).reshape(-1, n)
    sums = foreign(np.repeat(trial.q, n * n, axis=0), np.tile(pairs, (size, 1))).reshape(size, n, n)
    singles = np.einsum("kii->ki", sums) / 4  # T(2 e_i) = 4 T(e_i)
    return Parts(inertia=sums - singles[:, :, None] - singles[:, None, :])


_PARTS: Mapping[str, Callable[[ForeignFunction, TrialStates], Parts]] = {
    "mass_matrix": lambda foreign, trial: Parts(inertia=np.swapaxes(foreign(trial.q), -1, -2)),
    "mass_matrix_inverse": lambda foreign, trial: Parts(inertia=np.swapaxes(np.linalg.inv(foreign(trial.q)), -1, -2)),
    "gravity_torque": lambda foreign, trial: Parts(gravity=foreign(trial.q)),
    "bias_torque": _of_bias,
    "coriolis_matrix": _of_coriolis,
    "kinetic_energy": _of_kinetic_energy,
}
