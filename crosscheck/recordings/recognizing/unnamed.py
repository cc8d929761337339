"""Blocks of columns whose names tell nothing: positions and their rates by how they move, torques among the rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings.recognizing.blocks import ColumnBlock
from crosscheck.recordings.recognizing.limits import units_within
from crosscheck.recordings.recognizing.recognized import RecognizedClock
from crosscheck.recordings.recognizing.together import CLEAR_FACTOR, rates, runs, sequences
from crosscheck.recordings.recognizing.work import LogWork, column_of, columns_shown
from graphdyn.layout import Array


def unnamed_blocks(work: LogWork, named: Sequence[ColumnBlock], clocks: Sequence[RecognizedClock]) -> list[ColumnBlock]:
    """Positions, velocities, accelerations and what may be torques, in columns whose names tell nothing."""
    n = len(work.model.independent_joints)
    found: list[ColumnBlock] = [block for block in named if block.quantity]
    for index, table in enumerate(work.tables):
        used = {k for block in found if block.table == index for k in block.numbers}
        times = {column for clock in clocks for column in clock.columns}
        free = [k for k in range(len(table.names)) if k not in used and column_of(table, k) not in times]
        values = np.nan_to_num(table.values[:, free])
        still = np.ptp(values, axis=0) == 0 if len(values) else np.ones(len(free), dtype=bool)
        links = rates(values)
        np.fill_diagonal(links, 0)
        chains = [
            pair for pair in sequences(links, n, still)
            if 2 * np.count_nonzero(links[list(pair[0]), list(pair[1])]) >= n
        ]  # fmt: skip
        slopes = {slope for _, slope in chains}
        roots = _of_no_rates([pair for pair in chains if pair[0] not in slopes], links)
        taken: set[int] = set()
        for columns, slope in roots:
            found += [_unnamed(work, index, columns, free, "q"), _unnamed(work, index, slope, free, "v")]
            taken |= {*columns, *slope}
            for begin, end in chains:
                if begin == slope:
                    found.append(_unnamed(work, index, end, free, "a"))
                    taken |= set(end)
        left = [k for k in range(len(free)) if k not in taken and not still[k]]
        stride = roots[0][0][1] - roots[0][0][0] if roots and n > 1 else 1
        left.sort(key=lambda k: (k % stride, k) if stride > 1 else (0, k))
        groups = runs(left, n)
        if not roots and len(work.tables) == 1:
            found += _without_rates(work, index, groups, free)
        else:
            found += [_unnamed(work, index, group, free, "unnamed") for group in groups]
    return found


Chain = tuple[tuple[int, ...], tuple[int, ...]]
"""Columns, and those that are their rates."""


def _of_no_rates(roots: list[Chain], links: Array) -> list[Chain]:
    """The chains whose first columns are rates of no column; all if there are none.

    Where a file has accelerations too, positions 2 … 6 with the first velocity are such a sequence as well.
    """
    rates_of_some = set(np.nonzero(links > 0)[1].tolist())
    kept = [pair for pair in roots if not rates_of_some & set(pair[0])]
    return kept or roots


def _without_rates(
    work: LogWork, index: int, groups: Sequence[tuple[int, ...]], free: Sequence[int]
) -> list[ColumnBlock]:
    """Positions and torques of which no column is the rate of another: positions are within the limits."""
    values = work.tables[index].values
    within = [group for group in groups if units_within(work, values[:, [free[k] for k in group]])]
    smooth = sorted(groups, key=lambda group: _roughness(values[:, [free[k] for k in group]]))
    if len(groups) == 2 and smooth[0] in within:
        a, b = (_roughness(values[:, [free[k] for k in group]]) for group in smooth)
        if len(within) == 1 or b > CLEAR_FACTOR * a:
            position, torque = smooth
            return [_unnamed(work, index, position, free, "q"), _unnamed(work, index, torque, free, "unnamed")]
    return [_unnamed(work, index, group, free, "unnamed") for group in groups]


def _unnamed(work: LogWork, index: int, group: Sequence[int], free: Sequence[int], quantity: str) -> ColumnBlock:
    numbers = tuple(free[k] for k in group)
    return ColumnBlock(index, numbers, columns_shown(work.tables[index], numbers), quantity)


def _roughness(values: Array) -> float:
    """How much the columns (N, n) change from row to row, as a part of their variation: positions are smooth."""
    size = np.ptp(values, axis=0)
    moving = size > 0
    if not moving.any() or len(values) < 3:
        return np.inf
    return float(np.median(np.std(np.diff(values[:, moving], 2, axis=0), axis=0) / size[moving]))
