"""One simulated recording: the robot in its control loop, measured with noise, and the errors of its model.

Scenarios of a run share what they can: motion, errors of the CAD model, start, and the noise up to its size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from crosscheck.exciting.excited import assumed_noise
from crosscheck.identifying import Preparation
from crosscheck.recordings import Provenance, Recording
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.design import COMMON_DRAW, Draw, Stream
from crosscheck.study.settings.scenarios import MOTION_KINDS, Scenario
from crosscheck.study.settings.settings import RobotSettings
from crosscheck.study.simulated.plants import (
    ControlledRobot,
    Mechanism,
    flexible,
    generator,
    plant_of,
    rigid,
    start_near_truth,
    torque_model_of,
)
from graphdyn import InvalidInput, MeasurementNoise, inverse_dynamics, rollout
from graphdyn.excitation import ExcitationProblem, FourierBasis, Trajectory, frame_origins, optimized, random_trajectory
from graphdyn.identification import ClosedLoop, Problem, TorqueModel
from graphdyn.identification.terms import PayloadMass
from graphdyn.layout import ANGULAR, LINEAR, Array
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


MOTION_STREAM, NOISE_STREAM = 2, 3
"""Numbers of the random streams of a study, beside those of CAD model and start."""


@lru_cache(maxsize=16)
def reference(
    settings: RobotSettings, seed: int, kind: str, number: int, duration: float, stream: Stream = (0, 0)
) -> tuple[MotionLaw, ...]:
    """One law per joint.

    seed: of the study; number, stream: which of the motions of this kind; duration: of the recording [s]

    Raises InvalidInput where the limits allow no motion.
    """
    plant = plant_of(settings)
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


@dataclass(frozen=True, eq=False)
class Periodic:
    """One joint of a trajectory that begins and ends at rest, again and again."""

    trajectory: Trajectory
    joint: int

    def __call__(self, times: Array, /) -> Course:
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


QUOTIENT_TOLERANCE = 1e-9
"""A quotient this little above a whole number is one."""


@dataclass(frozen=True, eq=False)
class SimulatedMotion:
    """What a simulated robot did at the times of the samples (N,) [s].

    q: positions of the motors as measured; tau: of the actuators; links: q, v, a of the links, exact   (N, n)
    """

    time: Array
    q: Array
    tau: Array
    links: tuple[Array, Array, Array]


@dataclass(frozen=True, eq=False)
class RecordedProblem:
    """The problem of one recording, the same for all methods.

    recording: as prepared; loop: in which it was made, as the identification knows it
    truth: parameters of the torque model (p,)
    start: of iterations, where the scenario has one of its own (p,)
    """

    problem: Problem
    recording: Recording
    loop: ClosedLoop
    truth: Array
    start: Array | None = None


def known_model(study: Configuration, scenario: Scenario, draw: Draw = COMMON_DRAW) -> TorqueModel:
    """What the identification knows of the robot in a scenario."""
    return torque_model_of(study.robot, study.seed, scenario.cad_error, scenario.model_error != "friction", draw.cad)


def simulated(study: Configuration, scenario: Scenario, draw: Draw) -> RecordedProblem:
    """The record of a scenario with these random numbers.

    Raises InvalidInput where the loop does not hold the robot, where the limits allow no motion, and where the filter
    leaves no row.
    """
    plant = plant_of(study.robot)
    laws = reference(study.robot, study.seed, scenario.motion, scenario.motion_seed, scenario.duration, draw.motion)
    controller = plant.controller(laws, scenario.control_period)
    of_positions, *of_sensors = np.random.SeedSequence([study.seed, NOISE_STREAM, *draw.noise]).spawn(3)
    motion = _motion(study, plant, laws, scenario, int(of_positions.generate_state(1, np.uint64)[0]))
    recording = _recorded(study, plant, motion, scenario, of_sensors)
    hold = min(scenario.period, scenario.control_period)
    preparation = Preparation(scenario.cutoff, min_speed=scenario.min_speed, torque_hold=hold)
    prepared, known = preparation.differentiated(recording), known_model(study, scenario, draw)
    loop = ClosedLoop(controller, torque_hold=hold, differentiation=preparation.differentiation(recording))
    error = scenario.start_error
    start = None if error is None else start_near_truth(plant, known, study.seed, error, draw.start)
    return RecordedProblem(preparation.problem(known, prepared), prepared, loop, plant.truth(known), start)


def _motion(
    study: Configuration, plant: ControlledRobot, laws: Sequence[MotionLaw], scenario: Scenario, seed: int
) -> SimulatedMotion:
    """The controller sees positions with the noise that is in the recording, and velocities with noise of their own."""
    mechanism: Mechanism = flexible(plant, study.errors) if scenario.model_error == "flexible" else rigid(plant)
    shortest = min(scenario.period, scenario.control_period)
    step = shortest / np.ceil(shortest / mechanism.longest_step - QUOTIENT_TOLERANCE)
    q, v = start_of(laws)
    parameters = plant.model.inertial_parameters
    if scenario.model_error == "payload":
        load = PayloadMass(study.errors.payload_center)
        parameters = parameters + load.inertial_parameters(plant.model, np.array([study.errors.payload_mass]))
    noise = MeasurementNoise(mechanism.of_motors(scenario.position_noise), mechanism.of_motors(plant.velocity_noise))
    run = rollout(
        mechanism.model,
        mechanism.of_motors(q),
        mechanism.of_motors(v),
        mechanism.controlled(plant.controller(laws, scenario.control_period)),
        step=step,
        duration=scenario.duration,
        parameters=mechanism.parameters(parameters),
        friction=mechanism.friction,
        rotor_inertia=mechanism.rotors,
        limits=mechanism.springs,
        noise=noise,
        seed=seed,
        every=round(scenario.period / step),
        threads=1,
    )
    motors = mechanism.motors(run.q[0])
    q_l, v_l, a_l = (mechanism.links(array[0]) for array in (run.q, run.v, run.a))
    if not all(np.all(np.isfinite(array)) for array in (motors, q_l, v_l, a_l)):
        raise InvalidInput("the controller does not hold the robot: it runs away; give other gains, or a higher rate")
    measured = motors + mechanism.motors(_seen(scenario, noise, seed, len(motors)))
    return SimulatedMotion(run.time, measured, mechanism.motors(run.tau[0]), (q_l, v_l, a_l))


def _seen(scenario: Scenario, noise: MeasurementNoise, seed: int, samples: int) -> Array:
    """Noise of the positions (N, m) at the samples: at the ticks of the controller what it sees, drawn as rollout does.

    Samples between two ticks have noise of their own.
    """
    deviations = np.asarray(noise.position)
    m, ratio = len(deviations), scenario.sampling_rate / scenario.control_rate
    ticks = int(np.ceil(samples / ratio)) + 1
    generator = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0,)))
    at_ticks = generator.standard_normal((ticks, 2 * m))[:, :m] * deviations
    if ratio <= 1:
        return np.asarray(at_ticks[:: round(1 / ratio)][:samples])
    drawn = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1,))).standard_normal((samples, m))
    drawn *= deviations
    drawn[:: round(ratio)] = at_ticks[: len(drawn[:: round(ratio)])]
    return drawn


def _recorded(
    study: Configuration,
    plant: ControlledRobot,
    motion: SimulatedMotion,
    scenario: Scenario,
    seeds: Sequence[np.random.SeedSequence],
) -> Recording:
    """The recording with noise of the torques and, if they are measured, of the wrenches."""
    torques, wrenches = (np.random.default_rng(seed) for seed in seeds)
    factor = np.asarray(study.errors.torque_factor) if scenario.model_error == "gear" else 1.0
    tau = factor * motion.tau + scenario.torque_noise * torques.standard_normal(motion.tau.shape)
    measured = None
    if scenario.force_noise is not None:
        measured = np.array(inverse_dynamics(plant.model, *motion.links, method="reproducible").joint_wrenches)
        drawn = wrenches.standard_normal(measured.shape)
        measured[..., LINEAR] += scenario.force_noise * drawn[..., LINEAR]
        measured[..., ANGULAR] += scenario.torque_noise * drawn[..., ANGULAR]
    return Recording(
        joint_names=plant.model.joint_names,
        prismatic=tuple(joint.is_prismatic for joint in plant.model.joints),
        t=motion.time,
        q=motion.q,
        tau=tau,
        joint_wrenches=measured,
        provenance=Provenance((f"run of scenario {scenario.name}",), "simulation"),
    )
