"""Delay of the measured torques behind the motion, with a standard deviation that contains what friction feigns.

A scan of the recording below VALLEY_CUTOFF finds the valley of Σ_j log ‖e_j‖ over a common delay and over that of each
torque. There the delays of all torques are fitted together (delay_fit.py), below VALLEY_CUTOFF and then as recorded.
The common delay is their mean, weighted by information. Its variance has three parts: the scatter of time blocks, the
disagreement of the joints, and that of low with all frequencies, as far as they exceed what the first part explains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.data_quality.delays.delay_fit import FittedDelays, fitted_delays
from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.fits.held_out import NOT_ASKED, HeldOutGain, held_out_gain, held_out_squares
from graphdyn.identification.data_quality.fits.thinning import ThinnedRecording
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

VALLEY_CUTOFF, SCAN_STEP = 5.0, 0.02
"""Low-pass before the scan [Hz], and its step [s]: below 10 Hz a valley is wider."""

STUDENT = 1.05
"""Half of the 97.5 % quantile of Student's distribution for DELAY_BLOCKS - 1 degrees of freedom, so that two standard
deviations hold 95 %."""

MIN_DISAGREEMENT = 2.0
"""Standard deviations from which a difference between low and all frequencies is more than chance."""

MIN_CHANCE_SHARE = 0.25
"""Smallest variance of that difference, relative to that of the delay: the two are never the same number."""

MIN_DELAY_DEVIATIONS, MIN_DELAY = 4.0, 0.005
"""Length of a delay that counts, in σ and [s]. Friction that sets in before a joint moves looks like a shorter one."""

MIN_ALONE_GAIN = 0.3
"""Fall of Σ log ‖e_j‖ from which the delay of one torque alone is worth a hint: friction feigns such delays with gains
up to 0.3 in simulation."""

MIN_HINTED_DEVIATIONS = 3.0
"""Length of a delay that is worth a hint [σ]."""


@dataclass(frozen=True, eq=False)
@short_repr
class Lag:
    """Delay of the torques; positive if they were recorded late.

    common: of all torques behind the motion                [s]
    deviation: standard deviation of it                     [s]
    gained: fall of Σ_j log ‖e_j‖ if the delay is removed
    held_out: the same of blocks predicted by the others; asked for delays of MIN_HINTED_DEVIATIONS and MIN_DELAY
    joints: of each torque                                  (n,) [s]
    deviations: standard deviations of them                 (n,) [s]
    joints_gained, joints_held_out: if the delay of one torque alone is removed that differs from the others' by
        MIN_DELAY_DEVIATIONS and MIN_DELAY, and gains MIN_ALONE_GAIN; otherwise 0, and not asked   (n,)
    """

    common: float
    deviation: float
    gained: float
    held_out: HeldOutGain
    joints: Array
    deviations: Array
    joints_gained: Array
    joints_held_out: tuple[HeldOutGain, ...]


def lag(torque_model: TorqueModel, recording: ThinnedRecording, fit: BoundedFit) -> Lag:
    """Delay of the recording. fit: of recording.samples."""
    smooth, below = _smoothed(torque_model, recording, fit)
    low = fitted_delays(torque_model, smooth, below, _valleys(smooth, below))
    start = np.nan_to_num(low.seconds)
    found = low if smooth is recording else fitted_delays(torque_model, recording, fit, start)
    n = len(found.seconds)
    every = np.ones(n, dtype=bool)
    all_joints = _common(found, every)
    common, deviation = _of_both(all_joints, _common(low, every))
    now = recording.torque()
    misfit = _Misfit(now, fit)
    unchanged: list[Array] = []

    def gain_of(torque: Array) -> HeldOutGain:
        if not unchanged:
            unchanged.append(held_out_squares(fit, now))
        return held_out_gain(unchanged[0], held_out_squares(fit, torque))

    deviations, gained, held_out = np.full(n, np.nan), np.zeros(n), [NOT_ASKED] * n
    for j in range(n):
        others, chance = _common(found, np.arange(n) != j), STUDENT * np.sqrt(found.covariance[j, j])
        least = float(np.hypot(np.hypot(chance, others.between), STUDENT * others.deviation))
        deviations[j] = np.hypot(chance, max(others.between, all_joints.between))
        if abs(found.seconds[j] - others.seconds) > max(MIN_DELAY, MIN_DELAY_DEVIATIONS * least):
            own = np.where(np.arange(n) == j, recording.torque_of(j, found.seconds[j])[:, None], now)
            if (gain := misfit(now) - misfit(own)) > MIN_ALONE_GAIN:
                deviations[j], gained[j], held_out[j] = least, gain, gain_of(own)
    shifted = recording.torque(common) if np.isfinite(common) else now
    hinted = abs(common) > max(MIN_DELAY, MIN_HINTED_DEVIATIONS * deviation)
    return Lag(
        common,
        deviation,
        misfit(now) - misfit(shifted),
        gain_of(shifted) if hinted else NOT_ASKED,
        found.seconds,
        deviations,
        gained,
        tuple(held_out),
    )


def _smoothed(
    torque_model: TorqueModel, recording: ThinnedRecording, fit: BoundedFit
) -> tuple[ThinnedRecording, BoundedFit]:
    """The recording below VALLEY_CUTOFF and its fit; as it is, if a user's term or torque refuses that motion."""
    smooth = recording.smoothed(VALLEY_CUTOFF)
    if smooth is recording:
        return recording, fit
    try:
        return smooth, BoundedFit.of(torque_model, smooth.samples, fit.kept)
    except Exception:
        return recording, fit


class _Mean(NamedTuple):
    """Mean delay of some torques, its standard deviation, and that of single torques around it beyond chance [s]."""

    seconds: float
    deviation: float
    between: float


def _common(found: FittedDelays, which: NDArray[np.bool_]) -> _Mean:
    """Mean delay of some torques (n,), weighted by information.

    Their scatter around it, beyond what their covariance explains, is that of errors of the model: the estimate by
    moments of DerSimonian and Laird, "Meta-analysis in clinical trials", Controlled Clinical Trials 7(3), 1986.
    """
    seen = np.flatnonzero(which & np.isfinite(found.seconds))
    both = np.ix_(seen, seen)
    information, covariance, seconds = found.information[both], found.covariance[both], found.seconds[seen]
    if not seen.size or not information.sum() > 0:
        return _Mean(float("nan"), float("nan"), 0.0)
    weights = information.sum(axis=0) / information.sum()
    mean = float(weights @ seconds)
    centered = np.eye(len(seen)) - weights  # from delays to their differences from the mean
    share = np.maximum(weights, 0.0)
    scatter = float(share @ (seconds - mean) ** 2)
    chance = float(share @ np.diag(centered @ covariance @ centered.T))
    unit = float(share @ np.sum(centered**2, axis=1))
    between = max(0.0, scatter - chance) / unit if unit > 0 else 0.0
    variance = float(weights @ covariance @ weights + between * np.sum(weights**2))
    return _Mean(mean, float(np.sqrt(variance)), float(np.sqrt(between)))


def _of_both(whole: _Mean, low: _Mean) -> tuple[float, float]:
    """Delay from all frequencies, and its standard deviation with the disagreement of low ones.

    The difference of an efficient estimate and another has the difference of their variances: Hausman, "Specification
    tests in econometrics", Econometrica 46(6), 1978.
    """
    chance = max(low.deviation**2 - whole.deviation**2, MIN_CHANCE_SHARE * whole.deviation**2)
    excess = max(0.0, (whole.seconds - low.seconds) ** 2 - MIN_DISAGREEMENT**2 * chance)
    return whole.seconds, float(np.hypot(STUDENT * whole.deviation, np.sqrt(excess)))


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
        right = ((torque - self._fit.known) * self._fit.kept / self._noise).ravel()
        left = (right - self._imitated @ (self._imitated.T @ right)).reshape(torque.shape) * self._noise
        return float(np.sum(np.log(np.maximum(np.linalg.norm(left, axis=0) / self._size, MIN_RESIDUAL))))


def _valleys(recording: ThinnedRecording, fit: BoundedFit) -> Array:
    """The delays of single torques with the lowest misfit, the others at their common one (n,) [s]."""
    now = recording.torque()
    misfit, n = _Misfit(now, fit), now.shape[1]
    steps = int(recording.span / SCAN_STEP)
    grid = SCAN_STEP * np.arange(-steps, steps + 1)

    def lowest(of: Callable[[float], float]) -> float:
        return float(grid[int(np.argmin([of(float(x)) for x in grid]))])

    common = lowest(lambda later: misfit(recording.torque(later)))
    shifted = recording.torque(common)

    def alone(j: int, later: float) -> float:
        return misfit(np.where(np.arange(n) == j, recording.torque_of(j, later)[:, None], shifted))

    return np.array([lowest(partial(alone, j)) for j in range(n)])
