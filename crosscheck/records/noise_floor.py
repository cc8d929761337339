"""A cutoff from the data: residual analysis, section 3.4.4.3 of Winter, Biomechanics and Motor Control (2009).

R(f) is the root mean square of what a filter with the cutoff f removes. At high f it removes noise only. Winter extends
that part of the curve as a straight line to f = 0, where it would be the noise without any signal, and takes the cutoff
where R(f) has this size: as much signal is lost there as noise is let through. White noise makes the square of R a
straight line, noise · (1 - f / f_Nyquist), so the line is fitted to the square here.

It balances errors of the filtered quantity itself, so it is an upper bound for what follows: derivatives amplify noise
by the frequency, and above the motion that was commanded lie vibrations of the arm, which are signal to the encoder and
no rigid-body motion. Blocked cross-validation tells whether a lower cutoff predicts better.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.records.filtering import border, lowpass
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array

CUTOFFS = 60
"""Trial cutoffs, evenly in the logarithm."""

LOWEST, NOISE_FROM, HIGHEST = 0.002, 0.5, 0.9
"""Parts of the Nyquist frequency: trial cutoffs range from the first to the last, noise alone is expected from the
middle one on; above the last the bilinear transform bends the filter too much."""


@dataclass(frozen=True, eq=False)
class ResidualAnalysis:
    """Of one column.

    cutoff: the chosen one [Hz]; noise: standard deviation at which the line meets f = 0, in units of the column
    frequencies, residuals: the curve R(f)   (K,) [Hz], units of the column
    """

    cutoff: float
    noise: float
    frequencies: Array
    residuals: Array


def residual_analysis(values: Array, rate: float, order: int = 4) -> ResidualAnalysis:
    """Choose the cutoff [Hz] for a column (N,) sampled evenly at the rate [Hz].

    A constant column, and one whose noise floor is hidden by signal up to the highest trial, get the lowest and the
    highest trial. Raises InvalidInput where the column is too short for a trial.
    """
    values = np.asarray(values, dtype=float)
    nyquist = rate / 2
    shortest = max(LOWEST * nyquist, rate * 4 / max(len(values), 1))  # a border of the record must fit into it
    if shortest > NOISE_FROM * nyquist / 2:
        raise InvalidInput(f"{len(values)} rows are too few to choose a cutoff from; give the cutoff")
    frequencies = np.geomspace(shortest, HIGHEST * nyquist, CUTOFFS)
    cut = min(border(rate, float(frequencies[0]), order), len(values) // 4)
    squares = np.array(
        [np.mean((values - lowpass(values, rate, float(f), order))[cut : len(values) - cut] ** 2) for f in frequencies]
    )
    tail = frequencies >= NOISE_FROM * nyquist
    part = 1 - frequencies[tail] / nyquist
    noise = float(part @ squares[tail] / (part @ part))
    below = np.flatnonzero(squares <= noise)
    cutoff = float(frequencies[below[0]] if below.size else frequencies[-1])
    return ResidualAnalysis(cutoff, float(np.sqrt(noise)), frequencies, np.sqrt(squares))
