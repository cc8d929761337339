"""Robots with loops, in steps that adapt to a tolerance: DOP853, each step closed before the next begins.

Error and width of the steps as in Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section II.10,
and in scipy.integrate. Near a singular pose rounding errors are divided by small numbers, which smaller steps make
worse: there steps do not become narrower than a part of those before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.errors import IntegrationFailed
from graphdyn.layout import Array
from graphdyn.simulation.equations import LoopEquations
from graphdyn.simulation.integration.compiled import can_compile, single_steps
from graphdyn.simulation.integration.crossings import Pieces, crossings
from graphdyn.simulation.integration.events import InitialValueProblem, Occurrence, Rows, SimulatedCourse, watches
from graphdyn.simulation.integration.pace import Pace
from graphdyn.simulation.integration.sketches import RowSteps
from graphdyn.simulation.integration.steps import Held, LoopSteps, Stepped, Torque, joints_of, tableau

STEP_SAFETY, MIN_STEP_RATIO, MAX_STEP_RATIO, ERROR_ORDER = 0.9, 0.2, 10.0, 8
"""Constants of the choice of the next width, as in scipy.integrate."""

MIN_STEP_NEAR_POSE = 1 / 8
"""Smallest width of a step near a singular pose, relative to the last one far from it."""

MIN_STEP_WIDTH_SHARE = 1e-14
"""Smallest width of a step, as a part of the duration: narrower ones would be lost in the rounding of the time."""

PYTHON_STEPS = 100
"""Steps before compiled ones: these in Python, of one to three milliseconds, take as long as compiling."""

FIRST_STEP_SHARE = 1e-3
"""Width of the first step that is tried, as a part of the duration."""


def loop_adaptive(problem: InitialValueProblem, rtol: float, atol: float) -> SimulatedCourse:
    """Integrate like adaptive.adaptive; steps end at the times asked for. Raises IntegrationFailed."""
    run, at, duration, checked = _LoopRun(problem, rtol, atol), problem.at, problem.duration, watches(problem)
    rows, times, occurrences, ended = list[Rows](), list[float](), list[Occurrence](), ""
    targets = np.append(duration if at is None else at[at > 0], duration)
    if at is None or at[0] == 0:
        times, rows = [0.0], [run.row()]
    while run.t < duration and not ended:
        step = run.advance(float(targets[np.searchsorted(targets, run.t, side="right")]))
        for crossing in crossings(checked, step.pieces(problem)) if checked else ():
            y = step.state(crossing.time)
            occurrences.append(Occurrence(crossing.watch.name, crossing.time, *joints_of(y)))
            if crossing.watch.stop:
                run.end_at(crossing.time, y, step)
                ended = crossing.watch.name
        if (ended or at is None or run.t in at) and run.t not in times[-1:]:
            times, rows = [*times, run.t], [*rows, run.row()]
        problem.progress(run.t)
    return SimulatedCourse.of_rows(times, rows, occurrences, ended)


@dataclass(frozen=True, eq=False)
class _LoopStep:
    """A step from t and y to end and last, under the torque of it."""

    steps: LoopSteps
    tau: Torque
    t: float
    y: Array
    end: float
    last: Array

    def state(self, time: float) -> Array:
        """The state as far as this time in the same step."""
        if time in (self.t, self.end):
            return self.y if time == self.t else self.last
        return self.steps.advanced(self.t, self.y, time - self.t, self.tau).y

    def pieces(self, problem: InitialValueProblem) -> Pieces:
        edges = np.array([self.t, self.end])
        q, v = (np.array(ends) for ends in zip(joints_of(self.y), joints_of(self.last), strict=True))
        a = np.array([self.steps.row(self.t, self.y, self.tau)["a"]])
        closed = self.steps.equations.nearly_closed if problem.events else None
        return RowSteps(
            edges, q, v, a, problem.parts_of(self.end - self.t), lambda number, time: self.state(time), closed
        ).pieces()


class _LoopRun:
    """One integration; t and y = (q, v, work, loss) are where it has come to."""

    _tau: Torque

    def __init__(self, problem: InitialValueProblem, rtol: float, atol: float) -> None:
        from scipy.integrate import DOP853

        self._equations, self._source, self._tolerances = LoopEquations(problem.plant), problem.source, (rtol, atol)
        errors = np.array([DOP853.E3[: DOP853.n_stages], DOP853.E5[: DOP853.n_stages]])
        closed_stages = problem.source.function is not None
        self._steps = LoopSteps(self._equations, tableau("rk8"), closed_stages, errors)
        self._plant, self._errors, self._taken = problem.plant, errors, 0
        self._tick, self._duration = -1, problem.duration
        self._far_width = self._width = FIRST_STEP_SHARE * problem.duration
        self.t, self.y = 0.0, problem.state
        self._pace = Pace(problem.duration, rtol, atol)
        self._pace.restart(problem.start[1])
        self._hold()

    def row(self) -> dict[str, Array]:
        return self._steps.row(self.t, self.y, self._tau)

    def end_at(self, t: float, y: Array, step: _LoopStep) -> None:
        """Go back to a time within the last step."""
        if t < self.t:
            self.t, self.y, self._tau = t, y, step.tau

    def advance(self, target: float) -> _LoopStep:
        """One step, to the target at most, and to the next new torque. Raises IntegrationFailed."""
        period = self._source.period
        end = target if period is None else min(target, (self._tick + 1) * period)
        while True:
            h = min(self._width, end - self.t)
            if h < min(MIN_STEP_WIDTH_SHARE * self._duration, end - self.t):
                raise IntegrationFailed(
                    f"the integration failed at {self.t:g} s: steps have become too narrow; the torques may be too "
                    "stiff or too large"
                )
            self._compile_soon()
            step = self._tried(h)
            error = np.inf if step is None else self._error(step)
            # error < 1 is within the tolerances; the error of a step of order 8 grows with the width to the 8th power
            wider = min(MAX_STEP_RATIO, STEP_SAFETY * error ** (-1 / ERROR_ORDER)) if error > 0 else MAX_STEP_RATIO
            near = step is not None and step.distance <= self._steps.wary
            # near a singular pose a step that is narrow enough is taken as it is
            if step is not None and (error < 1 or (near and h <= self._far_width * MIN_STEP_NEAR_POSE)):
                break
            self._width = h * max(MIN_STEP_RATIO, wider)
            if near:
                self._width = max(self._width, self._far_width * MIN_STEP_NEAR_POSE)
        if not near:
            self._far_width = h
        # a step cut short by the target or by a tick says nothing against the width before
        self._width = max(self._width if h < self._width else 0.0, h * wider) if error < 1 else h
        reached = end if h == end - self.t else self.t + h
        taken = _LoopStep(self._steps, self._tau, self.t, self.y, reached, step.y)
        self.t, self.y = reached, step.y
        self._pace.step(self.t, joints_of(self.y)[1])
        self._hold()
        return taken

    def _compile_soon(self) -> None:
        """Compiles the steps when those in Python have taken about as long as that takes, if their torques are held."""
        self._taken += 1
        if self._taken == PYTHON_STEPS and isinstance(self._tau, Held) and can_compile(self._plant):
            self._steps.compiled = single_steps(self._plant, "rk8", self._errors)

    def _tried(self, h: float) -> Stepped | None:
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                step = self._steps.advanced(self.t, self.y, h, self._tau)
        except IntegrationFailed:
            return None
        return step if np.isfinite(step.y).all() else None

    def _error(self, step: Stepped) -> float:
        """Relative to the tolerances; the work follows from the motion, and does not control the steps."""
        relative, absolute = self._tolerances
        size = np.maximum(np.abs(self.y), np.abs(step.y))[:-2]
        # the estimate of the error combines formulas of the third and fifth order, as DOP853 does
        third, fifth = step.errors[:, :-2] / (absolute + relative * size)
        squares = fifth @ fifth, third @ third
        if not squares[0]:
            return 0.0
        return float(squares[0] / np.sqrt((squares[0] + 0.01 * squares[1]) * len(size)))

    def _hold(self) -> None:
        """Asks for the torque of the next tick, where it is held."""
        source, period = self._source, self._source.period
        if period is None and source.values is not None:
            self._tau = Held(self._equations.clamped(source.values[0]))
        elif period is None:
            self._tau = lambda t, q, v: self._equations.clamped(source.tau_at(t, q, v))
        elif self.t >= (self._tick + 1) * period:
            self._tick += 1
            self._pace.restart(joints_of(self.y)[1])
            held = self._equations.clamped(source.tau_from(self._tick * period, *joints_of(self.y)))
            self._tau = Held(held)
