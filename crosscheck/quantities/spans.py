"""Whether two regressors have the same column space over many states: base regressors of any basis do."""

from __future__ import annotations

import numpy as np

from crosscheck.quantities.measures import Chosen
from crosscheck.quantities.scaled_states import ScaledStates
from graphdyn.layout import Array

ZERO_DIRECTION_SHARE = 1e-10
"""Part of the largest singular value below which a direction of the column space is rounding."""

WEAK_COLUMN_SHARE = 0.1
"""Part of the largest entry of all columns below which a column counts as smaller, so that rounding in a column of
zeros does not count as a direction."""


def span_errors(answer: Array, reference: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Per state, the largest entry of either regressor that no combination of the other's columns gives (N,).

    answer (N, n, p), reference (N, n, m); their columns over all states are brought to largest entries of 1.
    """
    if not np.isfinite(answer).all():
        return np.where(np.isfinite(answer).all(axis=(1, 2)), 0.0, np.inf)
    outside = np.concatenate([outside_of(answer, reference), outside_of(reference, answer)], axis=-1)
    errors: Array = outside.max(axis=(1, 2), initial=0.0)
    return errors


def outside_of(x: Array, y: Array) -> Array:
    """What is left of each column of x (N, n, p), at largest entry 1, without its part in the column space of y."""
    basis = column_space(y)
    columns = _unit_columns(x)
    rest: Array = np.abs(columns - basis @ (basis.T @ columns))
    return rest.reshape(x.shape)


def column_space(x: Array) -> Array:
    """An orthonormal basis of the column space of a regressor over all states (N, n, p) → (N n, rank)."""
    u, sizes, _ = np.linalg.svd(_unit_columns(x), full_matrices=False)
    found: Array = u[:, sizes > ZERO_DIRECTION_SHARE * sizes.max(initial=0.0)]
    return found


def _unit_columns(x: Array) -> Array:
    """Columns over all states with largest entry 1 (N n, p); weak ones with less."""
    columns = x.reshape(-1, x.shape[-1])
    largest = np.abs(columns).max(axis=0, initial=0.0)
    whole = largest.max(initial=0.0)
    found: Array = columns / np.maximum(largest, WEAK_COLUMN_SHARE * whole if whole > 0 else 1.0)
    return found
