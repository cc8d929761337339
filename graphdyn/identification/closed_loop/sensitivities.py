"""Sensitivities of the simulated loop's outputs to the parameters: central differences of whole simulations.

Each parameter takes two simulations; as many run at once as there are lanes and cores. The step changes the torque by
RELATIVE_PARAMETER_STEP of itself. The error of the differences, the step squared from their curvature and 1e-13 over
the step from rounding, is about 1e-8. The changes go through the same low-pass as the measured output.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.closed_loop.equations import RowBlock
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.prior import model_prior
from graphdyn.layout import Array

OutputName = Literal["position", "torque"]

RELATIVE_PARAMETER_STEP = 1e-4
"""Relative change of the torque by the change of one parameter."""

SIMULATIONS_IN_MEMORY = 16
"""Largest number of simulations whose motions are in memory at once."""

MAX_SENSITIVITY_BYTES = 2e9
"""Largest size of all sensitivities in memory [bytes]."""


def outputs(loop: SimulatedLoop, x: Array, simulated: list[Samples], name: OutputName) -> Iterator[RowBlock]:
    """Measured and simulated outputs, with the sensitivities of the latter as the regressor.

    x: base parameters (r,) of the simulated motions. Raises EstimationFailed if the result does not fit in memory.
    """
    problem = loop.problem
    sensitivity = sensitivities(loop, x, name)
    modeled = problem.chosen(np.concatenate([_output(loop, samples, name) for samples in simulated]))
    measured = problem.chosen(loop.measured_positions()) if name == "position" else None
    position = 0
    for rows in problem.rows():
        here = slice(position, position + len(rows))
        position = here.stop
        seen = rows if measured is None else replace(rows, measured=measured[here])
        yield RowBlock(seen, problem.reduced(rows), sensitivity[here], modeled[here])


def sensitivities(loop: SimulatedLoop, x: Array, name: OutputName) -> Array:
    """Sensitivities (N, n, r) for the rows of the problem."""
    problem = loop.problem
    equations, prior = problem.equations, model_prior(problem.torque_model)
    length = np.linalg.norm(equations.factors[..., :-1], axis=(0, 1))
    steps = RELATIVE_PARAMETER_STEP * np.sqrt(equations.measured_squares.sum()) / length
    count, n, r = len(loop.measured_positions()), problem.n_joints, len(x)
    if 8.0 * count * n * r > MAX_SENSITIVITY_BYTES:
        raise EstimationFailed(
            f"the sensitivities of {count} rows take {8e-9 * count * n * r:.1f} GB; decimate the recording"
        )
    found = np.empty((count, n, r))
    for first in range(0, r, SIMULATIONS_IN_MEMORY // 2):
        chosen = np.arange(first, min(first + SIMULATIONS_IN_MEMORY // 2, r))
        there = np.array([x + sign * steps[k] * np.eye(r)[k] for k in chosen for sign in (1, -1)])
        position = 0
        for stretch in loop.runs(np.array([prior.nearest(problem.base, one) for one in there])):
            pairs = zip(stretch[::2], stretch[1::2], strict=True)
            changes = [_output(loop, up, name) - _output(loop, down, name) for up, down in pairs]
            columns = np.stack(changes, axis=-1) / (2 * steps[chosen])
            found[position : position + len(columns), :, chosen] = columns
            position += len(columns)
    return problem.chosen(found)


def _output(loop: SimulatedLoop, samples: Samples, name: OutputName) -> Array:
    """Output of one stretch, as measured, in the rows that the filter keeps (N, n)."""
    row_filter = samples.row_filter
    if name == "torque":
        return samples.tau if row_filter is None else row_filter(samples.tau)
    return loop.loop.seen(samples).q[:: 1 if row_filter is None else row_filter.factor]
