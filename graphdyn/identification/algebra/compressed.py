"""Compressed equations, one triangular factor per joint, and their solution with its covariance.

The factor holds the information of a recording on linear parameters:
F_g (b + 1, b + 1) with ‖W_g x - τ_g‖ = ‖F_g [x; -1]‖ and the number of equations that it sums up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.base_parameters import MIN_COLUMN_SHARE, RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import triangle
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
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

    @property
    def unit_regressor(self) -> Array:
        """R (b + 1, b) of W, groups weighted by their measured torque and columns at unit length."""
        size = np.sqrt(self.measured_squares / np.maximum(self.counts, 1))
        r, _ = self.weighted(np.where(size > 0, size, 1.0))
        length = np.linalg.norm(r, axis=0)
        return r / np.where(length > 0, length, 1.0)

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


EPS = float(np.finfo(float).eps)
"""Relative precision of data that were never rounded."""

MIN_ROWS_LEFT = 0.5
"""Fewest equations that the parameters must leave over for a group; with fewer its noise cannot be estimated."""


@dataclass(frozen=True, eq=False)
class Solution:
    """x that minimizes Σ_g ‖W_g x - τ_g‖² / σ_g².

    x: (b,); inverse: (Σ_g W_gᵀW_g / σ_g²)⁻¹                (b, b)
    condition_number: of the weighted W with columns at unit length
    """

    x: Array
    inverse: Array
    condition_number: float


def solve(equations: CompressedEquations, deviations: Array) -> Solution:
    """Solution by singular values of the factor, with columns at unit length.

    Raises EstimationFailed if the columns are dependent.
    """
    return solve_triangle(*equations.informed(deviations))


def solve_triangle(r: Array, z: Array) -> Solution:
    """x that minimizes ‖R x - z‖. Raises EstimationFailed if the columns of R are dependent."""
    scale = np.linalg.norm(r, axis=0)
    if not np.all(scale > 0):
        raise EstimationFailed(f"parameter {int(np.argmin(scale))} of the weighted equations has no effect")
    u, s, v_t = np.linalg.svd(r / scale, full_matrices=False)
    if s.size and s[-1] <= len(s) * EPS * s[0]:
        rank = int(np.count_nonzero(s > len(s) * EPS * s[0]))
        raise EstimationFailed(f"the weighted equations have rank {rank} of {len(s)} parameters")
    pseudo_inverse = v_t.T / s / scale[:, None]
    return Solution(
        x=pseudo_inverse @ (u.T @ z),
        inverse=pseudo_inverse @ pseudo_inverse.T,
        condition_number=float(s[0] / s[-1]) if s.size else 1.0,
    )


def leverages(equations: CompressedEquations, deviations: Array, inverse: Array) -> Array:
    """Equations of each group that the parameters use up: tr(W_g C W_gᵀ) / σ_g², with sum b (g,)."""
    w = equations.factors[..., :-1]
    shares: Array = np.sum((w @ inverse) * w, axis=(1, 2)) / np.asarray(deviations) ** 2
    return shares


def residual_deviations(equations: CompressedEquations, squares: Array, used: Array) -> Array:
    """Standard deviation of the residual per group: the root of its squares over the remaining equations (g,).

    If the noise of the equations is given, the function returns it.
    squares: ‖W_g x - τ_g‖² (g,); used: equations that the parameters use up (g,)
    The result is at least the rounding of the measured torque, so that exact data have a weight. Raises
    EstimationFailed if the parameters use up all equations of a group.
    """
    if equations.noise is not None:
        return equations.noise
    spare = equations.counts - used
    if np.any(spare < MIN_ROWS_LEFT):
        joint = int(np.argmin(spare))
        raise EstimationFailed(
            f"joint {joint + 1} has {equations.counts[joint]} equations, the parameters use up {used[joint]:.1f} of "
            "them: nothing is left to estimate its noise from; record more or keep more rows"
        )
    floor = EPS**2 * equations.measured_squares + np.finfo(float).tiny
    return np.sqrt(np.maximum(squares, floor) / spare)


def weighted_solution(equations: CompressedEquations) -> tuple[Solution, Array]:
    """The solution, whose inverse is its covariance, and the noise of each group (g,)."""
    noise = joint_noise(equations)
    return solve(equations, noise), noise


def joint_noise(equations: CompressedEquations) -> Array:
    """σ_g (g,) of the torque of each joint: as given, or from its own equations alone."""
    if equations.noise is not None:
        return equations.noise
    squares, used = np.empty(equations.n_groups), np.empty(equations.n_groups)
    for g, factor in enumerate(equations.factors):
        w, right = factor[:, :-1], factor[:, -1]
        length = np.linalg.norm(w, axis=0)
        seen = length > MIN_COLUMN_SHARE * length.max(initial=0.0)  # the rest is rounding, and stays so if not scaled
        unit = w[:, seen] / length[seen]
        x, _, used[g], _ = np.linalg.lstsq(unit, right, rcond=RANK_TOLERANCE)
        squares[g] = np.sum((unit @ x - right) ** 2)
    return residual_deviations(equations, squares, used)
