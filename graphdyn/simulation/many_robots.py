"""Many robots at once: every run is a lane of compiled code, with parameters and noise of its own.

Without compiled code, the runs are computed one after the other in Python.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats, joint_arrays
from graphdyn.compiler.batch import check_threads
from graphdyn.compiler.native import host_lanes
from graphdyn.compiler.stepping.stepping import StepRange, in_blocks
from graphdyn.display import short_repr
from graphdyn.equations.loops.dynamics import closed
from graphdyn.errors import InvalidInput
from graphdyn.experiments.experiment import BaseMotionLaw
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.simulation.equations import Equations, LoopEquations
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
from graphdyn.simulation.integration.events import COURSE_COLUMNS
from graphdyn.simulation.integration.steps import FIXED_STEPS, LoopSteps, Take, python_steps, steps_of, tableau
from graphdyn.simulation.plant import Bristles, Friction, JointStops, PlantConstants, finite, make_plant, per_joint
from graphdyn.simulation.torques import (
    CONSTANT_TORQUE_STEPS,
    GAIN_NAMES,
    ComputedTorqueControl,
    Controller,
    Torques,
    check_controller,
    whole_steps,
)


@dataclass(frozen=True, eq=False)
@short_repr
class MeasurementNoise:
    """Standard deviations of independent normal noise on the q and v that a controller sees, new at every sample.

    position, velocity                                      () or (n,)  [rad or m, …/s]
    resolution: of an encoder, to whose multiples the positions are rounded after the noise; 0: none   () or (n,)
    """

    position: ArrayLike = 0.0
    velocity: ArrayLike = 0.0
    resolution: ArrayLike = 0.0


@dataclass(frozen=True, eq=False)
class Runs:
    """All runs; torques (R, T, n), each held as the stretch says."""

    plant: PlantConstants
    q: Array
    v: Array
    torques: Array | None
    controller: Controller | None
    noise: MeasurementNoise | None
    seed: int
    stretch: StepRange
    method: str
    late: bool = False

    @property
    def runs(self) -> int:
        return len(self.q)

    @property
    def end(self) -> float:
        return (self.stretch.count - 1) * self.stretch.h

    def compiled(self, threads: int | None) -> dict[str, Array]:
        """The recorded columns (runs, records, width)."""
        lanes = min(fitting_lanes(self.runs), host_lanes())
        noisy = self.noise is not None and self.controller is not None
        steps = compiled_steps(self.plant, self.method, self.controller, noisy, lanes, self.late)
        widths, state = steps.what.control, state_blocks(steps, self.q, self.v)
        ((name, width),) = widths.items()
        gains = None if self.controller is None else self._gains()

        def control(first: int, last: int) -> Array:
            columns = np.broadcast_to(self._columns(first, last), (last - first, self.stretch.ticks, width))
            return in_blocks({name: columns}, widths, last - first, lanes)

        def noises(first: int, last: int) -> Array | None:
            if not noisy:
                return None
            drawn = np.stack([self._noise(run) for run in range(first, last)])
            return in_blocks({"noise": drawn}, {"noise": drawn.shape[-1]}, last - first, lanes)

        return run_blocks(
            steps,
            self.stretch,
            state,
            constants_of(steps, self.plant, gains, self.runs),
            control,
            noises,
            ground_of(self.plant, self.method, self.stretch, self.end),
            steps.memory(len(state)),
            LostSteps(lambda run: self._steps(self._equations(run))).taken,
            self.runs,
            threads,
        )

    def in_python(self) -> dict[str, Array]:
        """The same run by run, without compiled steps."""
        found = [self._python_run(run) for run in range(self.runs)]
        return {name: np.stack([rows[name] for rows in found]) for name in COURSE_COLUMNS}

    def _python_run(self, run: int) -> dict[str, Array]:
        model, period = self.plant.model, self.stretch.hold * self.stretch.h
        noise = self._noise(run) if self.noise is not None else np.zeros((1, 2 * model.nv))
        source = None
        if self.controller is not None:
            own: Any = dict(zip(GAIN_NAMES, np.split(self._gains()[run], 2), strict=True))
            if isinstance(self.controller, ComputedTorqueControl):
                own["nominal"] = self.controller.nominal or model
            source = Torques(model, self.end, controller=replace(self.controller, **own))

        ordered = list[Array]()

        def held(tick: int, q: Array, v: Array) -> Array:
            if source is None:
                columns = self._columns(run, run + 1)[0]
                return np.asarray(columns[min(tick, len(columns) - 1)])
            error = noise[min(tick, len(noise) - 1)]
            seen = rounded(q + error[: len(q)], equations.plant.constants.get("resolution", np.zeros(len(q))))
            ordered.append(source.tau_from(min(tick * period, self.end), seen, v + error[len(q) :]))
            return ordered[max(len(ordered) - 2, 0)] if self.late else ordered[-1]

        y = np.concatenate([self.q[run], self.v[run], np.zeros(2)])
        equations = self._equations(run)
        with np.errstate(over="ignore", invalid="ignore"):
            _, rows = python_steps(self._steps(equations), equations.clamped, self.stretch, y, _no_torque, held)
        return rows

    def _equations(self, run: int) -> Equations:
        plant = self.plant.of_run(run)
        return LoopEquations(plant, self.plant.model) if plant.model.chords else Equations(plant)

    def _steps(self, equations: Equations) -> Take:
        own = tableau(self.method)
        return (
            LoopSteps(equations, own).taken_or_nan if isinstance(equations, LoopEquations) else steps_of(equations, own)
        )

    def _columns(self, first: int, last: int) -> Array:
        """Torques or references of the ticks, (runs or 1, ticks, width); the last torque stays."""
        ticks = np.arange(self.stretch.ticks)
        if self.torques is not None:
            return np.asarray(self.torques[first:last, np.minimum(ticks, self.torques.shape[1] - 1)])
        model = self.plant.model
        if self.controller is None:
            return np.zeros((1, len(ticks), model.nv))
        source = Torques(model, self.end, controller=self.controller)
        return source.columns(0, len(ticks), self.stretch.hold * self.stretch.h)[None]

    def _gains(self) -> Array:
        """K_p and K_d of every run (runs, 2 n)."""
        assert self.controller is not None
        model, runs = self.plant.model, self.runs
        return np.concatenate(
            [per_joint(name, getattr(self.controller, name), model, runs) for name in GAIN_NAMES], axis=-1
        )

    def _noise(self, run: int) -> Array:
        """On q and v at every tick (ticks, 2 n), of a generator that depends on the seed and the run."""
        assert self.noise is not None
        model = self.plant.model
        deviations = np.concatenate(
            [per_joint(name, finite(name, getattr(self.noise, name)), model) for name in ("position", "velocity")]
        )
        generator = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(run,)))
        return np.asarray(generator.standard_normal((self.stretch.ticks, len(deviations))) * deviations)


def rounded(values: Array, resolution: ArrayLike) -> Array:
    """The nearest multiples of a resolution; where that is zero, the values."""
    unit = np.where(np.asarray(resolution) > 0, resolution, 1.0)
    return np.where(np.asarray(resolution) > 0, np.rint(values / unit) * unit, values)


def _no_torque(t: float, q: Array, v: Array) -> Array:
    """The torque of stages, where it is held."""
    raise AssertionError("a held torque is not asked for between its samples")


@dataclass(frozen=True, eq=False)
@short_repr
class Rollout:
    """Motions of R runs at K times; numbers that overflow stay in their run, as NaN or infinity.

    time                                                    (K,)       [s]
    q, v, a: joint positions, velocities, accelerations     (R, K, n)  [rad or m, …/s, …/s²]
    tau: of the actuators, within their limits              (R, K, n)  [N m or N]
    passive: torque of friction and stops on the joints     (R, K, n)  [N m or N]
    """

    time: Array
    q: Array
    v: Array
    a: Array
    tau: Array
    passive: Array


def rollout(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    controls: ArrayLike | Controller | None = None,
    *,
    step: float,
    duration: float | None = None,
    period: float | None = None,
    method: Literal["rk8", "rk4", "euler"] = "rk4",
    parameters: ArrayLike | None = None,
    friction: Friction | Literal["model"] | None = None,
    rotor_inertia: ArrayLike | None = None,
    limits: JointStops | None = None,
    bristles: Bristles | None = None,
    torque_limits: ArrayLike | Literal["model"] | None = None,
    external_wrenches: ArrayLike | None = None,
    base: BaseMotionLaw | Sequence[BaseMotionLaw] = (),
    noise: MeasurementNoise | None = None,
    seed: int = 0,
    late: bool = False,
    every: int = 1,
    threads: int | None = None,
) -> Rollout:
    """Motions of many robots that differ in state, torques or parameters; steps of fixed width, in compiled code.

    The number R of runs is that of the leading dimension of q, v and controls, which broadcast. A run comes out the
    same, bit for bit, with any number of threads.

    q, v: states at time zero                               (n,) or (R, n)  [rad or m, …/s]
    controls: torques (T, n) or (R, T, n), each held for a period; PDControl or ComputedTorqueControl, whose gains may
        be (R, n); None for no torque  [N m or N]
    step: width of the steps                                [s]
    duration: where torques do not say it: it is T periods then   [s]
    period: how long each torque is held; one step if left out; of a controller its own   [s]
    parameters: inertial parameters of each run, which need no compiling   (10 n,) or (R, 10 n)
    friction, rotor_inertia, torque_limits: as in simulate, with arrays () or (n,) or (R, n)
    limits: springs at the position limits
    bristles: dry friction by another law than that of friction
    external_wrenches: constant                             (n, 6) or (R, n, 6)  [N, N m]
    base: motion of the moving base, the same for all runs
    noise, seed: what the controller measures beside q and v; each run has a generator of its own
    late: whether the torque of a controller acts one period later; the first one acts at once too
    every: only every so manieth step is kept, the first included
    threads: at most this many; None for one per core

    Angles are accurate up to 1e6 rad. Numbers of robots whose mass matrix is singular come out as NaN or infinity.

    Robots with loops start closed, as in simulate. A run whose loops come apart is NaN from there on. Steps near
    singular poses are taken in Python.

    Raises InvalidInput; InconsistentState where loops are open. On the NumPy back end, steps are taken in Python,
    thousands of times slower; bristles need compiled steps, of trees.

    >>> import graphdyn, numpy as np
    >>> starts = np.linspace(-0.5, 0.5, 5)[:, None] * np.ones(6)  # five robots
    >>> motions = graphdyn.rollout(graphdyn.kr500(), starts, np.zeros(6), step=0.01, duration=0.05)
    >>> motions.q.shape  # runs, times, joints
    (5, 6, 6)
    """
    check_model(model)
    check_threads(threads)
    if method not in FIXED_STEPS:
        raise InvalidInput(f"method is '{method}'; use one of {', '.join(FIXED_STEPS)}")
    if not (step > 0 and np.isfinite(step)):
        raise InvalidInput(f"step is {step!r}; give seconds above zero")
    if every < 1:
        raise InvalidInput(f"every is {every!r}; give a number of steps from 1 on")
    x = joint_arrays(model, q=q, v=v)
    if x["q"].ndim > 2:
        raise InvalidInput(f"q and v have {x['q'].ndim - 1} leading dimensions; give one, that of the runs")
    torques = _controls(model, controls)
    runs = _runs(x["q"], torques, controls)
    hold, steps = _times(controls, torques, step, duration, period)
    plant = make_plant(
        model,
        runs=runs,
        friction=friction,
        rotor_inertia=rotor_inertia,
        limits=limits,
        bristles=bristles,
        resolution=0.0 if noise is None else noise.resolution,
        torque_limits=torque_limits,
        external_wrenches=external_wrenches,
        parameters=parameters,
        base=base,
    )
    if model.chords:
        closed(model, x["q"], x["v"])
        x["q"], x["v"] = LoopEquations(PlantConstants(model, {})).started(x["q"], x["v"])
    all_runs = Runs(
        plant=plant,
        q=np.broadcast_to(x["q"], (runs, model.nv)),
        v=np.broadcast_to(x["v"], (runs, model.nv)),
        torques=None if torques is None else np.broadcast_to(torques, (runs, *torques.shape[1:])),
        controller=controls if isinstance(controls, Controller) else None,
        noise=noise,
        seed=seed,
        stretch=StepRange(0, steps + 1, every, hold, step),
        method=method,
        late=late,
    )
    if bristles is not None and (model.chords or not can_compile(plant)):
        raise InvalidInput(
            f"bristles need compiled steps of a tree, which robot '{model.name}' has not here; leave them out"
        )
    rows = all_runs.compiled(threads) if can_compile(plant) else all_runs.in_python()
    time = np.arange(0, steps + 1, every).astype(float) * step
    return Rollout(time, rows["q"], rows["v"], rows["a"], rows["tau"], rows["passive"])


def _controls(model: RobotModel, controls: ArrayLike | Controller | None) -> Array | None:
    """Torques (R or 1, T, n); None where there are none, or a controller makes them."""
    if controls is None:
        return None
    if isinstance(controls, Controller):
        check_controller(controls, model)
        return None
    torques = finite("controls", as_floats("controls", controls))
    if torques.ndim not in (2, 3) or torques.shape[-1] != model.nv or torques.shape[-2] == 0:
        raise InvalidInput(
            f"controls has shape {torques.shape}, expected (T, {model.nv}) or (R, T, {model.nv}) "
            f"for robot '{model.name}'"
        )
    return torques if torques.ndim == 3 else torques[None]


def _runs(q: Array, torques: Array | None, controls: ArrayLike | Controller | None) -> int:
    counts = {"q and v": len(q) if q.ndim == 2 else 1, "controls": 1 if torques is None else len(torques)}
    if isinstance(controls, Controller):
        gains = [as_floats(name, getattr(controls, name)) for name in GAIN_NAMES]
        counts["the gains"] = max(len(gain) if gain.ndim == 2 else 1 for gain in gains)
    several = {name: count for name, count in counts.items() if count != 1}
    if len(set(several.values())) > 1:
        raise InvalidInput(f"numbers of runs differ: {', '.join(f'{name} {count}' for name, count in several.items())}")
    return max(several.values(), default=1)


def _times(
    controls: ArrayLike | Controller | None,
    torques: Array | None,
    step: float,
    duration: float | None,
    period: float | None,
) -> tuple[int, int]:
    """The number of steps many steps a torque is held, and the number of steps."""
    if isinstance(controls, Controller):
        if period is not None:
            raise InvalidInput("a controller has a period of its own; omit period")
        hold = 1 if controls.period is None else whole_steps("the period of the controller", controls.period, step)
    else:
        hold = 1 if period is None else whole_steps("the period", period, step)
    if torques is not None:
        if duration is not None:
            raise InvalidInput("the torques say how long it lasts: as many periods as there are; omit duration")
        return hold, hold * torques.shape[1]
    if duration is None or not (duration > 0 and np.isfinite(duration)):
        raise InvalidInput(f"duration is {duration!r}; give seconds above zero")
    return (hold if isinstance(controls, Controller) else CONSTANT_TORQUE_STEPS), whole_steps(
        "the duration", duration, step
    )
