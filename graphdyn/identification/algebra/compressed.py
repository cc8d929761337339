"""Compressed equations: the information of a recording on linear parameters as one triangular factor per joint.

F_g (b + 1, b + 1) with ‖W_g x - τ_g‖ = ‖F_g [x; -1]‖ and the number of equations that it sums up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.least_squares import triangle
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class CompressedEquations:
    """The equations W_g x = τ_g of every group, as a triangular factor of [W_g | τ_g].

    factors: F                                              (g, b + 1, b + 1)
    counts: equations of each group                         (g,)
    expected: prior knowledge as further equations, in units of their deviation   (k, b + 1), None if there is none
    noise: standard deviation of each group, None if it is to be estimated   (g,)
    """

    factors: Array
    counts: NDArray[np.int64]
    expected: Array | None = None
    noise: Array | None = None

    @property
    def n_groups(self) -> int:
        """Number of groups g."""
        return len(self.factors)

    @property
    def n_columns(self) -> int:
        """Number of parameters b."""
        width: int = self.factors.shape[-1] - 1
        return width

    @property
    def measured_squares(self) -> Array:
        """Squared norms of the right-hand sides, ‖τ_g‖² (g,)."""
        squares: Array = np.sum(self.factors[..., -1] ** 2, axis=-1)
        return squares

    def residual_squares(self, x: Array) -> Array:
        """Squared residuals ‖W_g x - τ_g‖² (g,) of parameters x (b,)."""
        squares: Array = np.sum((self.factors[..., :-1] @ x - self.factors[..., -1]) ** 2, axis=-1)
        return squares

    def selected(self, columns: NDArray[np.int64]) -> CompressedEquations:
        """The equations with only these columns of W."""
        chosen = np.append(columns, self.n_columns)
        expected = None if self.expected is None else self.expected[:, chosen]
        return CompressedEquations(triangle(self.factors[..., chosen]), self.counts, expected, self.noise)

    def weighted(self, deviations: Array) -> tuple[Array, Array]:
        """R (b + 1, b), z (b + 1,): ‖R x - z‖² = Σ_g ‖W_g x - τ_g‖² / deviations_g², including the residual."""
        scaled = self.factors / np.asarray(deviations, dtype=float)[:, None, None]
        f = triangle(scaled.reshape(-1, scaled.shape[-1]))
        return f[:, :-1], f[:, -1]

    def informed(self, deviations: Array) -> tuple[Array, Array]:
        """R, z as in weighted, with the prior knowledge appended; the deviations are those of the noise."""
        r, z = self.weighted(deviations)
        if self.expected is None:
            return r, z
        f = triangle(np.concatenate([np.column_stack([r, z]), self.expected]))
        return f[:, :-1], f[:, -1]


def merged(parts: Sequence[CompressedEquations]) -> CompressedEquations:
    """Sum of all parts. The operation is associative up to rounding. Raises InvalidInput without a part."""
    if not parts:
        raise InvalidInput("there are no equations to merge; the recording has no sample that counts")
    factors = np.concatenate([part.factors for part in parts], axis=-2)
    counts = np.sum([part.counts for part in parts], axis=0)
    return CompressedEquations(triangle(factors), counts, parts[0].expected, parts[0].noise)
