"""Held-out errors of torque models, fold by fold, and the difference of two with its standard deviation.

The error is ‖e‖ / ‖τ‖ per joint over the rows in which it moves, or over all rows if these are too few, as a mean over
the joints. The standard deviation of a difference is that of the jackknife over the folds, paired: folds that are hard
to predict for both models cancel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.choosing.term_columns import TermColumns
from graphdyn.identification.statistics.residual_statistics import MIN_MOVING_SPEED
from graphdyn.layout import Array

MIN_MOVING_ROWS = 50
"""Smallest number of moving rows of a joint, of the recording; with fewer, its error is taken over all rows."""


class ErrorDifference(NamedTuple):
    """Error of one model minus that of another, and the standard deviation of this difference."""

    value: float
    deviation: float


@dataclass(frozen=True, eq=False)
class FoldErrors:
    """Squares of errors and of the measured torque, summed over each fold.

    errors: of predicted minus measured torque              (K, n)
    measured: of the measured torque, over the same rows    (K, n)
    """

    errors: Array
    measured: Array

    @classmethod
    def of(cls, columns: TermColumns, residuals: Array, tests: list[NDArray[np.bool_]]) -> FoldErrors:
        """Errors of residuals (N, n) that are those of the rows that each fold predicts, K of (N,)."""
        moves = np.abs(columns.velocity) > MIN_MOVING_SPEED
        enough = moves.sum(axis=0) * columns.every >= MIN_MOVING_ROWS
        counted = np.where(enough, moves, True)
        sums = [
            [np.sum(np.where(counted[test], values[test] ** 2, 0.0), axis=0) for test in tests]
            for values in (residuals, columns.measured)
        ]
        return cls(*map(np.array, sums))

    @property
    def mean(self) -> float:
        """Mean over the joints of the error of all folds together."""
        return float(_mean(self.errors.sum(axis=0), self.measured.sum(axis=0)))

    @property
    def joints(self) -> Array:
        """Error of every joint (n,)."""
        return _relative(self.errors.sum(axis=0), self.measured.sum(axis=0))

    def minus(self, other: FoldErrors) -> ErrorDifference:
        """The mean error minus that of another model on the same rows."""
        left = self._left_out() - other._left_out()
        folds = len(left)
        variance = (folds - 1) / folds * np.sum((left - left.mean()) ** 2)
        return ErrorDifference(self.mean - other.mean, float(np.sqrt(variance)))

    def _left_out(self) -> Array:
        """Mean error without each fold (K,)."""
        return _mean(self.errors.sum(axis=0) - self.errors, self.measured.sum(axis=0) - self.measured)


def _relative(errors: Array, measured: Array) -> Array:
    ratio = np.divide(errors, measured, out=np.full(errors.shape, np.nan), where=measured > 0)
    return np.asarray(np.sqrt(np.maximum(ratio, 0.0)))


def _mean(errors: Array, measured: Array) -> Array:
    """Mean over the joints of ‖e‖ / ‖τ‖ from their squares (…, n)."""
    return np.asarray(np.nanmean(_relative(errors, measured), axis=-1))
