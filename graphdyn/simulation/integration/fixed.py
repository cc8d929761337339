"""A simulation in steps of equal width, compiled where that is possible, with events found between the steps."""

from __future__ import annotations

from collections.abc import Iterator
from math import gcd

import numpy as np
from numpy.typing import NDArray

from graphdyn.compiler.stepping.stepping import StepRange
from graphdyn.errors import IntegrationFailed, InvalidInput
from graphdyn.layout import Array
from graphdyn.simulation.equations import equations_of
from graphdyn.simulation.integration.compiled import (
    LostSteps,
    can_compile,
    compiled_steps,
    constants_of,
    fitting_lanes,
    ground_of,
    run_blocks,
    state_blocks,
)
from graphdyn.simulation.integration.events import COURSE_COLUMNS, InitialValueProblem, Rows, SimulatedCourse
from graphdyn.simulation.integration.scan import Scan
from graphdyn.simulation.integration.steps import python_steps, steps_of, tableau
from graphdyn.simulation.torques import (
    CONSTANT_TORQUE_STEPS,
    QUOTIENT_TOLERANCE,
    SMALLER_STEPS_REMEDY,
    whole_steps,
)

CHUNK_STEPS = 4096
"""Steps after which progress is reported and events are looked for."""

LOOP_CHUNK_STEPS = 64
"""The same for robots with loops, whose steps may take milliseconds."""


def fixed(problem: InitialValueProblem, method: str, step: float) -> SimulatedCourse:
    """Rows at the times asked for. Raises InvalidInput, IntegrationFailed."""
    plant, at = problem.plant, problem.at
    steps = whole_steps("the duration", problem.duration, step)
    wanted = np.arange(steps + 1) if at is None else _numbers_of_steps(at, step)
    scan = Scan(problem, method)
    every = 1 if problem.is_searched else max(gcd(*wanted.tolist()), 1)
    hold = problem.source.steps_held(step, steps)
    run = compiled_chunks if problem.source.function is None and can_compile(plant) else python_chunks
    parts, done = [], 0
    size = LOOP_CHUNK_STEPS if plant.model.chords else CHUNK_STEPS
    for stretch, rows in run(problem, method, stretches(steps, every, hold, step, size)):
        numbers = np.arange(-(-stretch.start // every) * every, stretch.start + stretch.count, every)
        times = numbers.astype(float) * step
        _refuse_infinite(times, rows)
        course = SimulatedCourse(times, rows)
        parts.append(scan.searched(course) if problem.is_searched else course)
        done = stretch.start + stretch.count
        problem.progress(min(done * step, problem.duration))
        if scan.ended:
            break
    whole = SimulatedCourse.joined(parts, scan.occurrences, scan.ended)
    if at is None or not len(whole.time):
        return whole
    last = whole.time[-1] if scan.ended else np.inf
    chosen = wanted[wanted * step <= last] // every
    if scan.ended and (not chosen.size or whole.time[chosen[-1]] < last):
        chosen = np.append(chosen, len(whole.time) - 1)
    return whole.rows(chosen)


def stretches(steps: int, every: int, hold: int, h: float, size: int = CHUNK_STEPS) -> Iterator[StepRange]:
    """Chunks of the steps 0 … steps, the last of which is for its record; each begins with a new torque if any does."""
    size = size if hold == CONSTANT_TORQUE_STEPS else -(-size // hold) * hold
    for first in range(0, steps + 1, size):
        yield StepRange(first, min(size, steps + 1 - first), every, hold, h)


def python_chunks(
    problem: InitialValueProblem, method: str, chunks: Iterator[StepRange]
) -> Iterator[tuple[StepRange, Rows]]:
    """Every chunk with its records."""
    equations, source, y = equations_of(problem.plant), problem.source, problem.state
    take = steps_of(equations, tableau(method), closed_stages=source.function is not None)
    for stretch in chunks:
        period = stretch.hold * stretch.h

        def held(tick: int, q: Array, v: Array, period: float = period) -> Array:
            return source.tau_from(tick * period, q, v)

        with np.errstate(over="ignore", invalid="ignore"):
            y, rows = python_steps(
                take, equations.clamped, stretch, y, source.tau_at, None if source.function else held
            )
        yield stretch, rows


def compiled_chunks(
    problem: InitialValueProblem, method: str, chunks: Iterator[StepRange]
) -> Iterator[tuple[StepRange, Rows]]:
    """The same from compiled steps."""
    plant, source, (q, v) = problem.plant, problem.source, problem.start
    steps = compiled_steps(plant, method, source.controller, lanes=fitting_lanes(1))
    state = state_blocks(steps, q[None], v[None])
    constants = constants_of(steps, plant, source.gains, 1)
    memory, lost = steps.memory(1), LostSteps(lambda run: steps_of(equations_of(plant), tableau(method)))
    for stretch in chunks:
        columns = source.columns(stretch.first_tick, stretch.ticks, stretch.hold * stretch.h)
        control = np.repeat(columns[None, :, :, None], steps.lanes, axis=-1)

        def repeated(first: int, last: int, control: Array = control) -> Array:
            return control

        records = run_blocks(
            steps,
            stretch,
            state,
            constants,
            repeated,
            lambda first, last: None,
            ground_of(plant, method, stretch, source.duration),
            memory,
            lost.taken,
            1,
            1,
        )
        yield stretch, {name: records[name][0] for name in COURSE_COLUMNS}


def _numbers_of_steps(at: Array, step: float) -> NDArray[np.int64]:
    numbers = np.round(at / step)
    apart = np.abs(at / step - numbers) > QUOTIENT_TOLERANCE * np.maximum(numbers, 1)
    if apart.any():
        raise InvalidInput(
            f"time {at[apart][0]:g} s of at is no multiple of the step, {step:g} s; take such times, or method 'dop853'"
        )
    return numbers.astype(np.int64)


def _refuse_infinite(times: Array, rows: Rows) -> None:
    finite = np.isfinite(rows["q"]).all(axis=-1) & np.isfinite(rows["v"]).all(axis=-1)
    if not finite.all():
        raise IntegrationFailed(
            f"at {times[int(np.argmin(finite))]:g} s the numbers are no longer finite; {SMALLER_STEPS_REMEDY}"
        )
