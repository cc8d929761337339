"""Equations of measured wrenches for the parameters of all bodies, and their solution, Eq. (53)-(64)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.compressed import EPS
from graphdyn.identification.algebra.rank_revealing import (
    PRECISION_MARGIN,
    ParameterEstimate,
    rank_revealing_least_squares,
)
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class IdentifiedBodies:
    """k parameters of each of n bodies.

    body_names (n,), parameter_names (k,)
    systems: the linear systems that were solved: one per body, or one for all of them
    residual: fitted minus measured wrenches of the m bodies or joints; force, then moment   (N, m, 6)  [N, N m]
    """

    body_names: tuple[str, ...]
    parameter_names: tuple[str, ...]
    systems: tuple[ParameterEstimate, ...]
    residual: Array

    @property
    def values(self) -> Array:
        """Values (n, k); NaN if the data do not determine the parameter individually."""
        return self._table([system.values for system in self.systems])

    @property
    def standard_deviations(self) -> Array:
        """Standard deviations of the values (n, k); NaN also if there are too few samples to estimate the noise."""
        return self._table([system.standard_deviations for system in self.systems])

    @property
    def determined(self) -> NDArray[np.bool_]:
        """Whether each parameter is determined individually (n, k)."""
        return np.isfinite(self.values)

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Names of the parameters that are not determined individually, such as "B1 J_22"."""
        return tuple(name for system in self.systems for name in system.undetermined)

    @property
    def combination_names(self) -> tuple[str, ...]:
        """The parameters and sums of parameters that the data determine, as text."""
        return tuple(name for system in self.systems for name in system.combination_names)

    @property
    def combination_values(self) -> Array:
        """Values of the determined combinations (rank,)."""
        return np.concatenate([system.combination_values for system in self.systems])

    @property
    def rank(self) -> int:
        """Number of parameters, or combinations of them, that the data determine."""
        return sum(system.rank for system in self.systems)

    @property
    def condition_number(self) -> float:
        """Largest condition number of the systems, over what they determine."""
        return max(system.condition_number for system in self.systems)

    def of(self, body: str) -> dict[str, float]:
        """The parameters of one body by name. Raises InvalidInput for an unknown body."""
        if body not in self.body_names:
            raise InvalidInput(f"there is no body '{body}'; known: {', '.join(self.body_names)}")
        row = self.values[self.body_names.index(body)]
        return {name: float(value) for name, value in zip(self.parameter_names, row, strict=True)}

    def _table(self, columns: Sequence[Array]) -> Array:
        return np.concatenate(columns).reshape(len(self.body_names), len(self.parameter_names))


MAX_RANK_TOLERANCE = 1e-2
"""Largest estimated precision: only a caller may take longer columns for rounding."""


@dataclass(frozen=True, eq=False)
class WrenchEquations:
    """K x = l before its solution: six equations per sample and measured wrench in the k parameters of n bodies.

    matrix (N, m, 6, n, k), right (N, m, 6)
    kinds: number of the kind of each of the k parameters: those of one kind share their unit and their scale   (k,)
    """

    body_names: tuple[str, ...]
    parameter_names: tuple[str, ...]
    kinds: tuple[int, ...]
    matrix: Array
    right: Array

    def solve_together(self, precision: float | None = None) -> IdentifiedBodies:
        """Solution of all bodies in one system, Eq. (61)-(63). By default the fit gives the precision of the data."""
        precision = self.seen_precision() if precision is None else precision
        return self._identified([self._solve(slice(None), slice(None), precision)])

    def solve_by_body(self, precision: float | None = None) -> IdentifiedBodies:
        """Solution with one system per body, Eq. (53)-(55), for wrenches i that depend on body i alone."""
        precision = self.seen_precision() if precision is None else precision
        bodies = range(len(self.body_names))
        return self._identified([self._solve(slice(i, i + 1), slice(i, i + 1), precision) for i in bodies])

    def seen_precision(self) -> float:
        """Relative rounding or noise of the data as estimated from the fit: residual over measured wrenches, at least
        EPS.

        If the parameters fit the samples without a residual, there is no estimate, and the precision has to be given.
        """
        residual = self._solve(slice(None), slice(None), EPS).residual
        measured = np.linalg.norm(self.right)
        seen = float(np.linalg.norm(residual) / measured) if measured > 0 else EPS
        return min(max(seen, EPS), MAX_RANK_TOLERANCE / PRECISION_MARGIN)

    @property
    def scale(self) -> Array:
        """Longest column of each kind among all bodies (n, k), the size that its columns can reach.

        A column that is only rounding then stays small; at unit length it would be mistaken for a parameter.
        """
        lengths = np.sqrt(np.einsum("smwik,smwik->ik", self.matrix, self.matrix))
        kinds = np.array(self.kinds)
        longest = np.array([lengths[:, kinds == kind].max() for kind in kinds])
        return np.broadcast_to(np.where(longest > 0, longest, 1.0), lengths.shape)

    def _solve(self, wrenches: slice, bodies: slice, precision: float) -> ParameterEstimate:
        matrix, right = self.matrix[:, wrenches, :, bodies], self.right[:, wrenches]
        n, k = matrix.shape[-2:]
        names = (f"{body} {parameter}" for body in self.body_names[bodies] for parameter in self.parameter_names)
        m = right.shape[1]
        groups = np.broadcast_to(2 * np.arange(m)[:, None] + np.repeat([0, 1], 3), right.shape)
        return rank_revealing_least_squares(
            matrix.reshape(-1, n * k),
            right.reshape(-1),
            tuple(names),
            column_scale=self.scale[bodies].reshape(-1),
            groups=groups.reshape(-1),
            precision=precision,
        )

    def _identified(self, systems: list[ParameterEstimate]) -> IdentifiedBodies:
        samples = len(self.right)
        residual = np.concatenate([system.residual.reshape(samples, -1, 6) for system in systems], axis=1)
        return IdentifiedBodies(self.body_names, self.parameter_names, tuple(systems), residual)
