"""The common result of the identifications from wrenches: parameters of each body, and their standard deviations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.rank_revealing import ParameterEstimate
from graphdyn.layout import ANGULAR, LINEAR, Array


@dataclass(frozen=True, eq=False)
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

    @property
    def force_residual_rms(self) -> float:
        """Root mean square of the force residuals [N]."""
        return float(np.sqrt(np.mean(self.residual[..., LINEAR] ** 2)))

    @property
    def moment_residual_rms(self) -> float:
        """Root mean square of the moment residuals [N m]."""
        return float(np.sqrt(np.mean(self.residual[..., ANGULAR] ** 2)))

    def of(self, body: str) -> dict[str, float]:
        """The parameters of one body by name. Raises InvalidInput for an unknown body."""
        if body not in self.body_names:
            raise InvalidInput(f"there is no body '{body}'; known: {', '.join(self.body_names)}")
        row = self.values[self.body_names.index(body)]
        return {name: float(value) for name, value in zip(self.parameter_names, row, strict=True)}

    def _table(self, columns: Sequence[Array]) -> Array:
        return np.concatenate(columns).reshape(len(self.body_names), len(self.parameter_names))
