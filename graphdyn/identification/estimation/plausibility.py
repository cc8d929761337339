"""Physical consistency of identified parameters: of single bodies, and of the mass matrix over many poses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import pseudo_inertia_from_parameters

CHECKED_POSES = 10_000
POSES_PER_CHUNK = 256


@dataclass(frozen=True, eq=False)
class Plausibility:
    """Whether identified parameters are physically consistent.

    pseudo_inertia_eigenvalues: the smallest of every body, ≥ 0 for a consistent one (n,)
    mass_matrix_eigenvalues: the smallest in every pose, > 0 for a real robot (poses,) [kg m² or kg]
    """

    pseudo_inertia_eigenvalues: Array
    mass_matrix_eigenvalues: Array

    @property
    def consistent(self) -> bool:
        """Whether every body is physically consistent."""
        return bool(np.all(self.pseudo_inertia_eigenvalues >= 0))

    @property
    def positive_definite(self) -> int:
        """Number of poses with a positive definite mass matrix."""
        return int(np.count_nonzero(self.mass_matrix_eigenvalues > 0))

    @property
    def poses(self) -> int:
        """Number of poses that were tried."""
        return len(self.mass_matrix_eigenvalues)

    @property
    def smallest_mass_matrix_eigenvalue(self) -> float:
        """Smallest eigenvalue over all poses [kg m² or kg]."""
        return float(self.mass_matrix_eigenvalues.min())


def plausibility(
    torque_model: TorqueModel, parameters: Array, *, poses: int = CHECKED_POSES, seed: int = 0
) -> list[Plausibility]:
    """Plausibility of every row of parameters (m, p); poses are drawn from the limits of the robot."""
    x = np.asarray(parameters, dtype=float)
    torque_model = replace(torque_model, model=torque_model.model.opened)  # loops leave its motions inertia, too
    q, _ = torque_model.model.random_state(np.random.default_rng(seed), poses)
    parts = [mass_matrices(torque_model, q[k : k + POSES_PER_CHUNK], x) for k in range(0, poses, POSES_PER_CHUNK)]
    smallest = np.concatenate([np.linalg.eigvalsh(part)[..., 0] for part in parts])
    bodies = np.array([torque_model.inertial_parameters(row).reshape(-1, BODY_PARAMETERS) for row in x])
    real = np.linalg.eigvalsh(pseudo_inertia_from_parameters(bodies))[..., 0]
    return [Plausibility(real[k], smallest[:, k]) for k in range(len(x))]


def mass_matrices(torque_model: TorqueModel, q: Array, parameters: Array) -> Array:
    """M (N, m, n, n) at q (N, n) for parameters (m, p): derivative of the torque of all terms by a, rotors included."""
    n = q.shape[1]
    rest = np.zeros_like(q)
    still = Samples(q, rest, rest, rest, time=rest[:, 0], temperature=rest)  # drifts do not change with a
    rows, known = torque_model.rows(still), torque_model.known_torque(still)
    columns = []
    for j in range(n):
        a = np.zeros_like(q)
        a[:, j] = 1.0
        moved = replace(still, a=a)
        change = (torque_model.rows(moved) - rows) @ parameters.T
        columns.append(change + (torque_model.known_torque(moved) - known)[..., None])
    m = np.moveaxis(np.stack(columns, axis=-2), -1, 1)
    return (m + np.swapaxes(m, -1, -2)) / 2
