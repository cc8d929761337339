"""Scenarios: the points of a study's grid, each with a number made of its own values."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import product
from typing import Any

from crosscheck.study.settings.settings import Settings, not_negative, one_of, positive, whole, words
from graphdyn.identification.closed_loop import MAX_SIMULATION_STEP

MOTION_KINDS = ("random", "excited", "steps", "paper")
"""Kinds of references:

random: a Fourier series with random coefficients that reaches the limits; excited: one that is optimized within them
steps: from one random position to the next within half a second, then half a second at rest
paper: that of section 3.1, without the rail: the first two joints accelerate at 30°/s², the others stand still
"""

NORMAL = "normal"
"""The law of independent normal noise."""

PAPER_SECONDS = 2.0
"""Length of the paper's motion."""

MODEL_ERRORS = (
    "none", "friction", "gear", "payload", "flexible", "gains", "delay", "quantized", "stribeck", "lugre",
)  # fmt: skip
"""What the identification does not know of the robot:

friction: dry friction, which is not among the terms
gear: torques are recorded too large, by a wrong gear ratio or torque constant
payload: a load on the last link during the recording
flexible: a spring between motor and link in every joint; positions are those of the motors
gains: those of the controller are others than those known
delay: torques act one control period after they are commanded, and are recorded when they act
quantized: encoders, also for the controller, and currents have steps
stribeck: dry friction falls with speed, from a breakaway torque
lugre: it is the torque of soft bristles, which bend before the joint slides
"""

RATE_TOLERANCE = 1e-6
"""Two rates are multiples of each other where their quotient is this close to a whole number."""


@dataclass(frozen=True)
class Scenario:
    """One point of the grid. The names of the fields are those of the configuration and of the columns of tables.

    robot: label of one of the robots of the study
    position_noise: standard deviation of measured positions, which the controller sees as well   [rad or m]
    torque_noise: of measured torques, and of moments in the joints   [N m or N]
    force_noise: of forces in the joints; None: no wrenches are measured   [N]
    sampling_rate, control_rate: of the recording, of the controller   [Hz]
    torque_noise_law: "normal", or FILE.py:NAME, a function of a generator and the torques (N, n), which gives their
        noise with a standard deviation of one
    motion: kind of the reference (MOTION_KINDS), or FILE.py:NAME, a function of the robot model, its motion limits, a
        generator and the duration, which gives one motion law per joint; motion_seed: another one of the same kind
    duration: of the recording [s]
    cutoff: of the low-pass of positions, torques and regressor; None: no filter   [Hz]
    min_speed: rows of joints that are slower are left out   [rad/s or m/s]
    model_error: one of MODEL_ERRORS, or FILE.py:NAME, a function of q, v, a of the links (N, n), which gives the
        torques that actuators have to give beyond the model
    cad_error: largest relative error of the masses and centers of mass of the CAD model
    start: of iterations: "wls", "cad", or a number: relative standard deviation of the errors of all parameters
    """

    robot: str = ""
    position_noise: float = 1.75e-5
    torque_noise: float = 0.05
    force_noise: float | None = None
    torque_noise_law: str = NORMAL
    sampling_rate: float = 1000.0
    control_rate: float = 1000.0
    motion: str = "random"
    motion_seed: int = 0
    duration: float = 10.0
    cutoff: float | None = 50.0
    min_speed: float = 0.05
    model_error: str = "none"
    cad_error: float = 0.15
    start: str = "wls"

    @property
    def key(self) -> int:
        """A number made of all values, of 64 bits."""
        text = "\n".join(f"{field.name}={getattr(self, field.name)!r}" for field in fields(self))
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big")

    @cached_property
    def name(self) -> str:
        """The key in hexadecimal digits."""
        return f"{self.key:016x}"

    @property
    def start_error(self) -> float | None:
        """The start as a number; None where it is a word."""
        return None if self.start in STARTING_VALUES else float(self.start)

    @property
    def period(self) -> float:
        """Period of the samples [s]."""
        return 1 / self.sampling_rate

    @property
    def control_period(self) -> float:
        """[s]"""
        return 1 / self.control_rate

    @property
    def samples_per_tick(self) -> float:
        """Sampling rate over control rate; its inverse is whole, or it is itself."""
        return self.sampling_rate / self.control_rate


STARTING_VALUES = ("wls", "cad")


def _or_none(read: Callable[[object], float]) -> Callable[[object], float | None]:
    """TOML has no null: "none" stands for it."""

    def optional(value: object) -> float | None:
        if value == "none":
            return None
        try:
            return read(value)
        except ValueError as needed:
            raise ValueError(f'{needed}, or "none"') from None

    return optional


def _or_own(choices: Sequence[str]) -> Callable[[object], str]:
    """A reader of one of these words, or of FILE.py:NAME."""

    def read(value: object) -> str:
        where, _, name = value.rpartition(":") if isinstance(value, str) else ("", "", "")
        if where.endswith(".py") and name:
            return str(value)
        try:
            return one_of(choices)(value)
        except ValueError as needed:
            raise ValueError(f"{needed}, or FILE.py:NAME") from None

    return read


def _start(value: object) -> str:
    if isinstance(value, str) and value in STARTING_VALUES:
        return value
    try:
        return repr(_share(value))
    except ValueError:
        raise ValueError(
            'give "wls", "cad", or a number from 0 to below 1: the standard deviation of relative errors'
        ) from None


def _share(value: object) -> float:
    if not_negative(value) < 1:
        return not_negative(value)
    raise ValueError("give a number from 0 to below 1")


GRID_AXES: dict[str, Callable[[object], Any]] = {
    "robot": words,
    "position_noise": not_negative,
    "torque_noise": not_negative,
    "force_noise": _or_none(not_negative),
    "torque_noise_law": _or_own((NORMAL,)),
    "sampling_rate": positive,
    "control_rate": positive,
    "motion": _or_own(MOTION_KINDS),
    "motion_seed": whole(0),
    "duration": positive,
    "cutoff": _or_none(positive),
    "min_speed": not_negative,
    "model_error": _or_own(MODEL_ERRORS),
    "cad_error": _share,
    "start": _start,
}
"""The axes of the grid, and what reads one value of each."""


def scenarios(common: Settings, grids: Sequence[Settings], robots: Sequence[str]) -> tuple[Scenario, ...]:
    """All scenarios, in the order of the file, each once. Raises BadConfiguration.

    common: values of all scenarios; grids: a value or a list of values for each axis, all combinations of them
    robots: labels of all robots, which take part where an axis does not choose some
    """
    shared = {name: common.take(name, getattr(Scenario, name), read) for name, read in GRID_AXES.items()}
    common.refuse_others()
    found: dict[Scenario, None] = {}
    for grid in grids:
        for values in _combinations(grid, shared, robots):
            scenario = Scenario(**values)
            if scenario.robot not in robots:
                raise grid.error("robot", f"is '{scenario.robot}'; the labels of the robots are: {', '.join(robots)}")
            _check(grid, scenario)
            found[scenario] = None
    return tuple(found)


def _combinations(grid: Settings, shared: Mapping[str, Any], robots: Sequence[str]) -> Iterator[dict[str, Any]]:
    given = {name: [value] for name, value in shared.items()}
    given["robot"] = [shared["robot"]] if shared["robot"] else list(robots)
    axes = {name: grid.take(name, given[name], _several(read)) for name, read in GRID_AXES.items()}
    grid.refuse_others()
    for values in product(*axes.values()):
        yield dict(zip(axes, values, strict=True))


def _several(read: Callable[[object], Any]) -> Callable[[object], list[Any]]:
    def values(value: object) -> list[Any]:
        if value == []:
            raise ValueError("give one value, or a list of them")
        return [read(one) for one in value] if isinstance(value, list) else [read(value)]

    return values


def _check(grid: Settings, scenario: Scenario) -> None:
    """Raises BadConfiguration for values that do not fit together."""
    ratio = max(scenario.samples_per_tick, 1 / scenario.samples_per_tick)
    if abs(ratio - round(ratio)) > RATE_TOLERANCE:
        raise grid.error(
            "control_rate",
            f"is {scenario.control_rate:g} Hz with a sampling_rate of {scenario.sampling_rate:g} Hz; one must be a "
            "multiple of the other",
        )
    samples = scenario.duration * scenario.sampling_rate
    if abs(samples - round(samples)) > RATE_TOLERANCE * samples:
        raise grid.error(
            "duration",
            f"is {scenario.duration:g} s with a sampling_rate of {scenario.sampling_rate:g} Hz; give a whole number of "
            "samples",
        )
    if scenario.cutoff is not None and scenario.cutoff >= scenario.sampling_rate / 2:
        raise grid.error(
            "cutoff",
            f"is {scenario.cutoff:g} Hz with a sampling_rate of {scenario.sampling_rate:g} Hz; it must be below half "
            "of that",
        )
    if scenario.motion == "paper" and scenario.duration > PAPER_SECONDS:
        raise grid.error(
            "duration", f'is {scenario.duration:g} s; the motion "paper" lasts {PAPER_SECONDS:g} s: give no more'
        )
    if scenario.duration < 10 * max(scenario.period, scenario.control_period, MAX_SIMULATION_STEP):
        raise grid.error("duration", f"is {scenario.duration:g} s; give ten samples and control periods or more")
