"""Decimation without aliasing, for any columns: torques, and the regressor with them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike

from graphdyn import InvalidInput
from graphdyn.layout import Array

LARGEST_FACTOR = 13
"""Largest factor of a stage: beyond it the anti-aliasing filter is ill-conditioned (see scipy.signal.decimate)."""

PADDING = 27
"""Rows by which scipy.signal.decimate extends the columns for its filter of order 8; a stage needs more rows."""


def decimated_columns(columns: ArrayLike, factors: Sequence[int]) -> Array:
    """Columns (N, …) of one uninterrupted block, decimated to (K, …): per stage, every f-th row from the first on.

    factors: f of each stage, 2 … 13: (10, 10) for a hundredth
    Before each stage scipy.signal.decimate's zero-phase low-pass: Chebyshev, order 8, 0.8 of the new Nyquist frequency.

    Raises InvalidInput for other factors and for too few rows.
    """
    from scipy.signal import sosfiltfilt

    _check(factors)
    values = np.asarray(columns, dtype=float)
    if len(values) < rows_needed(factors):
        raise InvalidInput(
            f"{len(values)} rows are too few to be decimated by {tuple(factors)}; give {rows_needed(factors)} or more"
        )
    for factor in factors:
        values = sosfiltfilt(_anti_aliasing(factor), values, axis=0)[::factor]
    return values


@cache
def _anti_aliasing(factor: int) -> Array:
    """Second-order sections of the filter of scipy.signal.decimate, designed once for all columns of a regressor."""
    from scipy.signal import cheby1

    return np.asarray(cheby1(8, 0.05, 0.8 / factor, output="sos"))


def slowest_pole(factor: int) -> float:
    """Largest modulus of the poles of the filter: from row to row its slowest mode decays by this factor."""
    from scipy.signal import sos2zpk

    return float(np.abs(sos2zpk(_anti_aliasing(factor))[1]).max())


def rows_needed(factors: Sequence[int]) -> int:
    """The fewest rows of a block that every stage can filter."""
    needed = PADDING + 1
    for factor in reversed(factors[:-1]):
        needed = (needed - 1) * factor + 1
    return needed


def _check(factors: Sequence[int]) -> None:
    if not factors or not all(isinstance(f, Integral) and 2 <= f <= LARGEST_FACTOR for f in factors):
        raise InvalidInput(
            f"decimation by {tuple(factors)}; give factors from 2 to {LARGEST_FACTOR}, larger ones in stages: (10, 10)"
        )
