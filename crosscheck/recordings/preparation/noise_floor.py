"""Cutoff from the data by residual analysis: section 3.4.4.3 of Winter, Biomechanics and Motor Control (2009).

R(f) is the root mean square of the part that a filter with the cutoff f removes. At high f it is noise only. Winter
extends that part of the curve as a straight line to f = 0, where it gives the size of all the noise, and takes the
cutoff at which R(f) has this size: the signal removed there is as large as the noise let through. For white noise the
response of the filter determines the square of R(f), so this curve is fitted instead of a line.

The cutoff balances the errors of the filtered quantity itself, so for identification it is an upper bound:
derivatives amplify noise by the frequency. Above the commanded motion lie vibrations of the arm, which the encoder
measures but which are not rigid-body motion. Blocked cross-validation shows whether a lower cutoff predicts better.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np

from crosscheck.recordings.preparation.filtering import border, lowpass
from graphdyn import InvalidInput
from graphdyn.layout import Array

N_TRIAL_CUTOFFS = 60
"""Number of trial cutoffs, evenly spaced in the logarithm."""

RESPONSE_FREQUENCIES = 1024
"""Number of frequencies over which the response of a filter is averaged."""

MIN_CUTOFF, NOISE_FROM, MAX_CUTOFF = 0.002, 0.5, 0.9
"""Fractions of the Nyquist frequency: trial cutoffs range from MIN_CUTOFF to MAX_CUTOFF, above which hardly any noise
is removed; from NOISE_FROM on, only noise is expected."""

NOISE_DIFFERENCE_ORDER = 6
"""Order of the differences that show white noise alone: a motion a tenth as fast as the sampling leaves 6 % in them."""


@dataclass(frozen=True, eq=False)
class ResidualAnalysis:
    """Residual analysis of one column.

    cutoff: the chosen one [Hz]; noise: standard deviation of the noise, the value at f = 0 of the fitted curve
    frequencies, residuals: the curve R(f)   (K,) [Hz], units of the column
    """

    cutoff: float
    noise: float
    frequencies: Array
    residuals: Array


def residual_analysis(values: Array, rate: float, order: int = 4) -> ResidualAnalysis:
    """Choose the cutoff [Hz] for a column (N,) sampled evenly at the rate [Hz].

    A constant column gets the lowest trial; one whose noise floor is hidden by signal at all trials gets the highest.
    Raises InvalidInput if the column is too short for a trial.
    """
    values = np.asarray(values, dtype=float)
    nyquist = rate / 2
    shortest = max(MIN_CUTOFF * nyquist, rate * 4 / max(len(values), 1))  # a border of the recording must fit into it
    if shortest > NOISE_FROM * nyquist / 2:
        raise InvalidInput(f"{len(values)} rows are too few to choose a cutoff from; give the cutoff")
    frequencies = np.geomspace(shortest, MAX_CUTOFF * nyquist, N_TRIAL_CUTOFFS)
    cut = min(border(rate, float(frequencies[0]), order), len(values) // 4)
    squares = np.array(
        [np.mean((values - lowpass(values, rate, float(f), order))[cut : len(values) - cut] ** 2) for f in frequencies]
    )
    tail = frequencies >= NOISE_FROM * nyquist
    part = np.array([_removed(float(f), rate, order) for f in frequencies[tail]])
    noise = float(part @ squares[tail] / (part @ part))
    below = np.flatnonzero(squares <= noise)
    cutoff = float(frequencies[below[0]] if below.size else frequencies[-1])
    return ResidualAnalysis(cutoff, float(np.sqrt(noise)), frequencies, np.sqrt(squares))


def _removed(cutoff: float, rate: float, order: int) -> float:
    """The part of the power of white noise that the filter, run forward and backward, removes."""
    from scipy.signal import butter, sosfreqz

    _, response = sosfreqz(butter(order, cutoff, fs=rate, output="sos"), RESPONSE_FREQUENCIES, fs=rate)
    return float(np.mean((1 - np.abs(response) ** 2) ** 2))


def white_noise(values: Array) -> Array:
    """Standard deviation of the white noise of columns (N, n) sampled evenly (n,): that of their sixth differences.

    A difference of order k of white noise has the variance binom(2 k, k) times that of the noise.
    """
    if len(values) <= NOISE_DIFFERENCE_ORDER:
        return np.zeros(values.shape[1:])
    squares = np.mean(np.diff(values, NOISE_DIFFERENCE_ORDER, axis=0) ** 2, axis=0)
    return np.asarray(np.sqrt(squares / comb(2 * NOISE_DIFFERENCE_ORDER, NOISE_DIFFERENCE_ORDER)))
