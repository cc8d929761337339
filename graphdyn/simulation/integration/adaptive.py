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
from graphdyn.model.robot_model import RobotModel
from graphdyn.simulation.equations import Contact, Equations
from graphdyn.simulation.integration.events import COURSE_COLUMNS, Event, Occurrence, SimulatedCourse
from graphdyn.simulation.integration.steps import Torque
from graphdyn.simulation.plant import position_limits

MAX_SLIDING_PASSES = 20
"""How often it is decided again which joints slide: more than ever needed, since each joint changes once or twice."""

MAX_STUCK_STRETCHES = 1000
"""Stretches without progress that mean the same events follow each other without end."""

EVALUATIONS_PER_REPORT = 500
"""Evaluations after which progress is reported, a tenth of a second at most."""


@dataclass(frozen=True, eq=False)
class Ticks:
    """A torque that is held: tau(number, q, v) from number · period on [s]."""

    period: float
    tau: Callable[[int, Array, Array], Array]


@dataclass(frozen=True)
class Tolerances:
    """Relative, and absolute in the units of the state."""

    rtol: float
    atol: float


def adaptive(
    equations: Equations,
    start: tuple[Array, Array],
    duration: float,
    torque: Torque | Ticks,
    tolerances: Tolerances,
    at: Array | None,
    events: Sequence[Event],
    stop_at_limits: bool,
    progress: Callable[[float], None],
) -> SimulatedCourse:
    """q and v from the start on. Raises IntegrationFailed.

    at: times of the rows; None for those of the steps
    progress: called with the time reached [s]
    """
    n = len(start[0])
    y = np.concatenate([*start, np.zeros(2)])
    t, tick, idle, ended = 0.0, 0, 0, ""
    parts: list[SimulatedCourse] = []
    occurrences: list[Occurrence] = []
    loose: int | None = None
    tau_at, end = _torque_from(torque, tick, equations, y, duration)
    while True:
        q, v = y[:n], y[n : 2 * n]
        # which joints slide is decided here, and holds until an event ends the stretch
        contact = equations.contact(t, q, v, tau_at(t, q, v), MAX_SLIDING_PASSES, loose)
        stretch = _Stretch(equations, tau_at, contact, progress)
        checked = stretch.checks() + (_limit_checks(equations) if stop_at_limits else [])
        checked += [
            _EventCheck(_of_state(event.function, n), event.name, event.direction, event.stop) for event in events
        ]
        solution = _solve(stretch, (t, end), y, tolerances, checked, dense=at is not None)
        reached = float(solution.t[-1])
        finished = reached >= duration
        if reached > t or finished:
            parts.append(stretch.rows(solution, at, t, last=finished))
        y, loose = solution.y[:, -1].copy(), None
        for check, times, states in zip(checked, solution.t_events, solution.y_events, strict=True):
            for time, state in zip(times, states, strict=True):
                if check.rests is not None:
                    y[n + check.rests] = 0.0
                elif check.breaks_loose is not None:
                    loose = check.breaks_loose
                else:
                    occurrences.append(Occurrence(check.name, float(time), state[:n], state[n : 2 * n]))
                    ended = check.name if check.stop else ended
        progress(reached)
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
            tau_at, end = _torque_from(torque, tick, equations, y, duration)
    if ended and (at is None or parts[-1].time.size == 0 or parts[-1].time[-1] < reached):
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
        n = len(self._contact.sign)
        q, v = y[:n], y[n : 2 * n]
        tau = self._tau_at(t, q, v)
        found = self._equations.rates(t, q, v, tau, self._contact)
        return np.concatenate([v, found.a, [tau @ v, found.passive @ v]])

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
                checks.append(_EventCheck(partial(_less, n + j, 0.0), direction=against, rests=j))
            else:
                checks.append(_EventCheck(partial(self._excess, j, dry[j]), direction=1, breaks_loose=j))
        return checks

    def _excess(self, j: int, dry: float, t: float, y: Array) -> float:
        """The excess: by how much more than dry friction a joint at rest would need to be held."""
        n = len(self._contact.sign)
        q, v = y[:n], y[n : 2 * n]
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
        n = len(self._contact.sign)
        columns: dict[str, list[Array]] = {name: [] for name in COURSE_COLUMNS}
        for t, y in zip(times.tolist(), states, strict=True):
            q, v = y[:n], y[n : 2 * n]
            tau = self._tau_at(t, q, v)
            found = self._equations.rates(t, q, v, tau, self._contact)
            values = (q, v, y[2 * n : 2 * n + 1], y[2 * n + 1 :], tau, found.a, found.passive)
            for name, value in zip(COURSE_COLUMNS, values, strict=True):
                columns[name].append(value)
        widths = {name: 1 if name in ("work", "loss") else n for name in COURSE_COLUMNS}
        return SimulatedCourse(times, {name: np.reshape(rows, (-1, widths[name])) for name, rows in columns.items()})


def _torque_from(
    torque: Torque | Ticks, tick: int, equations: Equations, y: Array, duration: float
) -> tuple[Torque, float]:
    """The torque from this tick on, and until when it is one smooth function."""
    if not isinstance(torque, Ticks):
        return lambda t, q, v: equations.clamped(torque(t, q, v)), duration
    n = (len(y) - 2) // 2
    held = equations.clamped(torque.tau(tick, y[:n], y[n : 2 * n]))
    return lambda t, q, v: held, min((tick + 1) * torque.period, duration)


def _limit_checks(equations: Equations) -> list[_EventCheck]:
    """Every joint with limits stops the simulation where it reaches one."""
    model = equations.plant.model
    checks = []
    for side, limits, direction in zip(("lower", "upper"), position_limits(model), (-1, 1), strict=True):
        for j in np.flatnonzero(np.isfinite(limits)).tolist():
            name = f"{side} limit of joint '{model.joint_names[j]}'"
            checks.append(_EventCheck(partial(_beyond, model, j, float(limits[j])), name, direction))
    return checks


def _less(k: int, level: float, t: float, y: Array) -> float:
    return float(y[k] - level)


def _beyond(model: RobotModel, j: int, limit: float, t: float, y: Array) -> float:
    return float(model.joint_positions(y[: model.nv])[j] - limit)


def _of_state(function: Callable[[float, Array, Array], float], n: int) -> Callable[[float, Array], float]:
    return lambda t, y: float(function(t, y[:n], y[n : 2 * n]))


def _solve(
    stretch: _Stretch,
    span: tuple[float, float],
    y: Array,
    tolerances: Tolerances,
    checked: Sequence[_EventCheck],
    dense: bool,
) -> Any:
    from scipy.integrate import solve_ivp

    def scipy_event(check: _EventCheck) -> Callable[[float, Array], float]:
        function = partial(check.function)
        function.terminal, function.direction = check.stop, check.direction  # type: ignore[attr-defined]
        return function

    atol = np.full(len(y), tolerances.atol)
    atol[-2:] = np.inf  # the work follows from the motion, and does not control the steps
    with np.errstate(over="ignore", invalid="ignore"):
        solution = solve_ivp(
            stretch.derivative,
            span,
            y,
            method="DOP853",
            rtol=tolerances.rtol,
            atol=atol,
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
