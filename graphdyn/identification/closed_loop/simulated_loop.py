"""Simulated motions of a recording with estimated parameters: motions without noise.

The loop makes the robot follow its reference with almost any parameters. Simulated and measured motions therefore stay
close, and the simulated one contains none of the measured noise.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.closed_loop.loop import ClosedLoop, DrivenRobot
from graphdyn.identification.closed_loop.stretch import Segment
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

NEEDS_CONTROLLER = (
    "needs the controller of the loop in which the recording was made, with its reference (loop=ClosedLoop(…))"
)


class SimulatedLoop:
    """The stretches of a problem's recording, to be simulated with any parameters.

    simulations: number of simulations of the whole recording so far

    Raises EstimationFailed without a loop, without times, for a moving base, for uneven times, and for friction with
    memory.
    """

    def __init__(self, problem: Problem, loop: ClosedLoop | None) -> None:
        if loop is None:
            raise EstimationFailed(NEEDS_CONTROLLER)
        if problem.torque_model.has_memory:
            raise EstimationFailed("the simulated loop knows no friction with memory; leave it out")
        self.problem, self.loop, self.simulations = problem, loop, 0
        pieces = [problem.data] if isinstance(problem.data, Samples) else list(problem.data)
        self._stretches = [Segment(problem, loop, stretch) for stretch in _uninterrupted(pieces)]

    def samples(self, parameters: Array) -> list[Samples]:
        """The motions with parameters x (p,), row for row those of the recording.

        Raises EstimationFailed if the loop does not hold the robot.
        """
        return [runs[0] for runs in self.runs(parameters[None])]

    def runs(self, parameters: Array) -> Iterator[list[Samples]]:
        """The motions with R rows of parameters (R, p), segment by segment.

        Raises EstimationFailed if the loop does not hold the robot.
        """
        self.simulations += len(parameters)
        robots = self._robots(parameters)
        for stretch in self._stretches:
            yield stretch.samples(robots)

    def as_measured(self, exact: list[Samples]) -> Problem:
        """The problem with simulated motions in place of the measured ones: the same equations, without noise."""
        pieces = [
            piece
            for stretch, samples in zip(self._stretches, exact, strict=True)
            for piece in stretch.as_measured(samples)
        ]
        return replace(self.problem, data=pieces, progress=None)

    def measured_positions(self) -> Array:
        """Measured positions (N, n) in the rows that the filter keeps."""
        return np.concatenate([stretch.positions() for stretch in self._stretches])

    def _robots(self, parameters: Array) -> DrivenRobot:
        """The driven robots of base parameters alone, so that the result does not depend on other parameters."""
        base = self.problem.structure.base
        alone = np.zeros_like(parameters)
        alone[:, base.independent] = [base.values(x) for x in parameters]
        return DrivenRobot.of(self.problem.torque_model, alone)


def _uninterrupted(pieces: Sequence[Samples]) -> list[list[Samples]]:
    """Groups of pieces that continue each other."""
    stretches: list[list[Samples]] = []
    for piece in pieces:
        if piece.continues and stretches:
            stretches[-1].append(piece)
        else:
            stretches.append([piece])
    return stretches
