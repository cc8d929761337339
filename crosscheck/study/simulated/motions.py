"""Reference motions of a study: random, optimized, in steps, and that of the paper."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from crosscheck.exciting.excited import assumed_noise
from crosscheck.study.settings.design import Stream
from crosscheck.study.settings.scenarios import MOTION_KINDS
from crosscheck.study.settings.settings import RobotSettings
from crosscheck.study.simulated.own_code import own
from crosscheck.study.simulated.plants import ControlledRobot, generator, plant_of
from graphdyn import InvalidInput
from graphdyn.excitation import ExcitationProblem, FourierBasis, Trajectory, frame_origins, optimized, random_trajectory
from graphdyn.layout import Array
from graphdyn.motion_laws import ConstantAcceleration, Course, Locked, MotionLaw

MOTION_PERIOD, HARMONICS = 10.0, 5
"""Period and harmonics of Fourier series, which repeat in longer recordings [s]."""

MIN_MOTION_RANGE = 1e-9
"""A motion that goes no further is none [rad or m]."""

OPTIMIZED_RATE = 500.0
"""Samples per second of the recording for which a motion is optimized [Hz]."""

STEP_PERIOD = 1.0
"""Time from one step to the next [s]; the robot moves in the first half."""

PAPER_ACCELERATION = np.radians(30.0)
"""Acceleration of the first joint, and backwards of the second [rad/s²]."""

QUINTIC_SPEED, QUINTIC_ACCELERATION = 1.875, 5.7735
"""Largest |v| T / Δ and |a| T² / Δ of the quintic from rest to rest over Δ in the time T: 15/8 and 10/√3."""


CHECKED_TIMES = 3
"""Times at which a law of one's own is looked at."""

MOTION_STREAM = 2
"""Number of a random stream of a study."""


@lru_cache(maxsize=8)
def reference(
    settings: RobotSettings, seed: int, kind: str, number: int, duration: float, stream: Stream = (0, 0)
) -> tuple[MotionLaw, ...]:
    """One law per joint.

    kind: one of MOTION_KINDS, or FILE.py:NAME with the whole path
    seed: of the study; number, stream: which of the motions of this kind; duration: of the recording [s]

    Raises InvalidInput where the limits allow no motion, and for an own motion that is none.
    """
    plant = plant_of(settings)
    if ":" in kind:
        rng = generator(seed, MOTION_STREAM, len(MOTION_KINDS), number, *stream)
        laws = tuple(own(kind)(plant.model, plant.limits, rng, duration))
        if len(laws) != plant.model.nv or not all(callable(law) for law in laws):
            raise InvalidInput(f"{kind} gives {len(laws)} laws for {plant.model.nv} joints; give one function for each")
        times = np.linspace(0.0, duration, CHECKED_TIMES)
        for joint, law in zip(plant.model.independent_joints, laws, strict=True):
            course = [np.asarray(part) for part in law(times)]
            if [part.shape for part in course] != 3 * [times.shape] or not np.isfinite(course).all():
                raise InvalidInput(f"{kind}: the law of '{joint}' gives no q, v and a (N,) of times (N,), finite")
        return laws
    rng = generator(seed, MOTION_STREAM, MOTION_KINDS.index(kind), number, *stream)
    return _MOTION_MAKERS[kind](plant, rng, duration)


def start_of(laws: Sequence[MotionLaw]) -> tuple[Array, Array]:
    """q, v (n,) at time zero."""
    courses = [law(np.zeros(1)) for law in laws]
    return np.array([q[0] for q, _, _ in courses]), np.array([v[0] for _, v, _ in courses])


def _random(plant: ControlledRobot, rng: np.random.Generator, duration: float) -> tuple[MotionLaw, ...]:
    basis, spheres = FourierBasis(min(duration, MOTION_PERIOD), HARMONICS), frame_origins(plant.model)
    found = random_trajectory(plant.model, plant.limits, spheres, basis, rng)
    if np.ptp(found.motion(np.linspace(0.0, basis.duration)).q, axis=0).max() < MIN_MOTION_RANGE:
        raise InvalidInput(
            f"no random motion found: robot '{plant.model.name}' cannot be held with the efforts that its file states; "
            "correct them, or leave them out"
        )
    return _repeated(found)


def _excited(plant: ControlledRobot, rng: np.random.Generator, duration: float) -> tuple[MotionLaw, ...]:
    """A motion optimized for equal shares of noise in the torques of all joints, whatever the noise of the scenario."""
    torque_model = plant.known_exactly
    basis = FourierBasis(min(duration, MOTION_PERIOD), HARMONICS)
    problem = ExcitationProblem(torque_model, plant.limits, basis, assumed_noise(plant.model)[0], OPTIMIZED_RATE)
    return _repeated(optimized(problem, int(rng.integers(2**31))).trajectory)


def _steps(plant: ControlledRobot, rng: np.random.Generator, duration: float) -> tuple[MotionLaw, ...]:
    limits, moving = plant.limits, STEP_PERIOD / 2
    farthest = np.minimum(
        limits.velocity * moving / QUINTIC_SPEED, limits.acceleration * moving**2 / QUINTIC_ACCELERATION
    )
    lower, upper = np.maximum(limits.lower, -np.pi), np.minimum(limits.upper, np.pi)
    positions = [np.clip(np.zeros(len(lower)), lower, upper)]
    for _number in range(int(np.ceil(duration / STEP_PERIOD))):
        here = positions[-1]
        positions.append(rng.uniform(np.maximum(lower, here - farthest), np.minimum(upper, here + farthest)))
    return tuple(Steps(tuple(course)) for course in np.transpose(positions).tolist())


def _paper(plant: ControlledRobot, rng: np.random.Generator, duration: float) -> tuple[MotionLaw, ...]:
    laws: list[MotionLaw] = [ConstantAcceleration(PAPER_ACCELERATION), ConstantAcceleration(-PAPER_ACCELERATION)]
    rest = [Locked() for _ in range(plant.model.nv)]
    return tuple([*laws, *rest][: plant.model.nv])


_Made = Callable[[ControlledRobot, np.random.Generator, float], tuple[MotionLaw, ...]]

_MOTION_MAKERS: dict[str, _Made] = {"random": _random, "excited": _excited, "steps": _steps, "paper": _paper}


KEPT_COURSES = 6
"""Courses that a joint keeps."""


@dataclass(frozen=True, eq=False)
class Periodic:
    """One joint of a trajectory that begins and ends at rest, again and again.

    It keeps its last courses: recording, held-out loop and all simulated loops of a run ask for the same times.
    """

    trajectory: Trajectory
    joint: int
    _kept: dict[bytes, Course] = field(default_factory=dict, repr=False)

    def __call__(self, times: Array, /) -> Course:
        key = np.asarray(times, dtype=float).tobytes()
        if key not in self._kept:
            if len(self._kept) >= KEPT_COURSES:
                self._kept.pop(next(iter(self._kept)))
            self._kept[key] = self._course(times)
        return self._kept[key]

    def _course(self, times: Array) -> Course:
        basis, row = self.trajectory.basis, self.trajectory.coefficients[self.joint]
        within = np.mod(times, basis.duration)
        q, v, a = (basis.rows(within, order) @ row for order in range(3))
        return q, v, a


def _repeated(trajectory: Trajectory) -> tuple[MotionLaw, ...]:
    return tuple(Periodic(trajectory, j) for j in range(len(trajectory.coefficients)))


@dataclass(frozen=True)
class Steps:
    """Steps from position to position: a quintic in the first half of every STEP_PERIOD, then at rest."""

    positions: tuple[float, ...]

    def __call__(self, times: Array, /) -> Course:
        positions = np.array(self.positions)
        number = np.clip(np.floor(np.asarray(times) / STEP_PERIOD).astype(int), 0, len(positions) - 2)
        s = np.clip((times - number * STEP_PERIOD) / (STEP_PERIOD / 2), 0.0, 1.0)
        size, rate = positions[number + 1] - positions[number], 2 / STEP_PERIOD
        q = positions[number] + size * s**3 * (10 - 15 * s + 6 * s**2)
        v = size * rate * 30 * s**2 * (1 - s) ** 2
        a = size * rate**2 * 60 * s * (1 - s) * (1 - 2 * s)
        return q, v, a
