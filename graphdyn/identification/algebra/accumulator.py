"""Least squares over any number of rows: one triangular factor per joint, updated block by block.

    W_g x ≈ τ_g per group g (joint).     QᵀQ = E,  Q F_g = [W_g | τ_g],  F_g (p + 1, p + 1) upper triangular

F_g holds all that least squares needs: ‖W_g x - τ_g‖ = ‖F_g [x; -1]‖. LAPACK's triangular-pentagonal QR adds a new
block to it. The alternative, the Gram matrix [W_g | τ_g]ᵀ [W_g | τ_g], costs half and squares the condition number:
half of the digits are lost before the solution starts. Golub and Van Loan, Matrix Computations, sections 5.3 and 6.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.compressed import CompressedEquations
from graphdyn.identification.algebra.least_squares import square_triangle
from graphdyn.layout import Array

Compression = Literal["qr", "gram"]
Flags = NDArray[np.bool_]
COMPRESSIONS: tuple[Compression, ...] = ("qr", "gram")

PANEL_COLUMNS = 8
"""Block size of LAPACK's blocked factorization [columns]."""


class Accumulator:
    """Factors of [W_g | τ_g] per group, without the rows they came from.

    n_columns: p; n_groups: number of joints
    support: which columns can differ from zero in which group (n_groups, p); by default all. The others are never read
    method: "qr", or "gram" for well-conditioned data

    The same blocks in the same order give the same factors to the last bit. Other splits of the same rows, and merges
    in another order, differ by rounding.
    """

    def __init__(self, n_columns: int, n_groups: int, *, support: Flags | None = None, method: Compression = "qr"):
        if method not in COMPRESSIONS:
            raise InvalidInput(f"method is '{method}'; use one of {', '.join(COMPRESSIONS)}")
        self.n_columns, self.n_groups, self.method = n_columns, n_groups, method
        everywhere = np.ones((n_groups, n_columns), dtype=bool)
        self.support = everywhere if support is None else np.asarray(support, dtype=bool)
        if self.support.shape != everywhere.shape:
            raise InvalidInput(f"support has shape {self.support.shape}, expected {everywhere.shape}")
        self._columns = [np.append(np.flatnonzero(row), n_columns) for row in self.support]
        self._squares = [np.zeros((len(columns), len(columns)), order="F") for columns in self._columns]
        self.counts: NDArray[np.int64] = np.zeros(n_groups, dtype=np.int64)

    def add(
        self,
        rows: Array,
        right: Array,
        *,
        kept: Flags | None = None,
        weights: Array | None = None,
    ) -> None:
        """Add a block of N samples.

        rows: W (N, g, p); right: τ (N, g)
        kept: which equations count (N, g); weights: factors of the equations (N, g)
        Raises InvalidInput for other shapes, NaN or infinity; the factors then stay as before.
        """
        self._check(rows, right, kept, weights)
        blocks = [self._block(g, rows, right, kept, weights) for g in range(self.n_groups)]
        for g, block in enumerate(blocks):
            self._fold(g, block)
            self.counts[g] += len(block)

    def add_gram(self, grams: Sequence[Array], counts: NDArray[np.int64]) -> None:
        """Add [W_g | τ_g]ᵀ [W_g | τ_g] (p + 1, p + 1) of every group, with the number of equations that each one sums
        up.

        Raises InvalidInput if the factors are kept by QR.
        """
        if self.method != "gram":
            raise InvalidInput("Gram matrices can be added to an accumulator of method 'gram' only")
        for g, (columns, gram) in enumerate(zip(self._columns, grams, strict=True)):
            self._squares[g] += gram[np.ix_(columns, columns)]
        self.counts += counts

    def merge(self, other: Accumulator) -> Accumulator:
        """Sum of both as a new accumulator. Raises InvalidInput if they are not of the same kind."""
        same = self.method == other.method and np.array_equal(self.support, other.support)
        if not same:
            raise InvalidInput(
                f"accumulators of {self.n_groups} × {self.n_columns} ({self.method}) and {other.n_groups} × "
                f"{other.n_columns} ({other.method}) columns, or of different support, cannot be merged"
            )
        both = Accumulator(self.n_columns, self.n_groups, support=self.support, method=self.method)
        both._squares = [square.copy(order="F") for square in self._squares]
        both.counts = self.counts + other.counts
        for g, square in enumerate(other._squares):
            if self.method == "gram":
                both._squares[g] += square
            else:
                both._fold(g, np.asfortranarray(np.triu(square)))
        return both

    @property
    def factors(self) -> Array:
        """F (g, p + 1, p + 1), upper triangular with a diagonal that is not negative."""
        factors = np.zeros((self.n_groups, self.n_columns + 1, self.n_columns + 1))
        for g, (columns, square) in enumerate(zip(self._columns, self._squares, strict=True)):
            triangle = np.triu(square) if self.method == "qr" else _gram_factor(square)
            spread = np.zeros((len(columns), self.n_columns + 1))
            spread[:, columns] = triangle
            factors[g] = square_triangle(spread)
        return factors

    @property
    def compressed(self) -> CompressedEquations:
        """The equations added so far."""
        return CompressedEquations(self.factors, self.counts.copy())

    def _check(self, rows: Array, right: Array, kept: Flags | None, weights: Array | None) -> None:
        samples = len(right)
        expected = {"rows": (samples, self.n_groups, self.n_columns), "right": (samples, self.n_groups)}
        given = {"rows": rows, "right": right, "kept": kept, "weights": weights}
        for name, array in given.items():
            shape = expected.get(name, (samples, self.n_groups))
            if array is not None and array.shape != shape:
                raise InvalidInput(f"{name} has shape {array.shape}, expected {shape}")

    def _block(self, g: int, rows: Array, right: Array, kept: Flags | None, weights: Array | None) -> Array:
        """[W_g | τ_g] on the support, in LAPACK's column-major order."""
        columns = self._columns[g]
        block = np.empty((len(right), len(columns)), order="F")
        block[:, :-1] = rows[:, g, columns[:-1]]
        block[:, -1] = right[:, g]
        if weights is not None:
            block *= weights[:, g, None]
        if kept is not None and not kept[:, g].all():
            block = np.asfortranarray(block[kept[:, g]])
        if not np.isfinite(block.sum()) and not np.all(np.isfinite(block)):
            bad = int(np.argwhere(~np.isfinite(block))[0][0])
            raise InvalidInput(f"group {g}: NaN or infinity in row {bad} of the block; leave the sample out")
        return block

    def _fold(self, g: int, block: Array) -> None:
        if len(block) == 0:
            return
        if self.method == "gram":
            self._squares[g] += block.T @ block
            return
        from scipy.linalg.lapack import dtpqrt  # imported where first used: import graphdyn stays light

        panel = min(PANEL_COLUMNS, len(self._columns[g]))
        # QR of the triangle above the block: the new triangle replaces the old one, in place
        self._squares[g], _, _, _ = dtpqrt(0, panel, self._squares[g], block, overwrite_a=1, overwrite_b=1)


def _gram_factor(gram: Array) -> Array:
    """F with FᵀF = G, for a G that rounding may have left with small negative eigenvalues."""
    scale = np.sqrt(np.diag(gram))
    scale = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(gram / scale / scale[:, None])
    factor: Array = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T * scale
    return factor
