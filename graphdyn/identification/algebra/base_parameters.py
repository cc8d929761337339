"""Base parameters: the combinations of inertial parameters that joint torques depend on.

Gautier, "Numerical calculation of the base inertial parameters of robots", Journal of Robotic Systems 8(4), 1991. The
rank comes from a column-pivoted QR factorization of the regressor over many states. The columns that represent the
combinations can be chosen freely. As in Gautier and Khalil, a parameter that depends on those before it is grouped with
them. Outer bodies are thus grouped with inner ones, and the coefficients are those of the geometry (1, d, d², cos,
sin).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.least_squares import triangle
from graphdyn.layout import Array

UNIT_COEFFICIENT_TOLERANCE = 1e-9
"""Relative difference from 1 below which a coefficient is 1: rounding leaves 1e-15, a rounded π/2 in a file 1e-10."""


def sum_in_words(coefficients: Array, names: Sequence[str], *, first: int | None = None) -> str:
    """A sum as text, such as "B1 I_yy + 0.25 B2 m": the term `first`, or those with coefficient 1, come first."""
    terms = sorted(np.flatnonzero(coefficients), key=lambda k: coefficients[k] != 1.0 if first is None else k != first)
    words = ""
    for k in map(int, terms):
        size = abs(coefficients[k])
        factor = "" if abs(size - 1.0) < UNIT_COEFFICIENT_TOLERANCE else f"{size:.4g} "
        sign = ("-" if coefficients[k] < 0 else "") if not words else (" - " if coefficients[k] < 0 else " + ")
        words += f"{sign}{factor}{names[k]}"
    return words


Indices = NDArray[np.int64]

MIN_COLUMN_SHARE = 1e-9
"""Length relative to the longest column below which a column counts as zero: angles such as π/2 rounded in a file leave
null columns at 1e-11, which scaling to unit length would turn into parameters."""

ZERO_COLUMN = 1e-14
"""Length relative to the longest column below which a column is structurally zero; a column between the two bounds is
zero up to the rounding of the robot's file."""

RANK_TOLERANCE = 1e-9
"""Smallest |R_kk| relative to |R_11| that counts as independent, with columns scaled to unit length: rounding
leaves 1e-15, the weakest true parameter of an arm under random motion 1e-4 or more."""

SPAN_DISTANCES = tuple(10.0**-k for k in range(1, 17))
"""Distances of a column from the span of those before it, at unit length, above which it represents a combination; the
largest one that leaves enough columns is taken, because nearly dependent columns make large coefficients."""


@dataclass(frozen=True, eq=False)
@short_repr
class BaseParameters:
    """The independent columns of W, and the grouping of the others with them.

    independent: columns of the base parameters             (b,)
    dependent: columns grouped with them                    (d,)
    regrouping: K with π_base = π[independent] + K π[dependent]   (b, d)
    gap: smallest accepted and largest rejected |R_kk| / |R_11|: the rank is clear if they are far apart
    structural_zeros: columns without any effect, zero or rounding
    numerical_zeros: columns that would have no effect if the robot's file were not rounded
    """

    independent: Indices
    dependent: Indices
    regrouping: Array
    gap: tuple[float, float]
    structural_zeros: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    numerical_zeros: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @property
    def rank(self) -> int:
        """b, the number of base parameters."""
        return len(self.independent)

    @property
    def matrix(self) -> Array:
        """B (b, p) with π_base = B π."""
        b = np.zeros((self.rank, self.rank + len(self.dependent)))
        b[np.arange(self.rank), self.independent] = 1.0
        b[:, self.dependent] = self.regrouping
        return b

    def values(self, parameters: ArrayLike) -> Array:
        """Values of the base parameters (b,) for standard parameters (p,)."""
        pi = np.asarray(parameters, dtype=float)
        values: Array = pi[self.independent] + self.regrouping @ pi[self.dependent]
        return values

    def names(self, names: Sequence[str]) -> tuple[str, ...]:
        """Every base parameter as a sum of standard parameters, such as "XX_2 - YY_2 + 0.18 M_3".

        Coefficients below RANK_TOLERANCE of the largest of their column are rounding and left out.
        """
        b = self._clean_matrix()
        return tuple(sum_in_words(row, names, first=int(k)) for k, row in zip(self.independent, b, strict=True))

    def symbols(self, symbols: Sequence[str]) -> tuple[str, ...]:
        """Every base parameter in Khalil's notation: XX_2, or XXR_2 if others are grouped with it.

        symbols: of the standard parameters (Khalil and Dombre, Modeling, Identification and Control of Robots, 2002,
            section 9.4.2)
        """
        alone = set(self.alone.tolist())
        found = []
        for k in self.independent.tolist():
            letters, underscore, number = symbols[k].partition("_")
            found.append(symbols[k] if k in alone else f"{letters}R{underscore}{number}")
        return tuple(found)

    @property
    def alone(self) -> Indices:
        """Columns that are determined individually: no other column is grouped with them."""
        b = self._clean_matrix()
        alone: NDArray[np.intp] = self.independent[np.count_nonzero(b, axis=1) == 1]
        return alone

    def _clean_matrix(self) -> Array:
        """B without rounding."""
        b = self.matrix
        b[np.abs(b) <= RANK_TOLERANCE * np.abs(b).max(axis=0, initial=0.0)] = 0.0
        return b

    def then(self, inner: BaseParameters) -> BaseParameters:
        """Base parameters of a recording, given those (inner) of its independent columns."""
        independent = self.independent[inner.independent]
        dependent = np.setdiff1d(np.arange(self.rank + len(self.dependent)), independent)
        matrix = inner.matrix @ self.matrix
        return BaseParameters(
            independent,
            dependent,
            matrix[:, dependent],
            inner.gap,
            np.union1d(self.structural_zeros, self.independent[inner.structural_zeros]),
            np.union1d(self.numerical_zeros, self.independent[inner.numerical_zeros]),
        )


def base_parameters(regressor: ArrayLike, *, tolerance: float = RANK_TOLERANCE) -> BaseParameters:
    """Independent columns of a stacked regressor W (rows, p), and the grouping of the rest.

    Over random states (at least as many rows as columns) they belong to the structure of the robot; over a recording,
    or its triangular factors, to that motion.
    tolerance: smallest |R_kk| / |R_11| that counts as independent
    Raises InvalidInput if W is not a matrix or not finite.
    """
    from scipy.linalg import qr, solve_triangular  # imported where first used: import graphdyn stays light

    w = as_floats("regressor", regressor)
    if w.ndim != 2 or w.size == 0 or not np.all(np.isfinite(w)):
        raise InvalidInput(f"regressor has shape {w.shape}; a finite matrix (rows, parameters) needed")
    length = np.linalg.norm(w, axis=0)
    kept = np.flatnonzero(length > MIN_COLUMN_SHARE * length.max())
    dropped = np.setdiff1d(np.arange(w.shape[1]), kept)
    by_structure = length[dropped] <= ZERO_COLUMN * length.max()
    zeros = dropped[by_structure], dropped[~by_structure]
    if kept.size == 0:
        return BaseParameters(kept, dropped, np.zeros((0, dropped.size)), (0.0, 0.0), *zeros)
    r, pivots = qr(w[:, kept] / length[kept], mode="r", pivoting=True)
    pivot_sizes = np.append(np.abs(np.diag(r)) / np.abs(r[0, 0]), 0.0)
    rank = int(np.count_nonzero(pivot_sizes > tolerance))
    unpivoted = np.empty_like(r)
    unpivoted[:, pivots] = r
    orders = (_in_order(unpivoted, max(distance, tolerance)) for distance in SPAN_DISTANCES)
    first = next((order for order in orders if len(order) == rank), np.sort(pivots[:rank]))
    rest = np.setdiff1d(np.arange(kept.size), first)
    ordered = triangle(unpivoted[:, np.concatenate([first, rest])])
    folded = solve_triangular(ordered[:rank, :rank], ordered[:rank, rank:])
    regrouping = folded * length[kept[rest]] / length[kept[first]][:, None]
    return BaseParameters(
        independent=kept[first],
        dependent=np.concatenate([kept[rest], dropped]),
        regrouping=np.hstack([regrouping, np.zeros((rank, dropped.size))]),
        gap=(float(pivot_sizes[rank - 1]), float(pivot_sizes[rank])),
        structural_zeros=zeros[0],
        numerical_zeros=zeros[1],
    )


def _in_order(columns: Array, tolerance: float) -> Indices:
    """Columns (unit length) whose distance from the span of those before them exceeds the tolerance."""
    basis = np.zeros((columns.shape[0], 0))
    chosen = []
    for k, column in enumerate(columns.T):
        rest = column - basis @ (basis.T @ column)
        rest -= basis @ (basis.T @ rest)  # once more: what is left may be small
        distance = np.linalg.norm(rest)
        if distance > tolerance:
            basis = np.column_stack([basis, rest / distance])
            chosen.append(k)
    return np.array(chosen, dtype=np.int64)
