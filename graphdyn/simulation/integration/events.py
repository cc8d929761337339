"""What is integrated, events between steps, and what an integration hands over: rows of numbers, and why it ended.

An event is found where a function changes its sign from one step to the next. Between two steps q and v are cubic, from
the values and rates at both (Hermite).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.simulation.equations import LoopEquations, equations_of
from graphdyn.simulation.plant import PlantConstants, position_limits
from graphdyn.simulation.torques import Torques

Rows = dict[str, Array]

COURSE_COLUMNS = ("q", "v", "work", "loss", "tau", "a", "passive")


@dataclass(frozen=True)
class Event:
    """A function of t, q and v whose change of sign is looked for.

    function: (t, q, v) → a number
    name: in the result
    stop: whether the simulation ends there
    direction: 1 for a rise through zero, -1 for a fall, 0 for both
    """

    function: Callable[[float, Array, Array], float]
    name: str = "event"
    stop: bool = True
    direction: Literal[-1, 0, 1] = 0


@dataclass(frozen=True, eq=False)
class Occurrence:
    """An event that happened.

    name: of the event, such as "upper limit of joint 'elbow'"
    time: when it happened [s]
    q, v: (n,)
    """

    name: str
    time: float
    q: Array
    v: Array


@dataclass(frozen=True, eq=False)
class SimulatedCourse:
    """Times (N,) and the columns of COURSE_COLUMNS (N, width).

    ended: name of the event that ended it, "" for the duration
    """

    time: Array
    columns: dict[str, Array]
    occurrences: tuple[Occurrence, ...] = ()
    ended: str = ""

    @staticmethod
    def of_rows(
        times: ArrayLike, rows: Sequence[Rows], occurrences: Sequence[Occurrence], ended: str
    ) -> SimulatedCourse:
        columns = {name: np.array([row[name] for row in rows]) for name in COURSE_COLUMNS}
        return SimulatedCourse(np.asarray(times), columns, tuple(occurrences), ended)

    @staticmethod
    def joined(parts: list[SimulatedCourse], occurrences: list[Occurrence], ended: str) -> SimulatedCourse:
        columns = {name: np.concatenate([part.columns[name] for part in parts]) for name in COURSE_COLUMNS}
        return SimulatedCourse(np.concatenate([part.time for part in parts]), columns, tuple(occurrences), ended)

    def rows(self, chosen: NDArray[np.int64] | slice) -> SimulatedCourse:
        """Some of the rows."""
        columns = {name: column[chosen] for name, column in self.columns.items()}
        return SimulatedCourse(self.time[chosen], columns, self.occurrences, self.ended)


@dataclass(frozen=True, eq=False)
class InitialValueProblem:
    """A plant under torques, from a state on.

    start: q and v at time zero                             (n,) each
    at: times of the rows, increasing; None for those of all steps   (N,)  [s]
    events: what is looked for, with the position limits that end the simulation
    progress: called with the time reached [s]
    """

    plant: PlantConstants
    start: tuple[Array, Array]
    duration: float
    source: Torques
    at: Array | None
    events: tuple[Event, ...]
    progress: Callable[[float], None]

    @property
    def state(self) -> Array:
        """q, v, work and loss at time zero (2n + 2,)."""
        return np.concatenate([*self.start, np.zeros(2)])


class Scan:
    """Looks through the rows of all steps, chunk after chunk.

    occurrences: what was found; ended: name of the event that ends the simulation, "" as long as there was none
    """

    def __init__(self, problem: InitialValueProblem) -> None:
        self._plant, self._source, self._events = problem.plant, problem.source, problem.events
        self._before: SimulatedCourse | None = None
        self.occurrences: list[Occurrence] = []
        self.ended = ""

    def searched(self, course: SimulatedCourse) -> SimulatedCourse:
        """The rows up to the first event that stops, whose own row is the last."""
        rows = course if self._before is None else SimulatedCourse.joined([self._before, course], [], "")
        found = [
            (_crossing(rows, k, event), k, event)
            for event in self._events
            for k in changes(_values(event, rows), event.direction)
        ]
        overlap = 0 if self._before is None else 1
        self._before = rows.rows(slice(-1, None))
        for time, k, event in sorted(found, key=lambda item: item[0]):
            state = _between(rows, k, time)
            self.occurrences.append(Occurrence(event.name, time, state["q"], state["v"]))
            if event.stop:
                self.ended = event.name
                return SimulatedCourse.joined(
                    [rows.rows(slice(overlap, k + 1)), self._row(rows, k, time, state)], [], ""
                )
        return course

    def _row(self, rows: SimulatedCourse, k: int, time: float, state: Rows) -> SimulatedCourse:
        """The row of an event between rows k and k + 1."""
        equations, q, v = equations_of(self._plant), state["q"], state["v"]
        if isinstance(equations, LoopEquations):
            q, v = equations.closed(q, v)
            state = {**state, "q": q, "v": v}
        held = self._source.function is None
        tau = rows.columns["tau"][k] if held else equations.clamped(self._source.tau_at(time, q, v))
        found = equations.rates(time, q, v, tau, equations.contact(time, q, v, tau))
        values = {**state, "tau": tau, "a": found.a, "passive": found.passive}
        return SimulatedCourse(np.array([time]), {name: values[name][None] for name in COURSE_COLUMNS})


def limit_events(plant: PlantConstants) -> list[Event]:
    """The position limits of all joints, each of which ends a simulation."""
    events = []
    lower, upper = position_limits(plant.model)
    sides: tuple[tuple[str, Array, Literal[-1, 1]], ...] = (("lower", lower, -1), ("upper", upper, 1))
    for side, limits, direction in sides:
        for j in np.flatnonzero(np.isfinite(limits)).tolist():
            name = f"{side} limit of joint '{plant.model.joint_names[j]}'"
            events.append(Event(_beyond(plant.model, j, limits[j]), name, direction=direction))
    return events


def _beyond(model: RobotModel, j: int, limit: float) -> Callable[[float, Array, Array], float]:
    return lambda t, q, v: float(model.joint_positions(q)[j] - limit)


def _values(event: Event, rows: SimulatedCourse) -> Array:
    q, v = rows.columns["q"], rows.columns["v"]
    return np.array([float(event.function(t, q[k], v[k])) for k, t in enumerate(rows.time.tolist())])


def changes(values: Array, direction: int) -> list[int]:
    """Rows after which the sign changes; zero itself belongs to the step that ends there."""
    before, after = values[:-1], values[1:]
    rises, falls = (before < 0) & (after >= 0), (before > 0) & (after <= 0)
    chosen = rises if direction > 0 else falls if direction < 0 else rises | falls
    return [int(k) for k in np.flatnonzero(chosen)]


def _crossing(rows: SimulatedCourse, k: int, event: Event) -> float:
    """When the function vanishes between rows k and k + 1."""
    from scipy.optimize import brentq

    def value(time: float) -> float:
        state = _between(rows, k, time)
        return float(event.function(time, state["q"], state["v"]))

    first, last = float(rows.time[k]), float(rows.time[k + 1])
    if value(last) == 0:
        return last
    return float(brentq(value, first, last, xtol=4 * np.finfo(float).eps * last))


def _between(rows: SimulatedCourse, k: int, time: float) -> Rows:
    """q, v, work and loss at a time between rows k and k + 1."""
    x, (start, end) = rows.columns, rows.time[[k, k + 1]]
    rates = {"q": x["v"], "v": x["a"]}
    for name, torque in (("work", x["tau"]), ("loss", x["passive"])):
        rates[name] = (torque * x["v"]).sum(axis=-1, keepdims=True)
    h = end - start
    s = (time - start) / h
    weights = (1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2 * h, s**2 * (3 - 2 * s), s**2 * (s - 1) * h
    return {
        name: weights[0] * x[name][k] + weights[1] * rate[k] + weights[2] * x[name][k + 1] + weights[3] * rate[k + 1]
        for name, rate in rates.items()
    }
