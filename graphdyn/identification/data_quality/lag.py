"""Delay of the measured torque against the motion, estimated between the samples.

The torque is shifted by δ, τ(t + δ) = W(t) x is fitted, and δ minimizes Σ_j log ‖e_j‖. A scan finds the
valley, a search its bottom. The standard deviation is that of one Gauss-Newton step there, with residuals that may be
correlated within each of LAG_BLOCKS time blocks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.data_quality.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.thinning import ThinnedRecording
from graphdyn.layout import Array

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
    """Σ_j log(‖e_j‖ / ‖τ_j‖) of least squares, of a recording with shifted torques."""

    def __init__(self, recording: ThinnedRecording, fit: BoundedFit):
        self._recording, self._fit = recording, fit
        tau = recording.torque()
        self._size = np.linalg.norm(tau * fit.kept, axis=0)
        self._size[self._size == 0] = 1.0
        self._noise = fit.errors(tau, bounded=False) * self._size
        matrix = (fit.matrix * fit.kept[..., None] / self._noise[:, None]).reshape(tau.size, -1)
        length = np.linalg.norm(matrix, axis=0)
        matrix = matrix[:, length > RANK_TOLERANCE * length.max(initial=0.0)]
        u, s, _ = np.linalg.svd(matrix / np.linalg.norm(matrix, axis=0), full_matrices=False)
        self._imitated = u[:, s > RANK_TOLERANCE * s.max(initial=0.0)]

    def __call__(self, later: float | Array) -> float:
        left = self.left(self._recording.torque(later) - self._fit.known) * self._noise
        return float(np.sum(np.log(np.maximum(np.linalg.norm(left, axis=0) / self._size, MIN_RESIDUAL))))

    def left(self, torque: Array) -> Array:
        """Residual that no parameters can reduce, in units of the noise; rows that do not count are zero (N, n)."""
        right = (torque * self._fit.kept / self._noise).ravel()
        return np.asarray(right - self._imitated @ (self._imitated.T @ right)).reshape(torque.shape)


def lag(recording: ThinnedRecording, fit: BoundedFit) -> Lag:
    """Delay of the recording. fit: of recording.samples."""
    misfit = _Misfit(recording, fit)
    common, lowest = _lowest(misfit, recording.span)
    n = recording.samples.q.shape[1]
    found = [_lowest(partial(_alone, misfit, common, n, j), recording.span) for j in range(n)]
    error = misfit.left(recording.torque(common) - fit.known)
    shift = misfit.left(recording.torque_rate())
    return Lag(
        common,
        _deviation(error, shift),
        misfit(0.0) - lowest,
        np.array([seconds for seconds, _ in found]),
        np.array([_deviation(error[:, [j]], shift[:, [j]]) for j in range(n)]),
        np.array([lowest - value for _, value in found]),
    )


def _alone(misfit: Callable[[Array], float], common: float, n: int, j: int, own: float) -> float:
    lags = np.full(n, common)
    lags[j] = own
    return misfit(lags)


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
