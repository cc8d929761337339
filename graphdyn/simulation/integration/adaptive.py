"""Steps that adapt to a tolerance: DOP853 of SciPy, stretch by stretch between events.

Inside a stretch the equations are smooth: which joints slide, and in which direction, is decided at its beginning. It
ends where a sliding joint comes to rest, where a joint at rest breaks loose, at a limit, at a new torque of a sampled
controller, and at events of the caller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from graphdyn.errors import IntegrationFailed
from graphdyn.layout import Array
from graphdyn.simulation.equations import Contact, Equations
from graphdyn.simulation.integration.events import InitialValueProblem, Occurrence, SimulatedCourse
from graphdyn.simulation.integration.steps import Torque, derivative, joints_of, recorded

MAX_SLIDING_PASSES = 20
"""How often it is decided again which joints slide: more than ever needed, since each joint changes once or twice."""

MAX_STUCK_STRETCHES = 1000
"""Stretches without progress that mean the same events follow each other without end."""

EVALUATIONS_PER_REPORT = 500
"""Evaluations after which progress is reported, a tenth of a second at most."""


def adaptive(problem: InitialValueProblem, rtol: float, atol: float) -> SimulatedCourse:
    """q and v from the start on. Raises IntegrationFailed."""
    equations, at, duration = Equations(problem.plant), problem.at, problem.duration
    y, n = problem.state, len(problem.start[0])
    t, tick, idle, ended = 0.0, 0, 0, ""
    parts: list[SimulatedCourse] = []
    occurrences: list[Occurrence] = []
    loose: int | None = None
    tau_at, end = _torque_from(problem, tick, equations, y)
    while True:
        q, v = joints_of(y)
        # which joints slide is decided here, and holds until an event ends the stretch
        contact = equations.contact(t, q, v, tau_at(t, q, v), MAX_SLIDING_PASSES, loose)
        stretch = _Stretch(equations, tau_at, contact, problem.progress)
        checked = stretch.checks() + [
            _EventCheck(_of_state(event.function), event.name, event.direction, event.stop) for event in problem.events
        ]
        solution = _solve(stretch, (t, end), y, rtol, atol, checked, dense=at is not None)
        reached = float(solution.t[-1])
        finished = reached >= duration
        part = stretch.rows(solution, at, t, last=finished)
        if (reached > t or finished) and part.time.size:
            parts.append(part)
        y, loose = solution.y[:, -1].copy(), None
        for check, times, states in zip(checked, solution.t_events, solution.y_events, strict=True):
            for time, state in zip(times, states, strict=True):
                if check.rests is not None:
                    y[n + check.rests] = 0.0
                elif check.breaks_loose is not None:
                    loose = check.breaks_loose
                else:
                    occurrences.append(Occurrence(check.name, float(time), *joints_of(state)))
                    ended = check.name if check.stop else ended
        problem.progress(reached)
        if ended or finished:
            break
        # an event at the very beginning of a stretch is no progress
        idle = idle + 1 if reached <= t else 0
        if idle > MAX_STUCK_STRETCHES:
            raise IntegrationFailed(
                f"at {t:g} s joints start and stop without end; give friction that is less stiff, or fixed steps"
            )
        t = reached
        if reached >= end:
            tick += 1
            tau_at, end = _torque_from(problem, tick, equations, y)
    if ended and (at is None or not parts or parts[-1].time[-1] < reached):
        parts.append(stretch.row_at(reached, y))
    return SimulatedCourse.joined(parts, occurrences, ended)


@dataclass(frozen=True, eq=False)
class _EventCheck:
    """function: (t, y) → a number; rests, breaks_loose: the joint that does so where it vanishes."""

    function: Callable[[float, Array], float]
    name: str = ""
    direction: int = 0
    stop: bool = True
    rests: int | None = None
    breaks_loose: int | None = None


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
        return derivative(v, tau, self._equations.rates(t, q, v, tau, self._contact))

    def checks(self) -> list[_EventCheck]:
        """Event checks: of sliding joints their velocity, of joints at rest how near they are to breaking loose."""
        plant = self._equations.plant
        if not plant.sticks:
            return []
        n, dry = len(self._contact.sign), plant.constants["coulomb"]
        checks = []
        for j in np.flatnonzero(dry > 0).tolist():
            if self._contact.free[j]:
                against = -int(self._contact.sign[j])
                checks.append(_EventCheck(partial(_entry, n + j), direction=against, rests=j))
            else:
                checks.append(_EventCheck(partial(self._excess, j, dry[j]), direction=1, breaks_loose=j))
        return checks

    def _excess(self, j: int, dry: float, t: float, y: Array) -> float:
        """The excess: by how much more than dry friction a joint at rest would need to be held."""
        q, v = joints_of(y)
        held = self._equations.rates(t, q, v, self._tau_at(t, q, v), self._contact).held
        return float(abs(held[j]) - dry)

    def rows(self, solution: Any, at: Array | None, start: float, last: bool) -> SimulatedCourse:
        """The rows of this stretch: those of the steps without the last, which begins the next, or those asked for."""
        if at is None:
            times, states = solution.t, solution.y.T
            chosen = slice(None) if last else slice(0, -1)
            return self._course(times[chosen], states[chosen])
        end = solution.t[-1]
        times = at[(at >= start) & ((at <= end) if last else (at < end))]
        states = solution.sol(times).T if times.size else np.empty((0, len(solution.y)))
        for exact, row in ((start, 0), (end, -1)):
            if times.size and times[row] == exact:
                states[row] = solution.y[:, row]
        return self._course(times, states)

    def row_at(self, t: float, y: Array) -> SimulatedCourse:
        return self._course(np.array([t]), y[None])

    def _course(self, times: Array, states: Array) -> SimulatedCourse:
        rows = []
        for t, y in zip(times.tolist(), states, strict=True):
            q, v = joints_of(y)
            tau = self._tau_at(t, q, v)
            rows.append(recorded(y, tau, self._equations.rates(t, q, v, tau, self._contact)))
        return SimulatedCourse.of_rows(times, rows, (), "")


def _torque_from(problem: InitialValueProblem, tick: int, equations: Equations, y: Array) -> tuple[Torque, float]:
    """The torque from this tick on, and until when it is one smooth function."""
    source, period = problem.source, problem.source.period
    if period is None:
        return lambda t, q, v: equations.clamped(source.tau_at(t, q, v)), problem.duration
    held = equations.clamped(source.tau_from(tick * period, *joints_of(y)))
    return lambda t, q, v: held, min((tick + 1) * period, problem.duration)


def _entry(k: int, t: float, y: Array) -> float:
    return float(y[k])


def _of_state(function: Callable[[float, Array, Array], float]) -> Callable[[float, Array], float]:
    return lambda t, y: float(function(t, *joints_of(y)))


def _solve(
    stretch: _Stretch,
    span: tuple[float, float],
    y: Array,
    rtol: float,
    atol: float,
    checked: Sequence[_EventCheck],
    dense: bool,
) -> Any:
    from scipy.integrate import solve_ivp

    def scipy_event(check: _EventCheck) -> Callable[[float, Array], float]:
        function = partial(check.function)
        function.terminal, function.direction = check.stop, check.direction  # type: ignore[attr-defined]
        return function

    absolute = np.full(len(y), atol)
    absolute[-2:] = np.inf  # the work follows from the motion, and does not control the steps
    with np.errstate(over="ignore", invalid="ignore"):
        solution = solve_ivp(
            stretch.derivative,
            span,
            y,
            method="DOP853",
            rtol=rtol,
            atol=absolute,
            events=[scipy_event(check) for check in checked] or None,
            dense_output=dense,
        )
    if solution.status < 0 or not np.all(np.isfinite(solution.y)):
        raise IntegrationFailed(
            f"the integration failed at {solution.t[-1]:g} s ({solution.message.strip()}); "
            "the torques may be too stiff or too large"
        )
    if not checked:
        solution.t_events, solution.y_events = [], []
    return solution
