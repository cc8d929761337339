"""Held-out error of a recording with and without a change: blocks predicted by a fit of the others."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.layout import Array

HELD_OUT_BLOCKS = 10
"""Number of time blocks, each of which is predicted once."""

MIN_IMPROVEMENT = 1.0
"""Fall of the held-out error from which it is an improvement, in standard deviations."""


class HeldOutGain(NamedTuple):
    """Fall of Σ_j log ‖e_j‖ of the held-out blocks, and its standard deviation (jackknife); NaN if it was not asked."""

    gained: float
    deviation: float

    @property
    def improves(self) -> bool:
        """Whether the error falls beyond its deviation."""
        return self.gained > MIN_IMPROVEMENT * self.deviation


NOT_ASKED = HeldOutGain(float("nan"), float("nan"))


def held_out_squares(fit: BoundedFit, tau: Array) -> Array:
    """‖e_j‖² of every block, predicted by a fit of the others, relative to ‖τ_j‖² (blocks, n). tau: measured (N, n)."""
    squares = []
    for block in np.array_split(np.arange(len(tau)), HELD_OUT_BLOCKS):
        rest = np.delete(np.arange(len(tau)), block)
        x = fit.part(rest).parameters(tau[rest])
        squares.append(np.nansum(fit.part(block).residual(tau[block], x) ** 2, axis=0))
    size = np.sum(np.where(fit.kept, tau, 0.0) ** 2, axis=0)
    return np.array(squares) / np.where(size > 0, size, 1.0)


def held_out_gain(before: Array, after: Array) -> HeldOutGain:
    """Gain from the errors before a change to those after it, as of held_out_squares (blocks, n)."""

    def gained(kept: NDArray[np.intp]) -> float:
        first, second = (np.maximum(squares[kept].sum(axis=0), MIN_RESIDUAL**2) for squares in (before, after))
        return float(np.sum(np.log(first / second)) / 2)

    every = np.arange(len(before))
    others = np.array([gained(np.delete(every, k)) for k in every])
    variance = (len(every) - 1) / len(every) * np.sum((others - others.mean()) ** 2)
    return HeldOutGain(gained(every), float(np.sqrt(variance)))
