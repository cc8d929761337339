"""What may have changed during a recording, as columns that the torque model lacks.

Friction or torque constant that drifts, a load that is attached or taken off, a torque that jumps, friction that was
subtracted before the torque was recorded, a low-pass in front of it. If the equations with these columns fit much
better, the recording has the fault. No change of the columns corrects it: use a part of the recording, or another
torque model.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    LoadFriction,
    RigidBodies,
    SmoothCoulomb,
    Stribeck,
    Viscous,
)
from graphdyn.layout import BODY_PARAMETERS, Array

AdditionKind = Literal[
    "torque drift",
    "gain jump",
    "friction drift",
    "attached load",
    "detached load",
    "torque jump",
    "friction subtracted",
    "filtered torque",
]

DISSIPATING_TERMS = (
    Viscous,
    AsymmetricViscous,
    Coulomb,
    AsymmetricCoulomb,
    SmoothCoulomb,
    Stribeck,
    LoadFriction,
)
"""Terms of friction."""

LOAD_PARAMETERS = 4
"""Number of parameters of a load that is attached: mass and m c. Its tensor shows too little."""

MIN_FACTOR = 1e-3
"""Smallest factor of a torque that drifts: below it nothing is left of it."""

RIGHT_AT = (0.0, 0.5, 1.0)
"""Instants at which a gain that drifts is right, as a share of the recording: links tie the scales of the joints to
each other, so that a mean of one is another fault than a growth from one."""

INSTANTS = tuple(np.linspace(0.1, 0.9, 17).tolist())
"""Instants at which something may have changed, as a share of the recording."""


@dataclass(frozen=True, eq=False)
@short_repr
class Addition:
    """Columns that a torque model lacks.

    joints: those that it concerns                          (k,)
    columns: of each joint's torque                         (N, n, c)
    body: whether the columns are mass and first moments of a body, whose mass is bounded; they are free otherwise
    instant: at which something changed, as a share of the recording; NaN if nothing did at once
    growth: of the gain of the torques, in units of the first parameter (N,); None if their gain does not change
    """

    kind: AdditionKind
    joints: tuple[int, ...]
    columns: Array
    body: bool = False
    instant: float = float("nan")
    growth: Array | None = None

    def spread(self, x: Array) -> float:
        """Mean logarithm of the factors by which a drift of the torques multiplies them, summed over the joints.

        The criterion of the drifting torques is that of the recorded ones plus this sum. x: parameters of the columns
        """
        if self.growth is None:
            return 0.0
        factors = 1 + x[0] * self.growth
        return len(self.joints) * float(np.mean(np.log(np.maximum(np.abs(factors), MIN_FACTOR))))


def additions(
    torque_model: TorqueModel, fit: BoundedFit, tau: Array, torque_rate: Array | None = None
) -> Iterator[Addition]:
    """All additions to try. fit: of all samples; tau, torque_rate: measured torque and its rate (N, n)."""
    rows, n = tau.shape
    progress = np.linspace(-0.5, 0.5, rows)
    every, dissipating = tuple(range(n)), columns_of(torque_model, DISSIPATING_TERMS)
    x = fit.parameters(tau)
    friction = fit.matrix[..., dissipating] @ x[dissipating]
    for right_at in RIGHT_AT:
        yield _of_gain("torque drift", every, progress + 0.5 - right_at, tau)
    if dissipating.size:
        yield Addition("friction subtracted", every, fit.matrix[..., dissipating])
    for j in range(n):
        for right_at in RIGHT_AT:
            yield _of_gain("torque drift", (j,), progress + 0.5 - right_at, tau)
        own = fit.matrix[:, j, dissipating]
        if np.any(own):
            yield Addition("friction subtracted", (j,), _of_joint(own[:, np.any(own != 0, axis=0)], j, n))
    if np.any(friction):
        yield Addition("friction drift", every, (friction * progress[:, None])[..., None])
        for j in range(n):
            yield Addition("friction drift", (j,), _of_joint(friction[:, j] * progress, j, n))
    if torque_rate is not None:  # τ + T dτ/dt is what a low-pass of the time constant T filtered
        yield Addition("filtered torque", every, -torque_rate[..., None])
        for j in range(n):
            yield Addition("filtered torque", (j,), _of_joint(-torque_rate[:, j], j, n))
    if (bodies := torque_model.slice_of(RigidBodies)) is not None:
        first = bodies.stop - BODY_PARAMETERS
        last = fit.matrix[..., first : first + LOAD_PARAMETERS]
        for share in INSTANTS:
            after = (progress > share - 0.5)[:, None, None]
            yield Addition("attached load", every, last * after, body=True, instant=share)
            yield Addition("detached load", every, last * ~after, body=True, instant=share)
    for share in INSTANTS:
        step = (progress > share - 0.5).astype(float)
        for j in range(n):
            yield Addition("torque jump", (j,), _of_joint(step, j, n), instant=share)
            yield _of_gain("gain jump", (j,), step, tau, share)
            yield _of_gain("gain jump", (j,), step - 1, tau, share)


def _of_gain(
    kind: AdditionKind, joints: tuple[int, ...], growth: Array, tau: Array, instant: float = float("nan")
) -> Addition:
    """A gain that changes: τ (1 + x growth) is what the equations explain. growth: (N,); tau: measured (N, n)"""
    columns = np.zeros(tau.shape)
    columns[:, list(joints)] = -tau[:, list(joints)] * growth[:, None]
    return Addition(kind, joints, columns[..., None], instant=instant, growth=growth)


def columns_of(torque_model: TorqueModel, kinds: tuple[type, ...]) -> NDArray[np.intp]:
    """The columns of terms of these classes (c,)."""
    parts = [np.arange(part.start, part.stop) for term, part in torque_model.parts if isinstance(term, kinds)]
    return np.concatenate(parts) if parts else np.zeros(0, dtype=np.intp)


def _of_joint(columns: Array, j: int, n: int) -> Array:
    """Columns (N,) or (N, c) of the torque of one joint (N, n, c)."""
    columns = columns.reshape(len(columns), -1)
    found = np.zeros((len(columns), n, columns.shape[1]))
    found[:, j] = columns
    return found
