"""Gain and delay of the measured torque: its factor to that of the model as given, and its lag behind the motion.

For the delay the torque is shifted by δ, τ(t + δ) = W(t) x is fitted, and δ minimizes Σ_j log ‖e_j‖. A scan finds the
valley, a search its bottom. The standard deviation is that of one Gauss-Newton step there, with residuals that may be
correlated within each of LAG_BLOCKS time blocks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.thinning import ThinnedRecording
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms.term import CarriesBodies
from graphdyn.layout import Array

JACKKNIFE_BLOCKS = 20
"""Number of time blocks, each of which is left out once for the standard deviation (jackknife)."""


NEGLIGIBLE_TORQUE_SHARE = 1e-6
"""Predicted torque, relative to the measured one, below which it is rounding."""


@dataclass(frozen=True, eq=False)
class Gains:
    """Gains per joint of τ = gain · τ_model + drives, with the drives fitted along (n,).

    gain: of measured on predicted torque, 1 for SI units at the joints and a right model; NaN if the model predicts no
        torque
    deviation: standard deviation of the gain; NaN likewise
    share: ‖gain · τ_model‖ / ‖τ‖; if it is small, the drives dominate the torque, and the gain means little
    without_gain: ‖e_j‖ / ‖τ_j‖ of the model with drives, gain 1
    """

    gain: Array
    deviation: Array
    share: Array
    without_gain: Array


def gains(torque_model: TorqueModel, samples: Samples, fit: BoundedFit) -> Gains:
    """Gains of these samples. fit: of the same samples."""
    prior = torque_model.prior()
    model = fit.matrix @ prior + fit.known
    drives = _drive_columns(torque_model)
    n = samples.tau.shape[1]
    gain, deviation, share, without = (np.full(n, np.nan) for _ in range(4))
    for j in range(n):
        kept = fit.kept[:, j]
        own = np.column_stack([fit.matrix[kept, j][:, drives], samples.a[kept, j]])
        own = own[:, np.any(own != 0, axis=0)]
        tau, predicted = samples.tau[kept, j], model[kept, j]
        size = np.linalg.norm(tau)
        if size == 0 or np.linalg.norm(predicted) <= NEGLIGIBLE_TORQUE_SHARE * size:
            continue
        without[j] = _misfit(own, tau - predicted) / size
        columns = np.column_stack([predicted, own])
        gain[j], deviation[j] = _first_with_deviation(columns, tau)
        share[j] = abs(gain[j]) * np.linalg.norm(predicted) / size
    return Gains(gain, deviation, share, without)


def _drive_columns(torque_model: TorqueModel) -> NDArray[np.intp]:
    """Columns that belong to no body."""
    of_drives = np.zeros(len(torque_model.columns), dtype=bool)
    for term, columns in torque_model.parts:
        of_drives[columns] = not isinstance(term, CarriesBodies)
    return np.flatnonzero(of_drives)


def _first_with_deviation(columns: Array, right: Array) -> tuple[float, float]:
    """The first coefficient of the fit, and its standard deviation by leaving out one block after the other."""
    length = np.linalg.norm(columns, axis=0)
    unit = columns / length
    edges = np.linspace(0, len(right), JACKKNIFE_BLOCKS + 1).astype(int)
    blocks = [slice(a, b) for a, b in pairwise(edges)]
    grams = np.array([unit[rows].T @ unit[rows] for rows in blocks])
    sides = np.array([unit[rows].T @ right[rows] for rows in blocks])
    whole = np.linalg.lstsq(grams.sum(axis=0), sides.sum(axis=0), rcond=RANK_TOLERANCE)[0][0]
    parts = [
        np.linalg.lstsq(grams.sum(axis=0) - gram, sides.sum(axis=0) - side, rcond=RANK_TOLERANCE)[0][0]
        for gram, side in zip(grams, sides, strict=True)
    ]
    variance = (JACKKNIFE_BLOCKS - 1) / JACKKNIFE_BLOCKS * np.sum((np.array(parts) - np.mean(parts)) ** 2)
    return float(whole / length[0]), float(np.sqrt(variance) / length[0])


def _misfit(columns: Array, right: Array) -> float:
    """Part of ‖right‖ that the columns do not explain."""
    length = np.linalg.norm(columns, axis=0)
    coefficients = np.linalg.lstsq(columns / length, right, rcond=RANK_TOLERANCE)[0]
    return float(np.linalg.norm(right - columns / length @ coefficients))


SCAN_STEP = 0.02
"""Step of the scan [s]: for motion below 10 Hz, a valley is wider."""

LAG_TOLERANCE = 1e-5
"""Precision of the search for the bottom of the valley [s]."""

LAG_BLOCKS = 20


@dataclass(frozen=True, eq=False)
class Lag:
    """Delay of the torques; positive if they were recorded late.

    common: of all torques behind the motion                [s]
    deviation: standard deviation of it                     [s]
    gained: fall of Σ_j log ‖e_j‖ if the delay is removed
    joints: of each torque, the others as `common`          (n,) [s]
    deviations: standard deviations of them                 (n,) [s]
    joints_gained: further fall of the sum                  (n,)
    """

    common: float
    deviation: float
    gained: float
    joints: Array
    deviations: Array
    joints_gained: Array


class _Misfit:
    """Σ_j log(‖e_j‖ / ‖τ_j‖) of least squares, as a function of the torques (N, n)."""

    def __init__(self, tau: Array, fit: BoundedFit):
        self._fit = fit
        self._size = np.linalg.norm(tau * fit.kept, axis=0)
        self._size[self._size == 0] = 1.0
        self._noise = fit.errors(tau, bounded=False) * self._size
        matrix = (fit.matrix * fit.kept[..., None] / self._noise[:, None]).reshape(tau.size, -1)
        length = np.linalg.norm(matrix, axis=0)
        seen = length > RANK_TOLERANCE * length.max(initial=0.0)
        self._imitated = orthonormal_basis(matrix[:, seen], RANK_TOLERANCE)

    def __call__(self, torque: Array) -> float:
        left = self.left(torque - self._fit.known) * self._noise
        return float(np.sum(np.log(np.maximum(np.linalg.norm(left, axis=0) / self._size, MIN_RESIDUAL))))

    def left(self, torque: Array) -> Array:
        """Residual that no parameters can reduce, in units of the noise; rows that do not count are zero (N, n)."""
        right = (torque * self._fit.kept / self._noise).ravel()
        return np.asarray(right - self._imitated @ (self._imitated.T @ right)).reshape(torque.shape)


def lag(recording: ThinnedRecording, fit: BoundedFit) -> Lag:
    """Delay of the recording. fit: of recording.samples."""
    now = recording.torque()
    misfit, n = _Misfit(now, fit), now.shape[1]
    common, lowest = _lowest(lambda later: misfit(recording.torque(later)), recording.span)
    shifted = recording.torque(common)

    def alone(j: int, later: float) -> float:
        own = recording.torque_of(j, later)
        return misfit(np.where(np.arange(n) == j, own[:, None], shifted))

    found = [_lowest(partial(alone, j), recording.span) for j in range(n)]
    error = misfit.left(shifted - fit.known)
    shift = misfit.left(recording.torque_rate())
    return Lag(
        common,
        _deviation(error, shift),
        misfit(now) - lowest,
        np.array([seconds for seconds, _ in found]),
        np.array([_deviation(error[:, [j]], shift[:, [j]]) for j in range(n)]),
        np.array([lowest - value for _, value in found]),
    )


def _lowest(misfit: Callable[[float], float], span: float) -> tuple[float, float]:
    """Position of the minimum, and its value."""
    from scipy.optimize import minimize_scalar

    steps = int(span / SCAN_STEP)
    grid = SCAN_STEP * np.arange(-steps, steps + 1)
    start = float(grid[int(np.argmin([misfit(float(x)) for x in grid]))])
    bounds = (max(-span, start - SCAN_STEP), min(span, start + SCAN_STEP))
    found = minimize_scalar(misfit, bounds=bounds, options={"xatol": LAG_TOLERANCE})
    return float(found.x), float(found.fun)


def _deviation(error: Array, shift: Array) -> float:
    """Standard deviation of a time [s]; error and its change per second of shift, in units of the noise (N, k)."""
    edges = np.linspace(0, len(error), LAG_BLOCKS + 1).astype(int)
    steps = [np.sum(error[a:b] * shift[a:b]) for a, b in pairwise(edges)]
    curvature = float(np.sum(shift**2))
    return float(np.linalg.norm(steps)) / curvature if curvature > 0 else float("nan")
