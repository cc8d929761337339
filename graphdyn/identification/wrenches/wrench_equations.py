"""Equations of measured wrenches for the parameters of all bodies, and their solution, Eq. (53)-(64)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.algebra.rank_revealing import (
    EPS,
    PRECISION_MARGIN,
    ParameterEstimate,
    rank_revealing_least_squares,
)
from graphdyn.identification.wrenches.identified_bodies import IdentifiedBodies
from graphdyn.layout import Array

MAX_RANK_TOLERANCE = 1e-2
"""Largest estimated precision: a column with a hundredth of the length of the strongest counts as rounding only if the
caller gives that precision."""


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
