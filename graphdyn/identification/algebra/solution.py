"""Solution of compressed equations, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.compressed import CompressedEquations
from graphdyn.layout import Array

EPS = float(np.finfo(float).eps)

MIN_ROWS_LEFT = 0.5
"""Fewest equations that the parameters must leave over for a joint; with fewer its noise cannot be estimated."""


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
    r, z = equations.informed(deviations)
    return solve_triangle(r, z)


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
