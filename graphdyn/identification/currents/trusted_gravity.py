"""Gravity of links that are known, for instance from CAD: what gives gains without a load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.layout import BODY_PARAMETERS, Array

RANDOM_POSES, POSE_SEED = 200, 0
"""Number of random poses whose gravity torques show which base parameters gravity depends on, and their seed."""

SMALLEST_VARIANCE = 1e-8
"""Smallest variance of a base parameter relative to the largest: a link without mass is not known exactly."""

ZERO_TORQUE = 1e-9
"""Gravity torque of a column, relative to the largest, below which it is rounding."""


@dataclass(frozen=True)
class TrustedGravity:
    """Masses and centers of mass of the model, trusted up to a relative error of each link.

    error: standard deviation of every mass relative to it, and of every center of mass relative to its distance from
        the origin of the link; independent between links. Tensors are not trusted

    Raises InvalidInput for an error that is not above zero.
    """

    error: float

    def __post_init__(self) -> None:
        if not 0 < self.error < np.inf:
            raise InvalidInput(f"the error of trusted links is {self.error:g}; give one above zero, such as 0.05")

    def equations(self, torque_model: TorqueModel) -> tuple[Array, Array]:
        """Rows A (k, b) and right side b (k,) of A β = b for the base parameters, in units of the deviations.

        Raises InvalidInput for a robot on which gravity has no effect.
        """
        base = structure(torque_model).base
        model = torque_model.model
        q, v = model.random_state(np.random.default_rng(POSE_SEED), RANDOM_POSES)
        still = np.zeros_like(v)
        w = np.abs(torque_model.rows(Samples(q, still, still, still), base.independent)).max(axis=(0, 1))
        links = base.independent < BODY_PARAMETERS * model.n_bodies
        falling = np.flatnonzero(links & (w > ZERO_TORQUE * w[links].max(initial=0.0)))
        chosen = base.matrix[falling]
        covariance = chosen @ self._covariance(torque_model) @ chosen.T
        variances, axes = np.linalg.eigh(covariance)
        if not falling.size or not variances[-1] > 0:
            raise InvalidInput(
                f"gravity moves no joint of robot '{model.name}', or its links have no mass: trusted links give no gain"
            )
        whiten = axes.T / np.sqrt(np.maximum(variances, SMALLEST_VARIANCE * variances[-1]))[:, None]
        rows = np.zeros((len(falling), base.rank))
        rows[:, falling] = whiten
        return rows, whiten @ base.values(torque_model.prior())[falling]

    def _covariance(self, torque_model: TorqueModel) -> Array:
        """Covariance of all parameters (p, p) from the errors of masses and centers."""
        p = len(torque_model.columns)
        steps = []
        for i, body in enumerate(torque_model.model.bodies):
            c = body.center_of_mass
            size = self.error * body.mass
            for part in ([1.0, *c], *(np.eye(4)[1:] * np.linalg.norm(c) / np.sqrt(3))):
                step = np.zeros(p)
                step[BODY_PARAMETERS * i : BODY_PARAMETERS * i + 4] = size * np.asarray(part)
                steps.append(step)
        s = np.array(steps)
        covariance: Array = s.T @ s
        return covariance
