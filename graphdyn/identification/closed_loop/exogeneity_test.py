"""Durbin-Wu-Hausman test: is the noise of the regressor also in the residual, so that least squares is biased?

For every joint g, with the simulated regressor Z_g as instruments:

    V_g = W_g - Z_g (Z_gᵀ Z_g)⁻¹ Z_gᵀ W_g                part of the measured regressor that no simulation explains
    τ_g = W_g x_g + V_g γ_g + e_g                       γ_g = 0 if W_g is exogenous

F = (‖e_g‖² of γ_g = 0 minus ‖e_g‖²) / r_g over ‖e_g‖² / (N - 2 r_g) is then F-distributed, for white e_g. After a
low-pass e_g is not white. The test therefore takes only every s-th row, where s is the lag at which the residual is no
longer correlated; a band-limited residual loses nothing by that.

Hausman, Econometrica 46(6), 1978; Janot, Vandanjon and Gautier, "A Durbin-Wu-Hausman test for industrial robots
identification", IEEE ICRA 2014.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.display import short_repr
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

MAX_AUTOCORRELATION = 0.1
"""Autocorrelation of the residual below which rows count as independent."""

MAX_EXAMINED_LAG = 200
"""Longest lag in the search for an uncorrelated residual [rows]."""

MIN_SINGULAR_SHARE = 1e-7
"""Singular value relative to the largest, of W_g and V_g at unit length, below which a direction is rounding."""

MIN_SPARE_ROWS = 20
"""Independent rows that the test needs in addition to the 2 r_g of the regression."""

EXOGENEITY_SETTING = "exogeneity p"
"""Name of the setting of a result that holds p of all joints together."""

MAX_ENDOGENOUS_P = 0.01
"""Significance level: p of all joints together below which least squares counts as biased."""


@dataclass(frozen=True, eq=False)
@short_repr
class Exogeneity:
    """Result of the test.

    p: per joint, the probability of so large an F for a regressor without noise; NaN with too few rows   (n,)
    rows: of the test, independent of each other            (n,)
    """

    p: Array
    rows: Array

    @property
    def together(self) -> float:
        """p of all tested joints: n times the smallest, at most 1 (Bonferroni); NaN if none was tested."""
        tested = self.p[np.isfinite(self.p)]
        return min(1.0, float(len(tested) * tested.min())) if len(tested) else float("nan")

    @property
    def biased(self) -> bool:
        """Whether least squares is biased: the regressor is not exogenous."""
        return self.together < MAX_ENDOGENOUS_P

    def in_words(self, joints: tuple[str, ...]) -> str:
        """The verdict as a sentence for the remarks of a result."""
        if not np.isfinite(self.together):
            return "exogeneity of the regressor: too few independent rows for a test"
        if not self.biased:
            return f"the regressor looks exogenous (Durbin-Wu-Hausman, p = {self.together:.2g}): least squares may do"
        guilty = [joint for joint, p in zip(joints, self.p, strict=True) if len(joints) * p < MAX_ENDOGENOUS_P]
        return (
            f"the regressor is not exogenous at {', '.join(guilty)} (Durbin-Wu-Hausman, p = {self.together:.2g}): "
            "least squares is biased"
        )


def exogeneity(loop: SimulatedLoop, x: Array, simulated: list[Samples]) -> Exogeneity:
    """Test of the measured equations of a problem.

    x: base parameters near the truth (r,), for the correlation of the residual; simulated: motions of the loop.
    """
    problem = loop.problem
    strides = _strides(problem, x)
    parts: list[list[tuple[Array, Array, Array]]] = [[] for _ in range(problem.n_joints)]
    position = 0
    for measured, exact in zip(problem.rows(), loop.as_measured(simulated).rows(), strict=True):
        w, z = problem.reduced(measured), problem.reduced(exact)
        numbers = np.arange(position, position + len(measured))
        position += len(numbers)
        for g, own in enumerate(problem.support):
            taken = measured.kept[:, g] & (numbers % strides[g] == 0)
            parts[g].append((w[taken, g][:, own], z[taken, g][:, own], measured.right[taken, g]))
    found = [_f_test(*(np.concatenate(column) for column in zip(*part, strict=True))) for part in parts]
    return Exogeneity(np.array([p for p, _ in found]), np.array([rows for _, rows in found]))


def _strides(problem: Problem, x: Array) -> list[int]:
    """First lag per joint at which the residual is not correlated."""
    residuals = []
    for rows in problem.rows():
        residual = problem.reduced(rows) @ x - rows.right
        residuals.append(np.where(rows.kept, residual, 0.0))
    e = np.concatenate(residuals)
    squares = np.sum(e**2, axis=0)
    longest = min(MAX_EXAMINED_LAG, len(e) - 1)
    lagged = np.array([np.sum(e[lag:] * e[: len(e) - lag], axis=0) for lag in range(1, longest + 1)])
    quiet = np.abs(lagged) < MAX_AUTOCORRELATION * squares
    return [1 + int(np.argmax(column)) if column.any() else longest for column in quiet.T]


def _f_test(w: Array, z: Array, right: Array) -> tuple[float, int]:
    """p and the number of rows; p is NaN with too few."""
    from scipy.stats import f  # imported where first used: import graphdyn stays light

    rows = len(right)
    regressor = orthonormal_basis(w, MIN_SINGULAR_SHARE)
    r = regressor.shape[1]
    if rows < 2 * r + MIN_SPARE_ROWS:
        return float("nan"), rows
    instruments = orthonormal_basis(z, MIN_SINGULAR_SHARE)
    unexplained = regressor - instruments @ (instruments.T @ regressor)
    both = orthonormal_basis(np.hstack([regressor, unexplained]), MIN_SINGULAR_SHARE)
    added = both.shape[1] - r
    if added <= 0:
        return 1.0, rows
    restricted, full = (np.sum((right - q @ (q.T @ right)) ** 2) for q in (regressor, both))
    spare = rows - both.shape[1]
    return float(f.sf((restricted - full) / added / (full / spare), added, spare)), rows
