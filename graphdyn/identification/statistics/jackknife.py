"""Standard deviations that allow for correlation in time: the jackknife over time blocks.

    cov x = (B - 1) / B Σ_b (x_b - x) (x_b - x)ᵀ,  x_b the solution without time block b

The blocks count as independent, whatever the noise inside them is, so a block has to be much longer than the
correlation. Leaving a block out counts what the parameters have taken from it, where sums of squared residuals, small
because they were minimised, make deviations too small. Quenouille, Biometrika 43, 1956; Künsch, Annals of Statistics
17(3), 1989; as CR3 in Bell and McCaffrey, Survey Methodology 28(2), 2002.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.layout import Array

ALL = 1e-8
"""A combination of parameters of which the other blocks know less than this part is known from one block alone."""


def jackknife_covariance(blocks: Sequence[CompressedEquations], x: Array, deviations: Array) -> Array | None:
    """Covariance (b, b) of x, the minimum of Σ_g ‖W_g x - τ_g‖² / deviations_g²; None below two blocks.

    Where one block alone determines a parameter its variance is infinite, its covariances are NaN. Rough with few
    blocks: each standard deviation is uncertain by 1 / sqrt(2 B) of itself.
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
        known = left > ALL
        gradient = vectors.T @ (orthonormal.T @ (w @ x - z))
        changes.append(inverse @ (vectors[:, known] @ (gradient[known] / left[known])))
        share = inverse @ vectors[:, ~known]
        alone |= np.sum(share**2, axis=1) > ALL * np.sum(inverse**2, axis=1)
    s = np.array(changes) / scale
    covariance: Array = s.T @ s * (len(blocks) - 1) / len(blocks)
    covariance[alone, :], covariance[:, alone] = np.nan, np.nan
    covariance[alone, alone] = np.inf
    return covariance


def left_out_covariance(blocks: Array, scores: Array, scale: Array) -> Array | None:
    """Covariance (b, b) of x with Σ_b s_b = 0, s_b = z_b - A_b x; None below two blocks.

    blocks: A_b (B, b, b), of full rank together; scores: s_b (B, b); scale: lengths of the columns (b,)
    Without block b the solution moves by -(Σ A - A_b)⁻¹ s_b. Infinite where one block alone determines x.
    """
    count = len(blocks)
    if count < 2:
        return None
    a = blocks / scale / scale[:, None]
    left = a.sum(axis=0) - a
    if np.linalg.cond(left).max() > 1 / ALL:
        return np.full(blocks.shape[1:], np.inf)
    changes = -np.linalg.solve(left, (scores / scale)[..., None])[..., 0] / scale
    covariance: Array = changes.T @ changes * (count - 1) / count
    return covariance
