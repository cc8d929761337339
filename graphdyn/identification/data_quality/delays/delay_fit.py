"""Fit of the delays of all torques together, free of the shape of friction, and their covariance.

The torques are shifted by δ_j, and τ_j(t + δ_j) = W(t) x + (friction of any shape) is fitted by Gauss-Newton steps. An
error of the model that is even in time, such as one of masses, does not shift the minimum to first order; one that is
odd, such as one of friction, looks like a delay. Therefore each joint has columns for friction of any shape beside
those of the torque model, and rows near standstill do not count.

The covariance is that of the scores of time blocks, with the residuals that each block would have if it were left out
of the fit: CR3 of Bell and McCaffrey, "Bias reduction in standard errors for linear regression with multi-stage
samples", Survey Methodology 28(2), 2002. It allows for any correlation within a block.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import orthonormal_basis, triangle
from graphdyn.identification.data_quality.channels.measured_torque import drive_columns
from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.fits.thinning import ThinnedRecording
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

DELAY_BLOCKS = 20
"""Number of time blocks, between which residuals count as independent."""

MIN_SPEED_SHARE = 0.1
"""Part of a joint's largest speed below which its rows do not count: presliding and filters that smooth a reversal look
like delays."""

FALLING_SPEED_SHARE = 0.1
"""Part of a joint's largest speed over which friction may fall, as Stribeck's."""

MIN_ROWS_PER_COLUMN = 3
"""Numbers in the rows for each column; with fewer, there are no columns for friction of any shape."""

GAUSS_NEWTON_STEPS, MAX_STEP = 5, 0.02
"""Number of steps, and the longest one [s]: half a valley of motion below 10 Hz."""

MAX_LEVERAGE = 0.99
"""Largest part of a block's residual that the fit to it may take away; more, where it alone determines a parameter."""


@dataclass(frozen=True, eq=False)
class FittedDelays:
    """Delays of n torques, positive if they were recorded late.

    seconds: (n,) [s]; NaN for a torque whose rows tell nothing
    covariance: of them (n, n) [s²]
    information: inverse covariance for white noise, as weights (n, n)
    """

    seconds: Array
    covariance: Array
    information: Array


def friction_of_any_shape(torque_model: TorqueModel, recording: ThinnedRecording, fit: BoundedFit) -> Array:
    """Columns per joint for friction that is a smooth function of speed and load, and for a rotor (N, n, c)."""
    samples = recording.samples
    x = fit.parameters(samples.tau)
    drives = drive_columns(torque_model)
    bodies = np.setdiff1d(np.arange(len(x)), drives)
    load = np.abs(fit.matrix[..., bodies] @ x[bodies])
    fastest = np.abs(samples.v).max(axis=0)
    u, sign = np.abs(samples.v) / np.where(fastest > 0, fastest, 1.0), np.sign(samples.v)
    falling = np.exp(-u / FALLING_SPEED_SHARE)
    shapes = [sign, sign * u, sign * u**2, sign * falling, sign * load, np.ones_like(u), u, falling, samples.a]
    n = u.shape[1]
    return np.concatenate([shape[..., None] * np.eye(n) for shape in shapes], axis=-1)


def fitted_delays(
    torque_model: TorqueModel, recording: ThinnedRecording, fit: BoundedFit, start: Array
) -> FittedDelays:
    """The delays next to a start (n,). fit: of recording.samples"""
    v = np.abs(recording.samples.v)
    kept = fit.kept & (v >= MIN_SPEED_SHARE * v.max(axis=0)) & (v > 0)
    matrix = fit.matrix
    further = friction_of_any_shape(torque_model, recording, fit)
    if kept.sum() >= MIN_ROWS_PER_COLUMN * (matrix.shape[-1] + further.shape[-1]):
        matrix = np.concatenate([matrix, further], axis=-1)
    matrix = _independent(matrix * kept[..., None])
    counted = np.maximum(kept.sum(axis=0), 1)
    size = np.sqrt(np.sum((recording.torque() * kept) ** 2, axis=0) / counted)
    noise = np.where(size > 0, size, 1.0)
    smallest, seconds = MIN_RESIDUAL * noise, np.array(start, dtype=float)
    for step in range(GAUSS_NEWTON_STEPS):
        if step in (0, 1, GAUSS_NEWTON_STEPS - 1):  # weights by the torque, by the first residual, and by the last
            equations = _Equations(recording, fit.known, kept, matrix, noise)
        error, shift = equations.at(seconds)
        curvature = shift.T @ shift
        change = -np.linalg.lstsq(curvature, shift.T @ error, rcond=RANK_TOLERANCE)[0]
        error = error + shift @ change
        size = np.sqrt(np.sum(error.reshape(kept.shape) ** 2, axis=0) / counted)
        noise = np.maximum(equations.noise * size, smallest)
        if step < GAUSS_NEWTON_STEPS - 1:
            seconds = np.clip(seconds + np.clip(change, -MAX_STEP, MAX_STEP), -recording.span, recording.span)
    seen = np.diag(curvature) > RANK_TOLERANCE * np.diag(curvature).max(initial=0.0)
    return FittedDelays(
        np.where(seen, seconds + change, np.nan), _covariance(equations.basis, error, shift, len(kept)), curvature
    )


def _independent(matrix: Array) -> Array:
    """Independent combinations of the columns (N, n, c); weights of rows leave them independent."""
    flat = matrix.reshape(-1, matrix.shape[-1])
    length = np.linalg.norm(flat, axis=0)
    unit = flat[:, length > RANK_TOLERANCE * length.max(initial=0.0)]
    unit = unit / np.linalg.norm(unit, axis=0)
    _, s, vt = np.linalg.svd(triangle(unit), full_matrices=False)
    combinations = vt[s > RANK_TOLERANCE * s.max(initial=0.0)].T
    return np.asarray(unit @ combinations).reshape(*matrix.shape[:2], -1)


class _Equations:
    """Residual and its change per second of delay, free of what the columns explain, in units of the noise."""

    def __init__(self, recording: ThinnedRecording, known: Array, kept: Array, matrix: Array, noise: Array):
        self._recording, self._known, self._weight, self.noise = recording, known, kept / noise, noise
        self.basis = np.linalg.qr((matrix * self._weight[..., None]).reshape(kept.size, -1))[0]

    def at(self, seconds: Array) -> tuple[Array, Array]:
        """Residual (N n,) and its change per second of each delay (N n, n)."""
        error = (self._recording.torque(seconds) - self._known) * self._weight
        rate = self._recording.torque_rate(seconds) * self._weight
        shift = (rate[..., None] * np.eye(len(seconds))).reshape(rate.size, -1)
        flat = error.ravel()
        return flat - self.basis @ (self.basis.T @ flat), shift - self.basis @ (self.basis.T @ shift)


def _covariance(basis: Array, error: Array, shift: Array, rows: int) -> Array:
    """Covariance of the delays (n, n) by CR3. error, shift: of rows × joints."""
    inverse = np.linalg.pinv(shift.T @ shift, rcond=RANK_TOLERANCE, hermitian=True)
    whole = np.concatenate([basis, orthonormal_basis(shift, RANK_TOLERANCE)], axis=1)
    joints = len(error) // rows
    scores = []
    for block in np.array_split(np.arange(len(error)).reshape(rows, joints), DELAY_BLOCKS):
        own = block.ravel()
        q = whole[own]
        values, vectors = np.linalg.eigh(q @ q.T if len(own) < q.shape[1] else q.T @ q)
        left = 1 / (1 - np.minimum(values, MAX_LEVERAGE))
        if len(own) < q.shape[1]:
            outside = vectors @ (left * (vectors.T @ error[own]))
        else:
            inside = vectors @ ((left - 1) / np.where(values > 0, values, 1.0) * (vectors.T @ (q.T @ error[own])))
            outside = error[own] + q @ inside
        scores.append(shift[own].T @ outside)
    spread = np.array(scores)
    return np.asarray((DELAY_BLOCKS - 1) / DELAY_BLOCKS * inverse @ spread.T @ spread @ inverse)
