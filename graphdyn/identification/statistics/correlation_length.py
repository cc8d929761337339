"""Over how many samples residuals are correlated: the lag at which the autocorrelation has fallen to 1/e.

It counts from lag 1 on, because noise that is white adds to lag 0 alone and would hide what is correlated beside it. A
recording of any length is reduced to at most MOST_CELLS means of consecutive samples, in which a correlation that
matters to the standard deviations of a whole recording is still seen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array

MOST_CELLS = 16384
"""Means of consecutive samples in memory at once; where there are more, neighbours are put together."""

SURELY = 3.0
"""Standard deviations 1/√N of the first autocorrelation of white noise below which residuals count as white."""


class CorrelationLength:
    """Of n × m columns of residuals, which arrive piece by piece. Gaps are not seen: few products reach across them."""

    def __init__(self, n: int, m: int):
        self._cells, self._left = np.zeros((0, n, m)), np.zeros((0, n, m))
        self._size = 1

    def add(self, residual: Array, kept: NDArray[np.bool_]) -> None:
        """residual (N, n, m); what is not kept (N, n) counts as zero."""
        self._left = np.concatenate([self._left, np.where(kept[..., None], residual, 0.0)])
        whole = len(self._left) // self._size * self._size
        self._cells = np.concatenate([self._cells, _means(self._left[:whole], self._size)])
        self._left = self._left[whole:]
        while len(self._cells) > MOST_CELLS:
            even = len(self._cells) // 2 * 2
            odd = np.repeat(self._cells[even:], self._size, axis=0)  # a mean again as the samples that it stands for
            self._left = np.concatenate([odd, self._left])
            self._cells, self._size = _means(self._cells[:even], 2), 2 * self._size

    def samples(self) -> Array:
        """(n, m): 0 for residuals that are white, NaN for none."""
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
    """Lags beyond the first after which the correlation is 1/e of that at the first; between two lags, linearly."""
    if correlation[1] <= SURELY / np.sqrt(len(correlation)):
        return 0.0
    limit = correlation[1] / np.e
    k = int(np.argmax(correlation <= limit))
    if k == 0:  # never
        return float(len(correlation))
    return float(k - 2 + (correlation[k - 1] - limit) / (correlation[k - 1] - correlation[k]))
