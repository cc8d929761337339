"""Torque per unit of current, per joint, with the covariance of its logarithm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class JointGains:
    """Gains of the joints: torque is gain times recorded current.

    values: above zero; NaN where nothing determines a gain    (n,)   [N m or N per unit of the current]
    covariance: of their logarithms, thus of relative errors; infinite variance where nothing determines one   (n, n)

    Raises InvalidInput for gains that are not above zero, and for a covariance of another shape or with negative
    variances.
    """

    values: Array
    covariance: Array

    def __post_init__(self) -> None:
        known = self.values[~np.isnan(self.values)]
        if self.values.ndim != 1 or not np.all((known > 0) & np.isfinite(known)):
            raise InvalidInput(f"the gains are {self.values}; give one above zero per joint")
        variances = np.diagonal(self.covariance)
        n = len(self.values)
        if self.covariance.shape != (n, n) or not np.all(variances >= 0):
            raise InvalidInput(
                f"the covariance of {n} gains has shape {self.covariance.shape}; ({n}, {n}) with variances of at least "
                "zero needed"
            )

    @classmethod
    def stated(cls, values: ArrayLike, relative: ArrayLike) -> JointGains:
        """Gains with independent relative standard deviations, one for all or (n,), such as those of a data sheet."""
        numbers = as_floats("gains", values)
        return cls(numbers, np.diag(np.broadcast_to(as_floats("deviations of gains", relative), numbers.shape) ** 2))

    @property
    def relative_deviations(self) -> Array:
        """Standard deviations relative to the gains (n,)."""
        found: Array = np.sqrt(np.diagonal(self.covariance))
        return found

    @property
    def deviations(self) -> Array:
        """Standard deviations (n,), in units of the gains."""
        return self.values * self.relative_deviations

    @property
    def determined(self) -> NDArray[np.bool_]:
        """Whether each gain is determined (n,)."""
        found: NDArray[np.bool_] = np.isfinite(self.values) & np.isfinite(self.relative_deviations)
        return found
