"""The equations of instrumental variables, summed up: Z_gᵀ W_g x = Z_gᵀ τ_g of every joint g and time block.

    x = A⁻¹ Σ_g Z_gᵀ τ_g / σ_g²,   A = Σ_g Z_gᵀ W_g / σ_g²,   cov x = A⁻¹ (Σ_g Z_gᵀ Z_g / σ_g²) A⁻ᵀ

The products square the condition number, so columns are scaled to unit length before the solution.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.solution import EPS
from graphdyn.identification.closed_loop.beside import RowBlock
from graphdyn.identification.statistics.correlation import left_out_covariance
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Crossed:
    """Solution x (r,), its covariance (r, r), and the covariance that allows for correlation in time.

    The last needs two time blocks, and is None otherwise.
    noise: of the torques, by which the equations were weighted (n,)
    """

    x: Array
    covariance: Array
    block_covariance: Array | None
    noise: Array


@dataclass(frozen=True, eq=False)
class CrossedEquations:
    """Sums of the instrumental-variable equations.

    products: Z_gᵀ [W_g | τ_g] of every time block         (B, n, r, r + 1)
    instruments: Z_gᵀ Z_g                                   (n, r, r)
    """

    products: Array
    instruments: Array

    @classmethod
    def of(cls, parts: Iterable[RowBlock], support: NDArray[np.bool_]) -> CrossedEquations:
        """Sum up these rows. support: where W can differ from zero (n, r)."""
        n, r = support.shape
        blocks: dict[int, Array] = defaultdict(lambda: np.zeros((n, r, r + 1)))
        squares = np.zeros((n, r, r))
        columns = [np.flatnonzero(row) for row in support]
        for part in parts:
            block = blocks[part.measured.block]
            for g, own in enumerate(columns):
                kept = part.measured.kept[:, g]
                z, w = part.regressor[kept, g][:, own], part.matrix[kept, g][:, own]
                block[g][np.ix_(own, np.append(own, r))] += z.T @ np.column_stack([w, part.measured.right[kept, g]])
                squares[g][np.ix_(own, own)] += z.T @ z
        return cls(np.array([block for _, block in sorted(blocks.items())]), squares)

    def solve(self, noise: Array) -> Crossed:
        """Solve with the noise σ_g (n,). Raises EstimationFailed if the instruments do not determine the parameters."""
        weights = 1 / noise[:, None, None] ** 2
        blocks = np.sum(self.products * weights, axis=1)
        together = blocks.sum(axis=0)
        squares = np.sum(self.instruments * weights, axis=0)
        scale = np.sqrt(np.diag(squares))
        if not np.all(scale > 0):
            raise EstimationFailed(f"the simulated motion does not excite base parameter {int(np.argmin(scale)) + 1}")
        a = together[:, :-1] / scale / scale[:, None]
        u, s, v_t = np.linalg.svd(a)
        if s.size and s[-1] <= len(s) * EPS * s[0]:
            raise EstimationFailed("the instruments do not determine the parameters: the simulated motion is another")
        inverse = (v_t.T / s) @ u.T / scale / scale[:, None]
        x = inverse @ together[:, -1]
        scores = blocks[:, :, -1] - blocks[:, :, :-1] @ x
        return Crossed(x, inverse @ squares @ inverse.T, left_out_covariance(blocks[:, :, :-1], scores, scale), noise)
