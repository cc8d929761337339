"""Simulated motions of a recording with estimated parameters: motions without noise.

The loop makes the robot follow its reference with almost any parameters. Simulated and measured motions therefore stay
close, and the simulated one contains none of the measured noise. Each uninterrupted stretch is simulated with its
controller from the first measured state on.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.closed_loop.loop import ClosedLoop, DrivenRobot, held_torque
from graphdyn.identification.data.rows import runs
from graphdyn.identification.data.samples import Samples, joined_samples
from graphdyn.identification.problem.problem import Problem, pieces_of
from graphdyn.layout import Array
from graphdyn.motion_laws import Course, MotionLaw
from graphdyn.simulation import ComputedTorqueControl, PDControl, Rollout, rollout

PERIOD_TOLERANCE = 1e-3
"""Largest relative deviation of a time step from the mean one: clocks of recordings are rounded to microseconds."""

QUOTIENT_TOLERANCE = 1e-9
"""Tolerance by which a quotient may exceed a whole number and still counts as one: rounding."""

CLOCK_TOLERANCE = 1e-3
"""Tolerance of the quotient from a whole number if a step divides a time: sampling rates have five or six digits."""


Runs = tuple[Array, Array, Array, Array]
"""q, v, a and actuator torques of R robots (R, N, n) each."""


class Segment:
    """Uninterrupted pieces of a recording."""

    def __init__(self, problem: Problem, loop: ClosedLoop, pieces: Sequence[Samples]) -> None:
        self._model, self._loop, self._pieces = problem.torque_model.model, loop, pieces
        first = pieces[0]
        if any(piece.time is None for piece in pieces):
            raise EstimationFailed("needs the time of every sample (Samples.time), to know where the reference is")
        if any(piece.base is not None for piece in pieces):
            raise EstimationFailed("the base of the recording moves; a simulated loop knows a base at rest only")
        time = np.concatenate([np.asarray(piece.time, dtype=float) for piece in pieces])
        if len(time) < 2:
            raise EstimationFailed("a stretch of the recording has one sample; two are needed to simulate it")
        self._start, self.period = float(time[0]), float(time[-1] - time[0]) / (len(time) - 1)
        if np.abs(np.diff(time) - self.period).max() > PERIOD_TOLERANCE * self.period:
            raise EstimationFailed("the samples are not evenly spaced in time; resample the recording")
        self._q, self._v = np.array(first.q[0], dtype=float), np.array(first.v[0], dtype=float)
        self._temperature = joined_samples(pieces, slice(None)).temperature

    def samples(self, robots: DrivenRobot) -> list[Samples]:
        """The exact motion of each robot. Raises EstimationFailed if it diverges."""
        motions = self._motions(robots, self._every)
        row_filter, hold = self._pieces[0].row_filter, self._loop.torque_hold
        time = np.asarray(self._start + np.arange(self.n_rows) * self.period, dtype=float)
        return [
            Samples(
                q,
                v,
                a,
                held_torque(tau, self.period, hold),
                row_filter=row_filter,
                time=time,
                temperature=self._temperature,
            )
            for q, v, a, tau in zip(*motions, strict=True)
        ]

    def fine_samples(self, robots: DrivenRobot) -> Samples:
        """The exact motion of the first robot, steps_per_sample rows for each sample, torques as commanded."""
        q, v, a, tau = (array[0] for array in self._motions(robots, self._every // self.steps_per_sample))
        return Samples(q, v, a, tau, time=np.asarray(self._start + np.arange(len(q)) * self.fine_step, dtype=float))

    def _motions(self, robots: DrivenRobot, every: int) -> Runs:
        """The motions at every every-th step. Raises EstimationFailed if one diverges."""
        motions = self._in_python(robots, every) if self._loop.is_function else self._compiled(robots, every)
        if not all(np.all(np.isfinite(array)) for array in motions):
            raise EstimationFailed("the simulated loop does not hold the robot with these parameters: it runs away")
        return motions

    @cached_property
    def steps_per_sample(self) -> int:
        """Fewest parts of a sampling period, of whole steps of the simulation, that are no longer than its longest."""
        longest = self._loop.step * (1 + QUOTIENT_TOLERANCE)
        counts = (count for count in range(1, self._every + 1) if self._every % count == 0)
        return next(count for count in counts if self.period / count <= longest or count == self._every)

    @property
    def fine_step(self) -> float:
        """[s]"""
        return self.period / self.steps_per_sample

    @property
    def commanded_rows(self) -> NDArray[np.int64]:
        """The row of each sample at which its torque was commanded."""
        held = max(1, round((self._loop.control_period or 0.0) / self.period))
        rows = np.arange(self.n_rows)
        return rows - rows % held

    def positions(self) -> Array:
        """Measured positions (N, n), in the rows that the filter keeps."""
        q = np.concatenate([np.asarray(piece.q, dtype=float) for piece in self._pieces])
        row_filter = self._pieces[0].row_filter
        return q if row_filter is None else q[:: row_filter.factor]

    def as_measured(self, exact: Samples) -> Iterator[Samples]:
        """An exact motion with q, v and a computed as from measurements, in the pieces of the recording."""
        seen, first = self._loop.seen(exact), 0
        for piece in self._pieces:
            yield replace(seen[first : first + len(piece)], continues=piece.continues)
            first += len(piece)

    @property
    def n_rows(self) -> int:
        """Number of samples."""
        return sum(map(len, self._pieces))

    @cached_property
    def _every(self) -> int:
        """Steps per sample, which divide the shortest of sample, control period and longest step."""
        period = self._loop.control_period or self.period
        shortest = min(period, self.period)
        step = shortest / np.ceil(shortest / self._loop.step - QUOTIENT_TOLERANCE)
        every = round(float(self.period / step))
        if any(abs(span / step - round(float(span / step))) > CLOCK_TOLERANCE for span in (self.period, period)):
            raise InvalidInput(
                f"the period of the controller, {period:g} s, and that of the recording, {self.period:g} s, are no "
                "multiples of each other; resample the recording"
            )
        return every

    @property
    def _step(self) -> float:
        return self.period / self._every

    @cached_property
    def _controller(self) -> PDControl | ComputedTorqueControl:
        """The controller with its target over the time since the start, and its period in whole steps."""
        controller: Any = self._loop.controller
        period, target = controller.period, controller.target
        if isinstance(target, Sequence) and any(callable(law) for law in target):
            target = [_Later(law, self._start) if callable(law) else law for law in target]
        held = None if period is None else round(period / self._step) * self._step
        known: PDControl | ComputedTorqueControl = replace(controller, target=target, period=held)
        return known

    def _compiled(self, robots: DrivenRobot, every: int) -> Runs:
        found = self._rollout(
            robots,
            np.broadcast_to(self._q, robots.rotors.shape),
            self._v,
            self._controller,
            duration=(self.n_rows - 1) * self.period,
            every=every,
        )
        return found.q, found.v, found.a, found.tau

    def _in_python(self, robots: DrivenRobot, every: int) -> Runs:
        """The motions with a controller that is a function, called once per period, for one robot after the other."""
        law: Any = self._loop.controller
        held = max(1, round((self._loop.period or 0.0) / self._step))
        steps = (self.n_rows - 1) * self._every
        q, v = (np.broadcast_to(start, robots.rotors.shape) for start in (self._q, self._v))
        rows: list[tuple[Array, ...]] = []
        for first in range(0, steps + 1, held):
            t = self._start + first * self._step
            tau = np.array([as_floats("what the controller answers", law(t, q[k], v[k])) for k in range(len(q))])
            found = self._rollout(robots, q, v, tau[:, None], period=held * self._step)
            for step in range(min(held, steps + 1 - first)):
                if (first + step) % every == 0:
                    rows.append(tuple(array[:, step] for array in (found.q, found.v, found.a, found.tau)))
            q, v = found.q[:, -1], found.v[:, -1]
        q, v, a, tau = (np.stack(columns, axis=1) for columns in zip(*rows, strict=True))
        return q, v, a, tau

    def _rollout(self, robots: DrivenRobot, q: Array, v: Array, controls: Any, **span: Any) -> Rollout:
        return rollout(
            self._model,
            q,
            v,
            controls,
            step=self._step,
            parameters=robots.bodies,
            friction=robots.friction,
            rotor_inertia=robots.rotors,
            **span,
        )


class _Later:
    """A motion law over the time since a start. It keeps its courses: every iteration asks for the same times."""

    def __init__(self, law: MotionLaw, start: float) -> None:
        self._law, self._start = law, start
        self._courses: dict[bytes, Course] = {}

    def __call__(self, times: Array, /) -> Course:
        key = np.asarray(times, dtype=float).tobytes()
        if key not in self._courses:
            self._courses[key] = self._law(times + self._start)
        return self._courses[key]


NEEDS_CONTROLLER = (
    "needs the controller of the loop in which the recording was made, with its reference (loop=ClosedLoop(…))"
)


class SimulatedLoop:
    """The stretches of a problem's recording, to be simulated with any parameters.

    simulations: number of simulations of the whole recording so far; segments: its uninterrupted stretches

    Raises EstimationFailed without a loop, without times, for a moving base, for uneven times, and for friction with
    memory.
    """

    def __init__(self, problem: Problem, loop: ClosedLoop | None) -> None:
        if loop is None:
            raise EstimationFailed(NEEDS_CONTROLLER)
        if problem.torque_model.has_memory:
            raise EstimationFailed("the simulated loop knows no friction with memory; leave it out")
        self.problem, self.loop, self.simulations = problem, loop, 0
        self.segments = [Segment(problem, loop, list(run.samples)) for run in runs(pieces_of(problem.data))]

    def samples(self, parameters: Array) -> list[Samples]:
        """The motions with parameters x (p,), row for row those of the recording.

        Raises EstimationFailed if the loop does not hold the robot.
        """
        return [motions[0] for motions in self.runs(parameters[None])]

    def runs(self, parameters: Array) -> Iterator[list[Samples]]:
        """The motions with R rows of parameters (R, p), segment by segment.

        Raises EstimationFailed if the loop does not hold the robot.
        """
        self.simulations += len(parameters)
        robots = self._robots(parameters)
        for stretch in self.segments:
            yield stretch.samples(robots)

    def fine_runs(self, parameters: Array) -> Iterator[tuple[Segment, Samples, DrivenRobot]]:
        """Segment by segment, the motion with parameters x (p,) in small steps, and the robot. Raises as runs."""
        self.simulations += 1
        robots = self._robots(parameters[None])
        for segment in self.segments:
            yield segment, segment.fine_samples(robots), robots

    def as_measured(self, exact: list[Samples]) -> Problem:
        """The problem with simulated motions in place of the measured ones: the same equations, without noise."""
        pieces = [
            piece
            for stretch, samples in zip(self.segments, exact, strict=True)
            for piece in stretch.as_measured(samples)
        ]
        return replace(self.problem, data=pieces, progress=None)

    def measured_positions(self) -> Array:
        """Measured positions (N, n) in the rows that the filter keeps."""
        return np.concatenate([stretch.positions() for stretch in self.segments])

    def _robots(self, parameters: Array) -> DrivenRobot:
        """The driven robots of base parameters alone, so that the result does not depend on other parameters."""
        base = self.problem.structure.base
        alone = np.zeros_like(parameters)
        alone[:, base.independent] = [base.values(x) for x in parameters]
        return DrivenRobot.of(self.problem.torque_model, alone)
