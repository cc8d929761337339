"""What is integrated, what is looked for, and what an integration hands over: rows of numbers, and why it ended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.simulation.integration.crossings import LARGEST_VALUE, Watch
from graphdyn.simulation.plant import PlantConstants, position_limits
from graphdyn.simulation.torques import Torques

Rows = dict[str, Array]

PIECES_OF_DURATION = 100
"""Pieces in which events of the caller are looked for are no longer than the duration divided by this."""

COURSE_COLUMNS = ("q", "v", "work", "loss", "tau", "a", "passive")


@dataclass(frozen=True)
@short_repr
class Event:
    """A function of t, q and v whose change of sign is looked for, by the same rule with every method.

    It happens when the function reaches or passes zero: from below (a rise) or from above (a fall). A function that is
    zero at the start has neither side yet: it happens when it leaves zero, upward a rise, downward a fall; while it
    rests there, nothing happens. It happens again once the function has been on the other side.

    Between the ends of steps the function is looked at along the motion, in pieces no longer than a step and a
    hundredth of the duration: a function that resembles a polynomial of degree seven in each piece is found twice in a
    step too. One that goes there and back more quickly may be missed.

    function: (t, q, v) → a number; NaN and truth values are errors, which name the event and the time
    name: in the result
    stop: whether the simulation ends there
    direction: 1 for a rise through zero, -1 for a fall, 0 for both
    """

    function: Callable[[float, Array, Array], float]
    name: str = "event"
    stop: bool = True
    direction: Literal[-1, 0, 1] = 0


@dataclass(frozen=True, eq=False)
@short_repr
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

    def rows(self, chosen: NDArray[np.int64] | NDArray[np.bool_] | slice) -> SimulatedCourse:
        """Some of the rows."""
        columns = {name: column[chosen] for name, column in self.columns.items()}
        return SimulatedCourse(self.time[chosen], columns, self.occurrences, self.ended)


@dataclass(frozen=True, eq=False)
class InitialValueProblem:
    """A plant under torques, from a state on.

    start: q and v at time zero                             (n,) each
    at: times of the rows, increasing; None for those of all steps   (N,)  [s]
    events: what is looked for
    stops_at_limits: whether the position limits of the joints end it
    progress: called with the time reached [s]
    """

    plant: PlantConstants
    start: tuple[Array, Array]
    duration: float
    source: Torques
    at: Array | None
    events: tuple[Event, ...]
    stops_at_limits: bool
    progress: Callable[[float], None]

    @property
    def is_searched(self) -> bool:
        """Whether anything is looked for between the steps."""
        return bool(self.events) or self.stops_at_limits

    def parts_of(self, width: float) -> int:
        """The pieces of a step in which events are looked for; limits need one alone."""
        return max(1, int(np.ceil(width * PIECES_OF_DURATION / self.duration))) if self.events else 1

    def divided(self, begin: float, end: float) -> Array:
        """Edges of the pieces of a step."""
        return np.linspace(begin, end, self.parts_of(end - begin) + 1)

    @property
    def state(self) -> Array:
        """q, v, work and loss at time zero (2n + 2,)."""
        return np.concatenate([*self.start, np.zeros(2)])


def watches(problem: InitialValueProblem) -> list[Watch]:
    """The events of a problem, and the position limits of its joints if they end it."""
    found = [event_watch(event) for event in problem.events]
    return found + limit_watches(problem.plant.model) if problem.stops_at_limits else found


def event_watch(event: Event) -> Watch:
    """Raises InvalidInput, when it is asked, where the function of the event answers anything but a number."""

    def values(times: Array, q: Array, v: Array) -> Array:
        found, q, v = np.full(len(times), np.nan), q.copy(), v.copy()
        for k, time in enumerate(times.tolist()):
            answer = event.function(time, q[k], v[k])
            reason = "" if isinstance(answer, float) and answer == answer else _no_number(answer)
            if reason:
                if watch.failure is None or time < watch.failure[0]:
                    message = (
                        f"event '{event.name}' answers {reason} at {time:g} s; a number is needed that changes sign"
                    )
                    watch.failure = time, InvalidInput(message)
                continue
            found[k] = np.asarray(answer).item()
        return np.asarray(np.clip(found, -LARGEST_VALUE, LARGEST_VALUE))

    watch = Watch(values, event.name, event.direction, event.stop)
    return watch


def _no_number(answer: object) -> str:
    """Why this is no number, "" where it is one."""
    array = np.asarray(answer)
    if array.dtype.kind == "b":
        return f"{answer}, true or false,"
    if array.dtype.kind not in "iuf":
        return f"{answer!r}"
    if array.size != 1:
        return f"an array of shape {array.shape}"
    return "NaN" if np.isnan(array.item()) else ""


def limit_watches(model: RobotModel) -> list[Watch]:
    """The position limits of all joints, each of which ends a simulation."""
    found = []
    lower, upper = position_limits(model)
    for side, limits, direction in (("lower", lower, -1), ("upper", upper, 1)):
        for j in np.flatnonzero(np.isfinite(limits)).tolist():
            name = f"{side} limit of joint '{model.joint_names[j]}'"
            found.append(Watch(_beyond(model, j, limits[j]), name, direction, inside=True))
    return found


def _beyond(model: RobotModel, j: int, limit: float) -> Callable[[Array, Array, Array], Array]:
    freedom = model.degrees_of_freedom
    ratios, offset = freedom.matrix[j], float(freedom.offset[j])
    # a sum joint by joint, the same for one state as for many
    return lambda times, q, v: (q * ratios).sum(axis=-1) + offset - limit
