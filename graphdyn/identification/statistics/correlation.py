"""Correlation of residuals in time, and standard deviations that allow for it.

The correlation length is the lag at which the autocorrelation has fallen to 1/e. The count starts at lag 1, because
white noise adds only to lag 0 and would hide an additional correlated part. A recording of any length is reduced to at
most MAX_CELLS means of consecutive samples. A correlation that matters to the standard deviations of a whole recording
is still visible in them.

The standard deviations come from the jackknife over time blocks:

    cov x = (B - 1) / B Σ_b (x_b - x) (x_b - x)ᵀ,  x_b the solution without time block b

The blocks count as independent, whatever the noise inside them is, so a block must be much longer than the
correlation. Leaving a block out accounts for its effect on the parameters. Sums of squared residuals do not: they
were minimized, and make deviations too small. Quenouille, Biometrika 43, 1956; Künsch, Annals of Statistics
17(3), 1989; as CR3 in Bell and McCaffrey, Survey Methodology 28(2), 2002.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.layout import Array

MAX_CELLS = 16384
"""Largest number of means of consecutive samples in memory; beyond it neighbors are merged."""

MAX_WHITE_DEVIATIONS = 3.0
"""First autocorrelation of white noise, in standard deviations 1/√N, below which residuals count as white."""


class CorrelationLength:
    """Correlation length of n × m columns of residuals, which arrive piece by piece.

    Gaps are ignored: few products reach across them.
    """

    def __init__(self, n: int, m: int):
        self._cells, self._left = np.zeros((0, n, m)), np.zeros((0, n, m))
        self._size = 1

    def add(self, residual: Array, kept: NDArray[np.bool_]) -> None:
        """Add a residual (N, n, m); rows that are not kept (N, n) count as zero."""
        self._left = np.concatenate([self._left, np.where(kept[..., None], residual, 0.0)])
        whole = len(self._left) // self._size * self._size
        self._cells = np.concatenate([self._cells, _means(self._left[:whole], self._size)])
        self._left = self._left[whole:]
        while len(self._cells) > MAX_CELLS:
            even = len(self._cells) // 2 * 2
            odd = np.repeat(self._cells[even:], self._size, axis=0)  # a mean again as the samples that it stands for
            self._left = np.concatenate([odd, self._left])
            self._cells, self._size = _means(self._cells[:even], 2), 2 * self._size

    def samples(self) -> Array:
        """Correlation length in samples (n, m): 0 for white residuals, NaN if there are none."""
        n_cells = len(self._cells)
        spectrum = np.abs(np.fft.rfft(self._cells, 2 * n_cells, axis=0)) ** 2 if n_cells > 1 else np.zeros((1, 1, 1))
        products = np.fft.irfft(spectrum, axis=0)[: max(n_cells, 1)] if n_cells > 1 else spectrum
        found = np.full(self._cells.shape[1:], np.nan)
        for place in np.ndindex(found.shape):
            if n_cells > 2 and products[(0, *place)] > 0:
                found[place] = self._size * _fallen(products[(slice(None), *place)] / products[(0, *place)])
        return found


def _means(rows: Array, size: int) -> Array:
    means: Array = rows.reshape(-1, size, *rows.shape[1:]).mean(axis=1)
    return means


def _fallen(correlation: Array) -> float:
    """Lags beyond the first after which the correlation is 1/e of that at the first, interpolated linearly."""
    if correlation[1] <= MAX_WHITE_DEVIATIONS / np.sqrt(len(correlation)):
        return 0.0
    limit = correlation[1] / np.e
    k = int(np.argmax(correlation <= limit))
    if k == 0:  # never
        return float(len(correlation))
    return float(k - 2 + (correlation[k - 1] - limit) / (correlation[k - 1] - correlation[k]))


KNOWN_SHARE = 1e-8
"""Relative information of the other blocks on a combination of parameters below which one block alone determines it."""


def jackknife_covariance(blocks: Sequence[CompressedEquations], x: Array, deviations: Array) -> Array | None:
    """Covariance (b, b) of x, the minimum of Σ_g ‖W_g x - τ_g‖² / deviations_g²; None below two blocks.

    If one block alone determines a parameter, its variance is infinite, and its covariances are NaN. With few blocks
    the
    result is rough: each standard deviation is uncertain by 1 / sqrt(2 B) of itself.
    """
    from scipy.linalg import solve_triangular  # imported where first used: import graphdyn stays light

    if len(blocks) < 2:
        return None
    r = merged(blocks).informed(deviations)[0][: len(x)]
    scale = np.linalg.norm(r, axis=0)
    inverse = solve_triangular(r / scale, np.eye(len(x)))  # columns at unit length; R x = y has the covariance of y
    changes, alone = [], np.zeros(len(x), dtype=bool)
    for block in blocks:
        w, z = block.weighted(deviations)
        orthonormal = (w / scale) @ inverse
        left, vectors = np.linalg.eigh(np.eye(len(x)) - orthonormal.T @ orthonormal)  # information of the others
        known = left > KNOWN_SHARE
        gradient = vectors.T @ (orthonormal.T @ (w @ x - z))
        changes.append(inverse @ (vectors[:, known] @ (gradient[known] / left[known])))
        share = inverse @ vectors[:, ~known]
        alone |= np.sum(share**2, axis=1) > KNOWN_SHARE * np.sum(inverse**2, axis=1)
    s = np.array(changes) / scale
    covariance: Array = s.T @ s * (len(blocks) - 1) / len(blocks)
    covariance[alone, :], covariance[:, alone] = np.nan, np.nan
    covariance[alone, alone] = np.inf
    return covariance


def left_out_covariance(blocks: Array, scores: Array, scale: Array) -> Array | None:
    """Covariance (b, b) of x with Σ_b s_b = 0, s_b = z_b - A_b x; None below two blocks.

    blocks: A_b (B, b, b), of full rank together; scores: s_b (B, b); scale: lengths of the columns (b,)
    Without block b the solution moves by -(Σ A - A_b)⁻¹ s_b. The variance is infinite if one block alone determines x.
    """
    count = len(blocks)
    if count < 2:
        return None
    a = blocks / scale / scale[:, None]
    left = a.sum(axis=0) - a
    if np.linalg.cond(left).max() > 1 / KNOWN_SHARE:
        return np.full(blocks.shape[1:], np.inf)
    changes = -np.linalg.solve(left, (scores / scale)[..., None])[..., 0] / scale
    covariance: Array = changes.T @ changes * (count - 1) / count
    return covariance
