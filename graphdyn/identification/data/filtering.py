"""Parallel filtering: a linear filter along time on the torque and on every column of the regressor.

For any linear F, τ = W x implies F τ = (F W) x. No filter therefore biases x, whatever it does to sign(v). A torque
that is filtered alone lacks components that its regressor still has: friction is then wrong by percents. Gautier,
"Dynamic identification of robots with power model", IEEE ICRA 1997.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.rows import Rows
from graphdyn.identification.data.samples import RowFilter, filtered_length
from graphdyn.layout import Array

MIN_FILTERED_ROWS = 4096
"""Smallest number of rows that are filtered at once, without the rows around them."""


def filtered(
    chunks: Iterable[Rows], row_filter: RowFilter, support: NDArray[np.bool_], min_speed: ArrayLike
) -> Iterator[Rows]:
    """The equations of one uninterrupted run, filtered, in windows that overlap by the memory of the filter.

    support: where W can differ from zero (n, b); the filtered velocity decides which equations count
    """
    n, b = support.shape
    width = int(support.sum())
    factor = row_filter.factor
    margin = -(-row_filter.memory // factor) * factor
    window = max(MIN_FILTERED_ROWS, 2 * margin)
    waiting, before, first = np.empty((0, width + 3 * n)), 0, True
    parts: list[Array] = []

    def rows_of(columns: Array) -> Rows:
        matrix = np.zeros((len(columns), n, b))
        matrix[:, support] = columns[:, :width]
        right, measured, velocity = np.split(columns[:, width:], 3, axis=1)
        return Rows(matrix, right, measured, velocity, np.abs(velocity) >= min_speed, first=first)

    for chunk in chunks:
        parts.append(np.hstack([chunk.matrix[:, support], chunk.right, chunk.measured, chunk.velocity]))
        if len(waiting) + sum(map(len, parts)) >= before + window + margin:
            waiting = np.concatenate([waiting, *parts])
            done = (len(waiting) - margin) // factor * factor
            yield rows_of(_applied(row_filter, waiting)[before // factor : done // factor])
            waiting, before, first, parts = waiting[done - margin :], margin, False, []
    waiting = np.concatenate([waiting, *parts])
    if len(waiting):
        yield rows_of(_applied(row_filter, waiting)[before // factor :])


def _applied(row_filter: RowFilter, columns: Array) -> Array:
    answer = np.asarray(row_filter(columns), dtype=float)
    expected = (filtered_length(len(columns), row_filter), columns.shape[1])
    if answer.shape != expected:
        raise InvalidInput(f"the row filter answers shape {answer.shape} for {columns.shape}, expected {expected}")
    return answer
