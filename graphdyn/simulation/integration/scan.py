"""Events between the rows of steps of equal width."""

from __future__ import annotations

import numpy as np

from graphdyn.layout import Array
from graphdyn.simulation.equations import LoopEquations, equations_of
from graphdyn.simulation.integration.crossings import crossings
from graphdyn.simulation.integration.events import InitialValueProblem, Occurrence, Rows, SimulatedCourse, watches
from graphdyn.simulation.integration.sketches import RowSteps
from graphdyn.simulation.integration.steps import LoopSteps, Torque, joints_of, recorded, tableau, tree_step


class Scan:
    """Looks through the rows of all steps, chunk after chunk.

    occurrences: what was found; ended: name of the event that ends the simulation, "" as long as there was none
    """

    def __init__(self, problem: InitialValueProblem, method: str) -> None:
        self._problem, self._source, self._method = problem, problem.source, tableau(method)
        self._equations, self._watches = equations_of(problem.plant), watches(problem)
        self._before: SimulatedCourse | None = None
        self.occurrences: list[Occurrence] = []
        self.ended = ""

    def searched(self, course: SimulatedCourse) -> SimulatedCourse:
        """The rows up to the first event that stops, whose own row is the last."""
        rows = course if self._before is None else SimulatedCourse.joined([self._before, course], [], "")
        overlap = 0 if self._before is None else 1
        self._before = rows.rows(slice(-1, None))
        if len(rows.time) == 1:
            return course
        parts = self._problem.parts_of(float(rows.time[1] - rows.time[0]))
        for crossing in crossings(self._watches, self._steps(rows, parts).pieces()):
            k, time = crossing.piece // parts, crossing.time
            y = self._state(rows, k, time)
            self.occurrences.append(Occurrence(crossing.watch.name, time, *joints_of(y)))
            if crossing.watch.stop:
                self.ended = crossing.watch.name
                kept = rows.rows(slice(overlap, k + 1))
                if k < overlap and time == rows.time[k]:  # whose row is that of the chunk before
                    return kept
                row = SimulatedCourse.of_rows([time], [self._row(time, y, self._torque(rows, k))], [], "")
                return SimulatedCourse.joined([kept.rows(kept.time < time), row], [], "")
        return course

    def _steps(self, rows: SimulatedCourse, parts: int) -> RowSteps:
        q, v, a = (rows.columns[name] for name in ("q", "v", "a"))
        equations, closed = self._equations, None
        if (
            isinstance(equations, LoopEquations) and self._problem.events
        ):  # functions that call verbs need closed states
            closed = equations.nearly_closed
        return RowSteps(rows.time, q, v, a[:-1], parts, lambda k, time: self._state(rows, k, time), closed)

    def _state(self, rows: SimulatedCourse, k: int, time: float) -> Array:
        """q, v, work and loss at a time of the step after row k: of a step as far as that."""
        whole = time == rows.time[k + 1]
        y = np.concatenate([rows.columns[name][k + whole] for name in ("q", "v", "work", "loss")])
        t = float(rows.time[k])
        if whole or time == t:
            return y
        return self._advanced(t, y, time - t, self._torque(rows, k))

    def _advanced(self, t: float, y: Array, h: float, torque: Torque) -> Array:
        if isinstance(self._equations, LoopEquations):
            steps = LoopSteps(self._equations, self._method, closed_stages=self._source.function is not None)
            return steps.advanced(t, y, h, torque).y
        return tree_step(self._equations, self._method, t, y, h, torque)[0]

    def _torque(self, rows: SimulatedCourse, k: int) -> Torque:
        """That of the step after row k."""
        if self._source.function is None:
            return lambda t, q, v: rows.columns["tau"][k]
        return lambda t, q, v: self._equations.clamped(self._source.tau_at(t, q, v))

    def _row(self, time: float, y: Array, torque: Torque) -> Rows:
        q, v = joints_of(y)
        tau = torque(time, q, v)
        return recorded(y, tau, self._equations.rates(time, q, v, tau, self._equations.contact(time, q, v, tau)))
