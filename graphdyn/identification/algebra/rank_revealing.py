"""Least squares that reports which parameters the data do not determine.

The paper's solutions, Eq. (56) and (64), invert KᵀK. That squares the condition number, and the inverse does not exist
if the motion leaves a parameter without effect. Here K = U Σ Vᵀ, and singular values below the precision of the data
are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE, sum_in_words
from graphdyn.identification.algebra.compressed import EPS, MIN_ROWS_LEFT
from graphdyn.layout import Array

PRECISION_MARGIN = 10.0
"""Factor by which a singular value must exceed the precision of the data: columns of K that are only rounding or
noise reach 0.2 to 2 times the precision, measured on the scale that their kind of column can reach."""

MAX_STRAY_SHARE = 1e-2
"""Largest component in the null space with which a parameter counts as determined individually."""


@dataclass(frozen=True, eq=False)
@short_repr
class ParameterEstimate:
    """Solution of a linear least-squares problem K x = l with r = rank(K) of p columns.

    names: of the parameters                                (p,)
    values: x, NaN if the data do not determine the parameter individually           (p,)
    standard_deviations: of the values; NaN also if a group of rows leaves none over         (p,)
    rank, tolerance: singular values above the tolerance count
    singular_values: of K with scaled columns               (p,)
    condition_number: largest over smallest singular value that counts; 1 at rank 0
    combinations: B with B x determined, each row 1 at one parameter   (r, p)
    combination_values, combination_standard_deviations: B x           (r,)
    null_space: directions of x without effect on the data  (p, p - r)
    residual: K x - l                                       (rows,)
    """

    names: tuple[str, ...]
    values: Array
    standard_deviations: Array
    rank: int
    tolerance: float
    singular_values: Array
    condition_number: float
    combinations: Array
    combination_values: Array
    combination_standard_deviations: Array
    null_space: Array
    residual: Array

    @property
    def determined(self) -> NDArray[np.bool_]:
        """Whether the data determine each parameter individually (p,)."""
        return np.isfinite(self.values)

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Names of the parameters that the data do not determine individually."""
        return tuple(name for name, known in zip(self.names, self.determined, strict=True) if not known)

    @property
    def combination_names(self) -> tuple[str, ...]:
        """The determined combinations as text: "B1 I_yy + 0.25 B2 m"."""
        return tuple(sum_in_words(row, self.names) for row in self.combinations)


def rank_tolerance(precision: float) -> float:
    """Smallest singular value that counts, for data rounded to this relative precision.

    It is at least RANK_TOLERANCE, the bound of the base parameters: an angle such as π/2, rounded in a robot's file,
    must not appear as a parameter. Raises InvalidInput for a precision outside (0, 1).
    """
    if not 0 < precision < 1:
        raise InvalidInput(f"precision is {precision}; give the relative rounding of the data, such as 1e-7")
    return max(RANK_TOLERANCE, PRECISION_MARGIN * precision)


def rank_revealing_least_squares(
    matrix: Array,
    right: Array,
    names: tuple[str, ...],
    *,
    column_scale: Array,
    groups: NDArray[np.int64],
    precision: float = EPS,
) -> ParameterEstimate:
    """x that minimizes ‖K x - l‖ on the part of the parameter space that K determines.

    matrix: K (rows, p); right: l (rows,)
    column_scale: divisor of the columns; the size that columns of their kind can reach              (p,)
    groups: number of the group of each row; rows of a group have the same noise                    (rows,)
    precision: relative rounding or noise of the data

    A parameter is determined individually if the null space of K has no component along it. The noise of a group is
    estimated from its residual, divided by the equations that the parameters leave over.
    """
    from scipy.linalg import qr, solve  # imported where first used: import graphdyn stays light

    tolerance = rank_tolerance(precision)
    stray = min(np.sqrt(tolerance), MAX_STRAY_SHARE)  # rounding turns null vectors by tolerance / σ_r at most
    # K = Q R, R = U Σ Vᵀ: the decomposition of a p × p triangle instead of all rows
    q, triangle = np.linalg.qr(matrix / column_scale)
    u, sigma, v_t = np.linalg.svd(triangle)
    sigma = np.append(sigma, np.zeros(len(names) - len(sigma)))
    rank = int(np.count_nonzero(sigma > tolerance))
    u = q @ u[:, :rank]
    inverse = v_t[:rank].T / sigma[:rank]  # scaled x = inverse @ uᵀ l
    null = v_t[rank:].T

    # the shortest of all scaled solutions
    smallest = inverse @ (u.T @ right)
    residual = matrix @ (smallest / column_scale) - right
    covariance = _covariance(inverse, u, residual, groups)

    determined = np.linalg.norm(null, axis=1) <= stray
    # p - r parameters that are expressed by the others: pivoting takes the best conditioned rows of the null space
    dependent = qr(null.T, mode="r", pivoting=True)[1][: len(names) - rank]
    independent = np.setdiff1d(np.arange(len(names)), dependent)
    combinations = np.zeros((rank, len(names)))
    combinations[np.arange(rank), independent] = 1.0
    # B x does not change along the null space: B_dependent = -null_independent null_dependent⁻¹
    folded = -solve(null[dependent].T, null[independent].T).T if dependent.size else np.zeros((rank, 0))
    real = (np.abs(folded) > tolerance) & ~determined[independent, None]
    combinations[:, dependent] = np.where(real, folded, 0.0)
    combination_variances = np.einsum("cp,pk,ck->c", combinations, covariance, combinations)

    return ParameterEstimate(
        names=names,
        values=np.where(determined, smallest / column_scale, np.nan),
        standard_deviations=np.where(determined, np.sqrt(np.diag(covariance)) / column_scale, np.nan),
        rank=rank,
        tolerance=tolerance,
        singular_values=sigma,
        condition_number=float(sigma[0] / sigma[rank - 1]) if rank else 1.0,
        combinations=combinations * column_scale / column_scale[independent, None],
        combination_values=combinations @ smallest / column_scale[independent],
        combination_standard_deviations=np.sqrt(np.maximum(combination_variances, 0.0)) / column_scale[independent],
        null_space=null / column_scale[:, None],
        residual=residual,
    )


def _covariance(inverse: Array, u: Array, residual: Array, groups: NDArray[np.int64]) -> Array:
    """Covariance of the scaled x (p, p): Σ over the groups of σ² P Pᵀ, P the group's columns of the pseudo-inverse."""
    covariance = np.zeros((len(inverse), len(inverse)))
    for group in np.unique(groups):
        rows = groups == group
        # equations of the group, less its share of the r parameters: the trace of its part of the hat matrix U Uᵀ
        spare = np.count_nonzero(rows) - np.sum(u[rows] ** 2)
        part = inverse @ u[rows].T
        if spare > MIN_ROWS_LEFT:
            covariance += np.sum(residual[rows] ** 2) / spare * (part @ part.T)
        else:  # its noise is unknown, and so is the variance of all that it bears on
            reached = np.linalg.norm(part, axis=1) > RANK_TOLERANCE * np.linalg.norm(part)
            covariance[reached] = covariance[:, reached] = np.nan
    return covariance
