"""Held-out error of a recording with and without a change of its torques: blocks predicted by a fit on the others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.data_quality.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.layout import Array

HELD_OUT_BLOCKS = 10
"""Number of time blocks, each of which is predicted once."""

MIN_IMPROVEMENT = 2.0
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


def held_out_gain(fit: BoundedFit, before: Array, after: Array) -> HeldOutGain:
    """Gain of torques (N, n) after a change over those before it. fit: of the same rows"""
    blocks = np.array_split(np.arange(len(before)), HELD_OUT_BLOCKS)
    squares = np.array([_squares(fit, (before, after), block) for block in blocks])
    size = np.sum(np.where(fit.kept, before, 0.0) ** 2, axis=0)
    floor = MIN_RESIDUAL**2 * np.where(size > 0, size, 1.0)

    def gained(some: Array) -> float:
        first, second = np.maximum(some.sum(axis=0), floor)
        return float(np.sum(np.log(first / second)) / 2)

    others = np.array([gained(np.delete(squares, k, axis=0)) for k in range(HELD_OUT_BLOCKS)])
    variance = (HELD_OUT_BLOCKS - 1) / HELD_OUT_BLOCKS * np.sum((others - others.mean()) ** 2)
    return HeldOutGain(gained(squares), float(np.sqrt(variance)))


def _squares(fit: BoundedFit, torques: Sequence[Array], block: NDArray[np.intp]) -> list[Array]:
    """Sum of the squared residuals of each joint (n,) in a block that the other rows predict, for each torque."""
    rest = np.delete(np.arange(len(torques[0])), block)
    others, own = fit.part(rest), fit.part(block)
    return [np.nansum(own.residual(tau[block], others.parameters(tau[rest])) ** 2, axis=0) for tau in torques]
