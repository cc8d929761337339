"""What low-pass and differences make of the noise of measured positions: the errors of q, v and a, which share it."""

from __future__ import annotations

import numpy as np

from crosscheck.recordings.derivatives import STENCIL, Differentiation
from crosscheck.recordings.filtering import padding
from crosscheck.recordings.row_filters import LowPass
from graphdyn.identification import RowFilter
from graphdyn.layout import Array


def motion_covariance(
    differentiation: Differentiation, row_filter: RowFilter | None, rate: float, q_noise: Array, v_noise: Array | None
) -> Array:
    """Covariance of the errors of q, v and a of each joint in a row of the equations (n, 3, 3).

    rate: of the samples [Hz]; q_noise: standard deviations of the measured positions (n,), v_noise: of measured
    velocities, where v is measured

    White noise through a filter has the covariance Σ_t h_t h_tᵀ, h the answers of q, v and a to one impulse.
    """
    answers = _answers(differentiation, row_filter, rate)
    covariance = q_noise[:, None, None] ** 2 * (answers[0].T @ answers[0])
    if v_noise is not None:
        covariance = covariance + v_noise[:, None, None] ** 2 * (answers[1].T @ answers[1])
    return np.asarray(covariance)


def _answers(differentiation: Differentiation, row_filter: RowFilter | None, rate: float) -> Array:
    """Answers of q, v and a to an impulse of q and to one of v (2, K, 3): of decimated ones, at every phase."""
    factor, memory = (1, 0) if row_filter is None else (row_filter.factor, row_filter.memory)
    lows = (LowPass(cutoff, rate).memory for cutoff in differentiation.cutoffs.values())
    middle = memory + max(lows, default=0) + 2 * STENCIL + padding()
    impulses, nothing = np.zeros((2, 2 * middle + factor, factor))
    impulses[middle + np.arange(factor), np.arange(factor)] = 1.0
    answers = []
    for q, v in ((impulses, nothing), (nothing, impulses)):
        seen = differentiation(q, v, rate)
        filtered = seen if row_filter is None else [row_filter(columns) for columns in seen]
        answers.append(np.stack([np.ravel(columns) for columns in filtered], axis=-1))
    return np.array(answers)
