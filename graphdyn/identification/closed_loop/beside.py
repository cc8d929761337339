"""Measured equations, with the simulated regressor and torque of every row."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from graphdyn.identification.data.rows import Rows
from graphdyn.identification.data.samples import Samples, TorqueFreeSamples, joined_samples
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

SIMULATED_ROWS_AT_ONCE = 4096
"""Rows whose simulated regressor is computed at once: enough for compiled code to pay off."""


@dataclass(frozen=True, eq=False)
class RowBlock:
    """Some rows of a recording.

    measured: its equations, filtered; matrix: their W in base parameters of the problem   (N, n, r)
    regressor: W of the simulated motion, in the same        (N, n, r)
    output: torque of the simulated motion, filtered like the measured one   (N, n)  [N m or N]

    The simulated regressor has no noise, and needs no filter: what a low-pass would remove from it has no counterpart
        in
    the filtered equations by which it is multiplied.
    """

    measured: Rows
    matrix: Array
    regressor: Array
    output: Array


def beside(problem: Problem, simulated: list[Samples]) -> Iterator[RowBlock]:
    """All equations of a problem, chunk by chunk, with the simulated stretches."""
    motion = _decimated(problem, simulated)
    position, first, window = 0, 0, np.empty((0, problem.n_joints, problem.base.rank))
    for rows in problem.rows():
        end = position + len(rows)
        if end > first + len(window):
            first = position
            ahead = TorqueFreeSamples(motion[first : max(end, first + SIMULATED_ROWS_AT_ONCE)])
            window = problem.torque_model.rows(ahead, problem.base.independent)
        yield RowBlock(rows, problem.reduced(rows), window[position - first : end - first], motion.tau[position:end])
        position = end


def _decimated(problem: Problem, stretches: list[Samples]) -> Samples:
    """The rows that count, in order: torques after the filter; of the other arrays, the rows that the filter keeps."""
    parts: list[Samples] = []
    for samples in stretches:
        left = samples[:: 1 if samples.row_filter is None else samples.row_filter.factor]
        tau = samples.tau if samples.row_filter is None else samples.row_filter(samples.tau)
        parts.append(replace(left, tau=tau))
    return joined_samples(parts, problem.chosen(np.arange(sum(map(len, parts)))))
