"""Steps that adapt to a tolerance: DOP853 of SciPy, stretch by stretch between events.

Inside a stretch the equations are smooth: which joints slide, and in which direction, is decided at its beginning. It
ends where a sliding joint comes to rest, where a joint at rest breaks loose, at a limit, at a new torque of a sampled
controller, and at events of the caller.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn.compiler.stepping.layout import HOLDING_SHARE
from graphdyn.errors import IntegrationFailed
from graphdyn.layout import Array
from graphdyn.simulation.equations import Contact, Equations, Rates
from graphdyn.simulation.integration.crossings import Pieces, Watch, crossings
from graphdyn.simulation.integration.events import InitialValueProblem, Occurrence, Rows, SimulatedCourse, watches
from graphdyn.simulation.integration.pace import Pace
from graphdyn.simulation.integration.steps import Torque, derivative, joints_of, recorded

MAX_SLIDING_PASSES = 20
"""How often it is decided again which joints slide: more than ever needed, since each joint changes once or twice."""

MAX_CHANGES = 1000
"""So many joints that start or stop within a CHANGES_SHARE of the duration start and stop without end."""

CHANGES_SHARE = 1e-5

EVALUATIONS_PER_REPORT = 500
"""Evaluations after which progress is reported, a tenth of a second at most."""

HOLDING_DEGREE = 3
"""Degree of the polynomials that the torques of joints at rest are compared with: a value is an inverse dynamics."""


def adaptive(problem: InitialValueProblem, rtol: float, atol: float) -> SimulatedCourse:
    """q and v from the start on. Raises IntegrationFailed."""
    run = _AdaptiveRun(problem, rtol, atol)
    while not run.is_finished:
        run.stretch()
    return SimulatedCourse.of_rows(run.times, run.rows, run.occurrences, run.ended)


class _AdaptiveRun:
    """One integration; t and y = (q, v, work, loss) are where it has come to."""

    def __init__(self, problem: InitialValueProblem, rtol: float, atol: float) -> None:
        self._problem, self._equations, self._tolerances = problem, Equations(problem.plant), (rtol, atol)
        self._watches, self._pace = watches(problem), Pace(problem.duration, rtol, atol)
        self._changes = deque[float](maxlen=MAX_CHANGES)
        self._loose: int | None = None
        self._tick, self._t, self._y = 0, 0.0, problem.state
        self._hold()
        self.times, self.rows, self.occurrences, self.ended = list[float](), list[Rows](), list[Occurrence](), ""

    @property
    def is_finished(self) -> bool:
        return bool(self.ended) or self._t >= self._problem.duration

    def stretch(self) -> None:
        """Integrate as far as the equations are smooth."""
        t, (q, v) = self._t, joints_of(self._y)
        # which joints slide is decided here, and holds until an event ends the stretch
        contact = self._equations.contact(t, q, v, self._tau_at(t, q, v), MAX_SLIDING_PASSES, self._loose)
        self._loose = None
        stretch = _Stretch(self._equations, self._tau_at, contact, self._problem.progress)
        solver, changing = self._solver(stretch), stretch.changes()
        self._pace.restart(v)
        change: _Change | None = None
        while solver.status == "running" and change is None and not self.ended:
            with np.errstate(over="ignore", invalid="ignore"):
                message = solver.step()
            if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
                raise IntegrationFailed(
                    f"the integration failed at {solver.t:g} s ({(message or 'the numbers are not finite').strip()}); "
                    "the torques may be too stiff or too large"
                )
            step = self._step(solver, bool(changing))
            if changing:
                found = crossings([each.watch for each in changing], step.pieces(np.array([step.begin, step.end])))
                if found:
                    change = next(each for each in changing if each.watch is found[0].watch)
                    step = step.until(found[0].time)
            if self._watches and step.end > step.begin:
                step = self._searched(step)
            self._record(stretch, step)
            self._t, self._y = step.end, step.state(step.end)
            self._pace.step(self._t, joints_of(self._y)[1])
        self._problem.progress(self._t)
        if self.ended:
            self._append(stretch, self._t, self._y)
        elif change is not None:
            self._apply(change)
        if self._t >= self._end and not self.is_finished:
            self._tick += 1
            self._hold()

    def _solver(self, stretch: _Stretch) -> Any:
        from scipy.integrate import DOP853

        rtol, atol = self._tolerances
        absolute = np.full(len(self._y), atol)
        absolute[-2:] = np.inf  # the work follows from the motion, and does not control the steps
        with np.errstate(over="ignore", invalid="ignore"):
            return DOP853(stretch.derivative, self._t, self._y, self._end, rtol=rtol, atol=absolute)

    def _step(self, solver: Any, changing: bool) -> _Step:
        needed = changing or bool(self._watches) or self._problem.at is not None
        begin, end = float(solver.t_old), float(solver.t)
        return _Step(begin, end, self._y, (end, solver.y.copy()), solver.dense_output() if needed else None)

    def _searched(self, step: _Step) -> _Step:
        """The step as far as the first event that stops."""
        for crossing in crossings(self._watches, step.pieces(self._problem.divided(step.begin, step.end))):
            self.occurrences.append(
                Occurrence(crossing.watch.name, crossing.time, *joints_of(step.state(crossing.time)))
            )
            if crossing.watch.stop:
                self.ended = crossing.watch.name
                return step.until(crossing.time)
        return step

    def _record(self, stretch: _Stretch, step: _Step) -> None:
        """The rows of a step without its end, which begins the next, unless it is the last."""
        at, finished = self._problem.at, step.end >= self._problem.duration and not self.ended
        if at is None:
            times = [step.begin] if step.end > step.begin else []
            times += [step.end] if finished else []
        else:
            times = at[(at >= step.begin) & ((at <= step.end) if finished else (at < step.end))].tolist()
        for time in times:
            self._append(stretch, time, step.state(time))

    def _append(self, stretch: _Stretch, t: float, y: Array) -> None:
        self.times.append(t)
        self.rows.append(stretch.row(t, y))

    def _apply(self, change: _Change) -> None:
        """Raises IntegrationFailed where joints start and stop without end."""
        self._y = self._y.copy()
        if change.rests:
            self._y[len(self._problem.start[0]) + change.joint] = 0.0
        else:
            self._loose = change.joint
        self._changes.append(self._t)
        full = len(self._changes) == MAX_CHANGES
        if full and self._t - self._changes[0] < CHANGES_SHARE * self._problem.duration:
            names = self._problem.plant.model.independent_joints
            raise IntegrationFailed(
                f"at {self._t:g} s joint '{names[change.joint]}' starts and stops without end, as under a torque that "
                "jumps with the state; make it continuous, give a controller with a period, or fixed steps"
            )

    def _hold(self) -> None:
        """The torque of this tick, and until when it is one smooth function."""
        source, period, equations = self._problem.source, self._problem.source.period, self._equations
        if period is None:
            self._tau_at: Torque = lambda t, q, v: equations.clamped(source.tau_at(t, q, v))
            self._end = self._problem.duration
        else:
            held = equations.clamped(source.tau_from(self._tick * period, *joints_of(self._y)))
            self._tau_at = lambda t, q, v: held
            self._end = min((self._tick + 1) * period, self._problem.duration)


@dataclass(frozen=True, eq=False)
class _Step:
    """A step, or the first part of one.

    first: the state at its beginning; last: time and state at the end of the whole step
    dense: the states of the whole step, as a function of time
    """

    begin: float
    end: float
    first: Array
    last: tuple[float, Array]
    dense: Callable[[float | Array], Array] | None

    def until(self, time: float) -> _Step:
        return replace(self, end=time)

    def state(self, time: float) -> Array:
        """(2n + 2,)."""
        if time == self.begin:
            return self.first
        if time == self.last[0]:
            return self.last[1]
        assert self.dense is not None
        return np.asarray(self.dense(time))

    def pieces(self, edges: Array) -> Pieces:
        return Pieces(edges, self._joints, self._joints)

    def _joints(self, numbers: NDArray[np.int64], times: Array) -> tuple[Array, Array]:
        assert self.dense is not None
        states = np.moveaxis(self.dense(times.ravel()), 0, -1).reshape(*times.shape, -1)
        states[times == self.begin], states[times == self.last[0]] = self.first, self.last[1]
        n = (states.shape[-1] - 2) // 2
        return states[..., :n], states[..., n : 2 * n]


@dataclass(frozen=True, eq=False)
class _Change:
    """A joint that comes to rest, or breaks loose, where its watch crosses zero."""

    watch: Watch
    joint: int
    rests: bool


class _Stretch:
    """The smooth equations between two events."""

    def __init__(
        self, equations: Equations, tau_at: Torque, contact: Contact, progress: Callable[[float], None]
    ) -> None:
        self._equations, self._tau_at, self._contact, self._progress = equations, tau_at, contact, progress
        self._evaluations, self._reached = 0, 0.0

    def derivative(self, t: float, y: Array) -> Array:
        self._evaluations += 1
        if self._evaluations % EVALUATIONS_PER_REPORT == 0 and t > self._reached:
            self._reached = t
            self._progress(t)
        q, v = joints_of(y)
        tau = self._tau_at(t, q, v)
        return derivative(v, tau, self._rates(t, q, v, tau))

    def changes(self) -> list[_Change]:
        """What is looked at: the velocities of sliding joints, and how near those at rest are to breaking loose."""
        plant = self._equations.plant
        if not plant.sticks:
            return []
        dry = plant.constants["coulomb"]
        found = []
        for j in np.flatnonzero(dry > 0).tolist():
            if self._contact.free[j]:
                watch = Watch(self._sliding(j), direction=-1, inside=True)
            else:
                watch = Watch(self._excess(j, dry[j]), direction=1, inside=True, degree=HOLDING_DEGREE)
            found.append(_Change(watch, j, bool(self._contact.free[j])))
        return found

    def row(self, t: float, y: Array) -> Rows:
        q, v = joints_of(y)
        tau = self._tau_at(t, q, v)
        return recorded(y, tau, self._rates(t, q, v, tau))

    def _sliding(self, j: int) -> Callable[[Array, Array, Array], Array]:
        sign = self._contact.sign[j]
        return lambda times, q, v: sign * v[:, j]

    def _excess(self, j: int, dry: float) -> Callable[[Array, Array, Array], Array]:
        """What a joint at rest would need to be held, beyond its dry friction."""

        def values(times: Array, q: Array, v: Array) -> Array:
            states = zip(times.tolist(), q, v, strict=True)
            held = [self._rates(t, x, rate, self._tau_at(t, x, rate)).held[j] for t, x, rate in states]
            return np.abs(held) - HOLDING_SHARE * dry

        return values

    def _rates(self, t: float, q: Array, v: Array, tau: Array) -> Rates:
        return self._equations.rates(t, q, v, tau, self._contact)
