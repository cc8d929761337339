"""The graph method of the paper as an estimator: one body at a time from the wrenches in all joints.

Eq. (53)-(64) of the paper in the general form of graphdyn.identification.identify_inertial_parameters: all ten
parameters of every body. Friction, and parameters that the wrenches do not determine, come from the torques: weighted
least squares with the other parameters held, nearest to the model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.recordings import Recording
from graphdyn import EstimationFailed, RobotModel, maximal_state
from graphdyn.display import short_repr
from graphdyn.identification import Estimate, Problem, identify_inertial_parameters, joint_noise, model_prior
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import ANGULAR, LINEAR, Array

MAX_WRENCH_ROWS = 2000
"""Largest number of rows used, taken evenly from a longer recording; each gives six equations per body."""

TORQUE_RANK_TOLERANCE = 1e-9
"""Singular value of the torque equations, relative to the largest, above which it counts towards the rank."""


@dataclass(frozen=True, eq=False)
@short_repr
class FromWrenches:
    """The graph method of the paper, from force and moment in every joint.

    recording: the rows of the fit, with joint wrenches; if None, only torques were measured, and estimate fails
    """

    recording: Recording | None = None
    name: str = "graph method"
    reference: str = "Applied Sciences 2021, 11(22), 10988, Eq. (53)-(64)"
    assumptions: str = "noise white and alike in the forces, and in the moments, of all joints; q, v, a without error"
    needs: str = "force and moment in all joints, six components each"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate from wrenches. Raises EstimationFailed without wrenches, and if no body is unknown."""
        if self.recording is None or self.recording.joint_wrenches is None:
            raise EstimationFailed(
                "the recording has torques about the joint axes alone; the method needs all six components of force "
                "and moment in every joint, as a virtual experiment has them (identify without a recording)"
            )
        model = problem.torque_model.model
        columns = problem.torque_model.slice_of(RigidBodies)
        if columns is None:
            raise EstimationFailed("no body is unknown")
        found = identify_inertial_parameters(model, WrenchRows.of(model, self.recording)).values.ravel()
        x = np.full(len(problem.torque_model.columns), np.nan)
        x[columns] = found
        seen = np.isfinite(x)
        noise = joint_noise(problem.equations)
        return Estimate(
            _completed(problem, x, noise),
            noise=noise,
            settings={"determined by wrenches": float(seen.sum())},
            remarks=(
                f"{int(seen.sum())} of {found.size} parameters of the bodies from wrenches, the others and those of "
                "the drives from torques",
            ),
        )


@dataclass(frozen=True, eq=False)
class WrenchRows:
    """Some rows of a recording, as the identification from wrenches needs them: rotations, and vectors in world axes.

    joint_names (n,); q, v, a (N, n); rotation (N, n, 3, 3); joint_forces, joint_moments (N, n, 3) [N, N m]
    acceleration, angular_velocity, angular_acceleration: of the bodies; not used for ten parameters   (N, n, 3)
    """

    joint_names: tuple[str, ...]
    q: Array
    v: Array
    a: Array
    rotation: Array
    acceleration: Array
    angular_velocity: Array
    angular_acceleration: Array
    joint_forces: Array
    joint_moments: Array

    @classmethod
    def of(cls, model: RobotModel, recording: Recording) -> WrenchRows:
        every = slice(None, None, -(-len(recording.t) // MAX_WRENCH_ROWS))
        q, v, a = (recording.channel(name)[every] for name in ("q", "v", "a"))
        wrenches = recording.channel("joint_wrenches")[every]
        rotation = maximal_state(model, q, method="reproducible").rotation
        force, moment = (np.einsum("...ab,...b->...a", rotation, wrenches[..., part]) for part in (LINEAR, ANGULAR))
        unread = np.zeros(force.shape)
        return cls(recording.joint_names, q, v, a, rotation, unread, unread, unread, force, moment)


def _completed(problem: Problem, x: Array, noise: Array) -> Array:
    """x, with the entries that are NaN estimated from the torques."""
    matrix, right = problem.standard_equations(noise)
    prior = model_prior(problem.torque_model)
    held = np.isfinite(x)
    scale = np.where(np.isfinite(prior.scale), prior.scale, 1.0)[~held]
    left = right - matrix[:, held] @ x[held] - matrix[:, ~held] @ prior.mean[~held]
    free = matrix[:, ~held] * scale
    step, *_ = np.linalg.lstsq(free, left, rcond=TORQUE_RANK_TOLERANCE)
    completed = x.copy()
    completed[~held] = prior.mean[~held] + scale * step
    return completed
