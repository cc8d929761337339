"""What low-pass and differences make of the noise of measured positions: the errors of q, v and a, which share it."""

from __future__ import annotations

import numpy as np

from crosscheck.recordings.preparation.derivatives import STENCIL, Differentiation
from crosscheck.recordings.preparation.filtering import padding
from crosscheck.recordings.preparation.row_filters import LowPass
from graphdyn.identification import RowFilter
from graphdyn.layout import Array


def motion_covariance(
    differentiation: Differentiation, row_filter: RowFilter | None, rate: float, q_noise: Array, v_noise: Array | None
) -> Array:
    """Covariance of the errors of q, v and a of each joint in a row of the equations (n, 3, 3).

    rate: of the samples [Hz]; q_noise: standard deviations of the measured positions (n,), v_noise: of measured
    velocities, where v is measured

    White noise through a filter has the covariance Σ_t h_t h_tᵀ, h the answers of q, v and a to one impulse. Where the
    rows are decimated every factor-th term of the sum is known; they stand for all, because h is slower than the rows.
    """
    factor, memory = (1, 0) if row_filter is None else (row_filter.factor, row_filter.memory)
    lows = (LowPass(cutoff, rate).memory for cutoff in differentiation.cutoffs.values())
    middle = memory + max(lows, default=0) + 2 * STENCIL + padding()
    impulse, nothing = np.zeros((2, 2 * middle + 1, 1))
    impulse[middle] = 1.0

    def spread(q: Array, v: Array) -> Array:
        seen = differentiation(q, v, rate)
        answers = np.hstack(seen if row_filter is None else [row_filter(column) for column in seen])
        return np.asarray(factor * answers.T @ answers)

    covariance = q_noise[:, None, None] ** 2 * spread(impulse, nothing)
    if v_noise is not None:
        covariance = covariance + v_noise[:, None, None] ** 2 * spread(nothing, impulse)
    return np.asarray(covariance)
