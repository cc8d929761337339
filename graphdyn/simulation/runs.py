"""The runs of a rollout, in compiled blocks or one after the other in Python."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.compiler.native import host_lanes
from graphdyn.compiler.stepping.stepping import StepRange, in_blocks
from graphdyn.layout import Array
from graphdyn.simulation.equations import Equations
from graphdyn.simulation.integration.compiled import (
    compiled_steps,
    constants_of,
    fitting_lanes,
    ground_of,
    run_blocks,
    state_blocks,
)
from graphdyn.simulation.integration.events import COURSE_COLUMNS
from graphdyn.simulation.integration.steps import python_steps, tableau
from graphdyn.simulation.plant import PlantConstants, finite, per_joint
from graphdyn.simulation.torques import GAIN_NAMES, ComputedTorqueControl, Controller, Torques


@dataclass(frozen=True, eq=False)
class MeasurementNoise:
    """Standard deviations of independent normal noise on the q and v that a controller sees, new at every sample.

    position, velocity                                      () or (n,)  [rad or m, …/s]
    """

    position: ArrayLike = 0.0
    velocity: ArrayLike = 0.0


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
        steps = compiled_steps(self.plant, self.method, self.controller, noisy, lanes)
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

        def held(tick: int, q: Array, v: Array) -> Array:
            if source is None:
                columns = self._columns(run, run + 1)[0]
                return np.asarray(columns[min(tick, len(columns) - 1)])
            error = noise[min(tick, len(noise) - 1)]
            return source.tau_from(min(tick * period, self.end), q + error[: len(q)], v + error[len(q) :])

        state = {"q": self.q[run], "v": self.v[run], "work": np.zeros(1), "loss": np.zeros(1)}
        equations = Equations(self.plant.of_run(run))
        with np.errstate(over="ignore", invalid="ignore"):
            rows = python_steps(equations, tableau(self.method), self.stretch, state, _no_torque, held)
        return {name: np.array(rows[name]).reshape(self.stretch.records, -1) for name in COURSE_COLUMNS}

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


def _no_torque(t: float, q: Array, v: Array) -> Array:
    """The torque of stages, where it is held."""
    raise AssertionError("a held torque is not asked for between its samples")
