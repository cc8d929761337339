"""Steps of fixed width in compiled code: from a plant and a controller to blocks of robots, and back to arrays."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from graphdyn.compiler.batch import ground_columns
from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.native import compiling, host_lanes
from graphdyn.compiler.running import MAX_COMPILED_LENGTH, chosen_backend, in_threads
from graphdyn.compiler.simulated import Inputs, in_joint_axes, record_accelerations, record_closing, record_law
from graphdyn.compiler.stepping.layout import ClosingCode, StepCode, places
from graphdyn.compiler.stepping.stepping import CompiledSteps, StepRange, in_blocks, out_of_blocks
from graphdyn.experiments.experiment import base_motion
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.scalars.expressions import Program
from graphdyn.simulation.equations import LAST_STEP_GAP, MAX_PROJECTION_STEPS, LoopEquations
from graphdyn.simulation.integration.events import COURSE_COLUMNS
from graphdyn.simulation.integration.steps import Compiled, Stepped, Tableau, Take, near_pose, tableau
from graphdyn.simulation.plant import PlantConstants
from graphdyn.simulation.torques import CONSTANT_TORQUE_STEPS, ComputedTorqueControl, Controller

BLOCK_BYTES = 1 << 26
"""Bytes of torques, noise and records of the blocks that a thread has in hand at once, roughly."""

_programs: WeakKeyDictionary[RobotModel, dict[Inputs, Program]] = WeakKeyDictionary()
_compiled: WeakKeyDictionary[RobotModel, dict[tuple[Any, ...], CompiledSteps]] = WeakKeyDictionary()


def can_compile(plant: PlantConstants) -> bool:
    """Whether compiled steps can take this plant on this back end."""
    if chosen_backend() != "llvm" or plant.wrenches is not None:
        return False
    return _accelerations(plant.model, _inputs(plant)).length <= MAX_COMPILED_LENGTH


def _accelerations(model: RobotModel, inputs: Inputs) -> Program:
    """The program, recorded once per robot."""
    with compiling:
        known = _programs.setdefault(model, {})
        if inputs not in known:
            known[inputs] = record_accelerations(model, inputs, _near_pose(model) if model.chords else 0.0)
        return known[inputs]


def _closing(model: RobotModel) -> ClosingCode | None:
    """What closes the loops after every step as LoopEquations.closed does."""
    if not model.chords:
        return None
    return ClosingCode(*record_closing(model, _near_pose(model), LAST_STEP_GAP), MAX_PROJECTION_STEPS)


def _near_pose(model: RobotModel) -> float:
    return near_pose(LoopEquations(PlantConstants(model, {})))


def compiled_steps(
    plant: PlantConstants,
    method: str,
    controller: Controller | None,
    noisy: bool = False,
    lanes: int | None = None,
    late: bool = False,
) -> CompiledSteps:
    """The machine code, compiled once per robot and choice of what there is beside the rigid bodies."""
    lanes = lanes or host_lanes()
    nominal = controller.nominal if isinstance(controller, ComputedTorqueControl) else None
    law = controller.law if controller else None
    inputs = _inputs(plant)
    there = (plant.has_friction, plant.has_stops, plant.is_clamped, plant.has_bristles, plant.is_rounded)
    key = (method, inputs, law, nominal, noisy, late, there, lanes)
    with compiling:
        known = _compiled.setdefault(plant.model, {})
        if key not in known:
            own: Tableau = tableau(method)
            known[key] = CompiledSteps(
                StepCode(
                    n=plant.model.nv,
                    accelerations=_accelerations(plant.model, inputs),
                    law=record_law(nominal or plant.model, law) if law else None,
                    a=own.a,
                    b=own.b,
                    friction=plant.has_friction,
                    stops=plant.has_stops,
                    clamped=plant.is_clamped,
                    noisy=noisy,
                    bristles=plant.has_bristles,
                    rounded=plant.is_rounded,
                    late=late,
                    closing=_closing(plant.model),
                ),
                lanes,
            )
        return known[key]


def _inputs(plant: PlantConstants) -> Inputs:
    there = plant.constants
    return Inputs(
        external="external_wrenches" in there,
        moving_base=bool(plant.base),
        parameters="parameters" in there,
        rotor="rotor" in there,
        free=plant.sticks,
    )


def fitting_lanes(runs: int) -> int:
    """The narrowest vectors that hold all runs: one robot alone is faster in short ones."""
    return min([lanes for lanes in (2, 4, 8) if lanes >= runs] + [host_lanes()])


def constants_of(steps: CompiledSteps, plant: PlantConstants, gains: Array | None, runs: int) -> Array:
    """The constants in blocks; gains (runs, 2 n) of the controller."""
    known = dict(plant.constants)
    if gains is not None:
        known["gains"] = gains
    if "parameters" in known:
        known["parameters"] = in_joint_axes(plant.model, known["parameters"])
    widths = steps.what.constants
    columns = {name: np.broadcast_to(known[name], (runs, widths[name])) for name in widths}
    return in_blocks(columns, widths, runs, steps.lanes)


def ground_of(plant: PlantConstants, method: str, stretch: StepRange, end: float) -> Array | None:
    """The motion of the base at every stage (steps, stages, columns), up to an end; None where it is at rest."""
    if not plant.base:
        return None
    stages = tableau(method).c
    steps = np.arange(stretch.start, stretch.start + stretch.count)
    times = np.minimum((steps[:, None] + stages) * stretch.h, end).ravel()
    columns = ground_columns(plant.model, base_motion(plant.base, times), times.shape)
    return np.ascontiguousarray(columns).reshape(len(steps), len(stages), -1)


def run_blocks(
    steps: CompiledSteps,
    stretch: StepRange,
    state: Array,
    constants: Array,
    control: Callable[[int, int], Array],
    noise: Callable[[int, int], Array | None],
    ground: Array | None,
    memory: Array,
    otherwise: Otherwise,
    runs: int,
    threads: int | None,
) -> dict[str, Array]:
    """Advance all blocks of a state in place; the recorded columns by name (runs, records, width).

    control, noise: of the runs first … last - 1, in blocks
    otherwise: takes the steps that compiled code does not
    """
    lanes, widths, held = steps.lanes, steps.what.record, places(steps.what.memory)["tau"]
    blocks, columns = len(state), sum(widths.values())
    records = {name: np.empty((runs, stretch.records, width)) for name, width in widths.items()}
    one = 8 * lanes * (stretch.records * columns + stretch.ticks * sum(steps.what.control.values()))
    size = max(1, min(BLOCK_BYTES // max(one, 1), -(-blocks // 64) if blocks > 64 else 1))
    ends = [*range(0, blocks, size), blocks]

    def work(first: int, last: int) -> None:
        of_runs = (first * lanes, min(last * lanes, runs))
        torques, noises = control(*of_runs), noise(*of_runs)
        record = np.empty((last - first, stretch.records, columns, lanes))
        own = slice(first, last)

        def lost(block: int, lane: int, step: int) -> None:
            run, y = (first + block) * lanes + lane, state[first + block]
            if run >= runs:  # the last run fills the last block
                y[:, lane] = y[:, (runs - 1) % lanes]
                return
            tau = memory[first + block, held : held + steps.what.n, lane]
            y[:, lane], row = otherwise(run, step * stretch.h, y[:, lane].copy(), stretch.h, tau.copy())
            if step % stretch.every == 0:
                record[block, step // stretch.every - -(-stretch.start // stretch.every), :, lane] = row

        steps.run(stretch, state[own], constants[own], torques, noises, ground, record, memory[own], lost)
        for name, rows in out_of_blocks(record, widths, of_runs[1] - of_runs[0]).items():
            records[name][of_runs[0] : of_runs[1]] = rows

    in_threads(work, list(pairwise(ends)), threads)
    return records


Otherwise = Callable[[int, float, Array, float, Array], tuple[Array, Array]]
"""A function of the number of a run, t, y, h and the torque: y a time h later, and the row of COURSE_COLUMNS before."""


def single_steps(plant: PlantConstants, method: str, errors: Array) -> Compiled:
    """Compiled steps of robots with loops, one after the other: their widths may differ.

    errors: further weights of the stages                   (k, s)
    """
    steps = compiled_steps(plant, method, None, lanes=fitting_lanes(1))
    n, columns, stages, lost = plant.model.nv, steps.what.record, tableau(method).c, list[int]()
    first = places(steps.what.memory)["rates"]
    state, record = aligned((1, 2 * n + 2, steps.lanes)), aligned((1, 1, sum(columns.values()), steps.lanes))
    constants, memory, control = constants_of(steps, plant, None, 1), steps.memory(1), aligned((1, 1, n, steps.lanes))

    def taken(t: float, y: Array, h: float, tau: Array) -> tuple[Stepped, dict[str, Array]] | None:
        lost.clear()
        state[:], control[:] = y[:, None], tau[:, None]
        times, ground = t + stages * h, None
        if plant.base:
            ground = ground_columns(plant.model, base_motion(plant.base, times), times.shape)[None]
        stretch = StepRange(0, 1, 1, CONSTANT_TORQUE_STEPS, h)
        steps.run(stretch, state, constants, control, None, ground, record, memory, lambda *step: lost.append(0))
        if lost:
            return None
        rates = memory[0, first:, 0].reshape(len(stages), -1)
        row = {name: rows[0, 0] for name, rows in out_of_blocks(record.copy(), columns, 1).items()}
        return Stepped(state[0, :, 0].copy(), np.inf, h * errors @ rates), row

    return taken


class LostSteps:
    """The steps that compiled code does not take, near singular poses and where loops do not close."""

    def __init__(self, steps: Callable[[int], Take]) -> None:
        """steps: those of a run."""
        self._steps, self._runs = steps, dict[int, Take]()

    def taken(self, run: int, t: float, y: Array, h: float, tau: Array) -> tuple[Array, Array]:
        """Take a step of a run, as an Otherwise."""
        if run not in self._runs:
            self._runs[run] = self._steps(run)
        with np.errstate(over="ignore", invalid="ignore"):
            after, row = self._runs[run](t, y, h, lambda t, q, v: tau)
        return after, np.concatenate([row[name] for name in COURSE_COLUMNS])


def state_blocks(steps: CompiledSteps, q: Array, v: Array) -> Array:
    """q, v (runs, n) in blocks, with no work done yet."""
    nothing = np.zeros((len(q), 1))
    return in_blocks({"q": q, "v": v, "work": nothing, "loss": nothing}, steps.what.state, len(q), steps.lanes)
